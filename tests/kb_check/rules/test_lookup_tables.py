"""Elements of a BMesh by index are an error where Blender refuses them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

SETTING = ["import bpy, bmesh", "bm = bmesh.new()", "made = bmesh.ops.create_cube(bm, size=1)"]


@pytest.mark.parametrize(
    "line",
    [
        "bm.verts[0].co.z = 1", "print(bm.faces[-1])", "edge = bm.edges[3]",
        "bm.faces[0].select = bool(bm.verts.ensure_lookup_table())",
    ],
)  # fmt: skip
def test_missing_table_is_found_and_made(check: Check, tmp_path: Path, line: str) -> None:
    [finding] = check("outdated-lookup-table", "\n".join([*SETTING, line]))
    assert finding.span.line == 4
    assert finding.fix is not None
    assert finding.fix.sure
    [edit] = finding.fix.edits
    answers = run_statements(tmp_path, [*SETTING, line, *SETTING, edit.text + line])
    refused, fixed = answers[len(SETTING)], answers[-1]
    assert "outdated internal index table" in refused[0]
    assert not fixed[0]


@pytest.mark.parametrize(
    "lines",
    [
        ["bm.verts.ensure_lookup_table()", "bm.verts[0].co.z = 1"],
        ["bm.verts[:][0].co.z = 1"],
        [
            "for parts in (bm.verts, bm.faces):",
            "    parts.ensure_lookup_table()",
            "bm.faces[0].select = True",
        ],
        ["made['verts'][0].co.z = 1"],
        ["for vert in bm.verts:", "    vert.co[0] = 1"],
        ["bmesh.ops.recalc_face_normals(bm, faces=bm.faces)", "bm.faces[0].select = True"],
    ],
)
def test_what_needs_no_table_is_no_finding(check: Check, tmp_path: Path, lines: list[str]) -> None:
    answers = run_statements(tmp_path, [*SETTING, "\n".join(lines)])
    assert not answers[-1][0]
    assert check("outdated-lookup-table", "\n".join([*SETTING, *lines])) == []


def test_meshes_of_others_are_no_finding(check: Check) -> None:
    code = "import bpy, bmesh\nbm = bmesh.from_edit_mesh(bpy.context.object.data)\nbm.verts[0].co.z = 1\n"
    assert check("outdated-lookup-table", code) == []
    assert check("outdated-lookup-table", "def f(bm):\n    return bm.verts[0]\n") == []
