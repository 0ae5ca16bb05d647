"""What operators return, used as objects: found where Blender refuses it, and mended."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

from kb_check.text.fixes import apply_fixes
from kb_check.text.source import Source

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_CODE = """\
import bpy
cube = bpy.ops.mesh.primitive_cube_add(size=2)
cube.location = (0, 0, 1)
light = bpy.ops.object.light_add(type='SUN')
light.data.energy = 3
answer = bpy.ops.object.select_all(action='SELECT')
answer.isdisjoint({'CANCELLED'})
bpy.ops.mesh.primitive_cube_add().name
"""


def test_what_operators_return_is_a_set(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [*_CODE.splitlines()]
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = check("operator-result", _CODE)
    assert [one.span.line for one in found] == refused == [3, 5, 8]
    mended: list[str] = [*apply_fixes(Source(_CODE), found).text.splitlines()]
    answers = run_statements(tmp_path, mended)
    assert [line for line, (error, *_) in zip(mended, answers, strict=True) if error] == lines[-1:]


@pytest.mark.parametrize(
    "code",
    [
        "cube = bpy.ops.mesh.primitive_cube_add()\ncube = bpy.context.object\ncube.location = (0, 0, 1)\n",
        "cube = bpy.ops.mesh.primitive_cube_add()\ntry:\n    cube.location\nexcept AttributeError:\n    pass\n",
        "bpy.ops.mesh.primitive_cube_add.poll().real\n",
        "kind = bpy.ops.mesh.primitive_cube_add.get_rna_type()\nkind.name\n",
    ],
)
def test_what_may_be_another_thing_is_left_alone(check: Check, code: str) -> None:
    assert not check("operator-result", f"import bpy\n{code}")
