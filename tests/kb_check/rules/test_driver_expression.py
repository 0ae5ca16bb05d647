"""Expressions of drivers: those that are told are those that Blender cannot compute."""

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
ob = bpy.data.objects.new("a", None)
bpy.context.scene.collection.objects.link(ob)
driver = ob.driver_add("location", 2).driver
height = driver.variables.new()
height.name = "height"
other = driver.variables.new()
height.targets[0].id = other.targets[0].id = ob
height.targets[0].data_path = other.targets[0].data_path = "location.x"
"""
_REFUSED = (
    "math.sin(frame)", "sin(frame", "speed * frame", "np.sin(frame)", "frame_current / 10", "self.location.x",
    "value = 2", "import math", "height +", "math.radians(height) * frame",
)  # fmt: skip
_TAKEN = (
    "sin(frame)", "frame / 10", "height * 2", "var + 1", "lerp(0, 1, clamp(frame))", "1 if frame > 3 else 2",
    "pi * floor(frame)", "max(height, var)", "2.5", "smoothstep(0, 1, height)",
)  # fmt: skip


def test_what_blender_cannot_compute_is_told(check: Check, tmp_path: Path) -> None:
    lines: list[str] = [
        *_MADE.splitlines(),
        *(
            line
            for text in _REFUSED + _TAKEN
            for line in (f"driver.expression = {text!r}", "bpy.context.scene.frame_set(7)")
        ),
    ]
    watched = {at: "driver.is_valid" for at, line in enumerate(lines) if line.endswith("frame_set(7)")}
    invalid = [
        at for at, (*_, after) in enumerate(run_statements(tmp_path, lines, watched)) if after == "False"
    ]
    found = check("driver-expression", "\n".join(lines))
    assert [one.span.line for one in found] == invalid
    assert [lines[at - 1] for at in invalid] == [f"driver.expression = {text!r}" for text in _REFUSED]


def test_the_name_of_math_is_left_out(check: Check) -> None:
    code = f"{_MADE}driver.expression = 'math.sin(frame) * math.pi'\n"
    mended = apply_fixes(Source(code), check("driver-expression", code)).text
    assert mended == f"{_MADE}driver.expression = 'sin(frame) * pi'\n"
    assert not check("driver-expression", mended)


@pytest.mark.parametrize(
    "code",
    [
        "bpy.app.driver_namespace['speed'] = lambda: 3\ndriver.expression = 'speed()'",
        "for name in names: driver.variables.new().name = name\ndriver.expression = 'speed'",
        "for curve in ob.animation_data.drivers: curve.driver.expression = 'speed'",
        "driver.use_self = True\ndriver.expression = 'self.location.x'",
        "driver.expression = text",
        "driver.expression = f'{speed} * frame'",
        "driver.expression = ''",
        "driver.expression = 'sum(x for x in (1, 2))'",
    ],
)
def test_what_may_be_right_is_left_alone(check: Check, code: str) -> None:
    assert not check("driver-expression", f"{_MADE}{code}\n")
