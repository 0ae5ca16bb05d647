"""Faces without corners: as few as Blender makes of them."""

from __future__ import annotations

from subprocess import CalledProcessError
from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MADE = """\
import bpy
mesh = bpy.data.meshes.new("mesh")
mesh.vertices.add(6)
mesh.vertices.foreach_set("co", [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1])
mesh.loops.add(6)
mesh.loops.foreach_set("vertex_index", range(6))
mesh.polygons.add(2)
"""
_SIZES = 'mesh.polygons.foreach_set("loop_total", [3, 3])\n'
_STARTS = 'mesh.polygons.foreach_set("loop_start", [0, 3])\n'
_ONE_BY_ONE = "for i, polygon in enumerate(mesh.polygons):\n    polygon.loop_start = 3 * i\n"


def test_faces_without_a_first_corner_are_none(check: Check, tmp_path: Path) -> None:
    assert _faces(tmp_path, _MADE + _SIZES) != "2"
    assert [one.span.line for one in check("faces-without-start", _MADE + _SIZES)] == [7]


@pytest.mark.parametrize("filled", [_STARTS, _STARTS + _SIZES, _ONE_BY_ONE])
def test_faces_that_begin_somewhere_have_corners(check: Check, tmp_path: Path, filled: str) -> None:
    assert _faces(tmp_path, _MADE + filled) == "2"
    assert not check("faces-without-start", _MADE + filled)


def _faces(folder: Path, code: str) -> str:
    """How many faces Blender keeps, or that it ended: without a first corner, a face has what was in memory."""
    whole = f"{code}mesh.update()\nmesh.validate()"
    try:
        return run_statements(folder, [whole], {0: "len(mesh.polygons)"})[0][2]
    except CalledProcessError:
        return "ended"


@pytest.mark.parametrize(
    "changed", [("polygons.add(2)", "polygons.add(1)"), ("import bpy\n", "import bpy\nimport my_meshes\n")]
)
def test_what_may_have_corners_is_no_finding(check: Check, changed: tuple[str, str]) -> None:
    assert check("faces-without-start", _MADE + _SIZES)
    assert not check("faces-without-start", (_MADE + _SIZES).replace(*changed))
