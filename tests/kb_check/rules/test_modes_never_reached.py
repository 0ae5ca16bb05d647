"""Comparisons with modes that RNA lists and nothing enters."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

_PENCIL = """\
import bpy
pencil = bpy.data.objects.new('Pencil', bpy.data.grease_pencils.new('Pencil'))
bpy.context.collection.objects.link(pencil)
bpy.context.view_layer.objects.active = pencil
""".splitlines()
_HAIR = """\
import bpy
bpy.context.view_layer.objects.active = bpy.data.objects['Cube']
bpy.ops.object.particle_system_add()
bpy.context.object.particle_systems[0].settings.type = 'HAIR'
bpy.ops.object.mode_set(mode='PARTICLE_EDIT')
""".splitlines()
_MODES = ["EDIT", "SCULPT", "PAINT", "WEIGHT", "VERTEX"]


def test_the_former_modes_of_grease_pencil_are_found(rule_checker: Checker, tmp_path: Path) -> None:
    start: list[str] = list(_PENCIL)
    lines: list[str] = []
    watched: dict[int, str] = {}
    for mode in _MODES:
        own = "EDIT" if mode == "EDIT" else f"{mode}_GREASE_PENCIL"
        start.append(f"bpy.ops.object.mode_set(mode={own!r})")
        for value in (f"{mode}_GREASE_PENCIL", f"{mode}_GPENCIL"):
            watched[len(start)] = f"bpy.context.mode == {value!r}"
            start.append("pass")
            lines.append(f"bpy.context.mode == {value!r}")
    answers = run_statements(tmp_path, start, watched)
    held = {watched[place] for place in watched if answers[place][2] == "True"}
    assert held == {line for line in lines if "GREASE" in line}
    found = rule_checker.check("\n".join(["import bpy", *lines]), rules=["never-true"])
    assert [lines[finding.span.line - 2] for finding in found] == [line for line in lines if line not in held]
    assert [edit.text for finding in found if finding.fix for edit in finding.fix.edits] == [
        repr(f"{mode}_GREASE_PENCIL") for mode in _MODES
    ]


def test_modes_that_want_more_than_an_object_are_no_finding(check: Check, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, [*_HAIR, "pass"], {len(_HAIR): "bpy.context.mode == 'PARTICLE'"})
    assert answers[-1][2] == "True"
    assert check("never-true", "import bpy\nbpy.context.mode == 'PARTICLE'\n") == []


@pytest.mark.parametrize(
    "test",
    [
        "bpy.context.mode in {'EDIT_GPENCIL', 'EDIT_GREASE_PENCIL'}",
        "bpy.app.version < (4, 3) and bpy.context.mode == 'EDIT_GPENCIL'",
        "bpy.context.mode == 'EDIT_GPENCIL' or bpy.context.mode == 'EDIT_GREASE_PENCIL'",
        "bpy.context.mode == 'EDIT_MESH'",
    ],
)
def test_modes_of_older_blenders_beside_are_no_finding(check: Check, test: str) -> None:
    assert check("never-true", f"import bpy\nif {test}:\n    print()\n") == []
