"""Splines with a point too many: as many as Blender has then."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_MADE = """\
import bpy
path = [(1, 0, 0), (2, 0, 0), (3, 0, 0)]
curve = bpy.data.curves.new("curve", "CURVE")
"""
_FILLED = [
    'spline = curve.splines.new("POLY")\nspline.points.add(len(path))\n'
    "for i, (x, y, z) in enumerate(path):\n    spline.points[i].co = (x, y, z, 1)\n",
    'spline = curve.splines.new("NURBS")\nspline.points.add(len(path))\n'
    "for i in range(len(path)):\n    spline.points[i].co = (*path[i], 1)\nspline.use_cyclic_u = True\n",
    'spline = curve.splines.new("BEZIER")\nspline.bezier_points.add(len(path))\n'
    "for point, place in zip(spline.bezier_points, path):\n    point.co = place\n",
]


@pytest.mark.parametrize("filled", _FILLED)
def test_the_last_point_stays_at_the_origin(check: Check, tmp_path: Path, filled: str) -> None:
    code = _MADE + filled
    found = check("extra-point", code)
    assert [one.span.line for one in found] == [5]
    mended = apply_fixes(Source(code), found, unsafe=True).text
    assert not check("extra-point", mended)
    points = "[tuple(p.co)[:3] for p in spline.bezier_points or spline.points]"
    (_, _, before), (_, _, after) = (
        run_statements(tmp_path, [text], {0: points})[0] for text in (code, mended)
    )
    path = "(1.0, 0.0, 0.0), (2.0, 0.0, 0.0), (3.0, 0.0, 0.0)"
    assert (before, after) == (f"[{path}, (0.0, 0.0, 0.0)]", f"[{path}]")


@pytest.mark.parametrize(
    "changed",
    [
        ("add(len(path))", "add(len(path) - 1)"),
        ("add(len(path))", "add(count)"),
        ("enumerate(path)", "enumerate(path, 1)"),
        (
            "spline.points[i].co = (x, y, z, 1)\n",
            "spline.points[i].co = (x, y, z, 1)\nspline.points[-1].co.x = 3\n",
        ),
        ("spline.points[i].co = (x, y, z, 1)\n", "spline.points[i].co = (x, y, z, 1)\nclose(spline)\n"),
        ("spline.points[i].co", "spline.points[i + 1].co"),
    ],
)
def test_what_may_be_meant_is_left_alone(check: Check, changed: tuple[str, str]) -> None:
    code = (_MADE + _FILLED[0]).replace(*changed)
    assert code != _MADE + _FILLED[0]
    assert not check("extra-point", code)
