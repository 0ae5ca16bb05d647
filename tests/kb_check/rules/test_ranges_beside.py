"""Ranges that a thing sets itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_LINES = """\
import bpy
ob = bpy.data.objects['Cube']
basis = ob.shape_key_add(name='a')
key = ob.shape_key_add(name='b')
key.slider_max = 8
key.slider_min = -1
key.value = 5
key.value = -1
ob.data.shape_keys.key_blocks['b'].value = 6
"""


def test_a_range_that_is_set_beside_a_value_is_what_holds(rule_checker: Checker, tmp_path: Path) -> None:
    answers = run_statements(tmp_path, _LINES.splitlines(), dict.fromkeys((6, 7, 8), "key.value"))
    assert [after for _, _, after in answers[6:]] == ["5.0", "-1.0", "6.0"]
    assert rule_checker.check(_LINES, rules=["out-of-range"]) == []
