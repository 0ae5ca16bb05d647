"""What settings depend on to have an effect."""

from __future__ import annotations

from kb_build.panels.idle import any_of, idle_conditions
from kb_build.symbols.records import SettingCondition

M = "bpy.types.M."


def test_any_need_of_a_setting_is_enough() -> None:
    needs = {
        f"{M}depth": [("mode", "SHARP"), ("mode", "BLOCKS"), ("use_depth", True)],
        f"{M}size": [("use_radius", False)],
        f"{M}factor": [("group", "")],
    }
    assert [*idle_conditions(needs)] == [
        SettingCondition(f"{M}depth", 0, f"{M}mode", "'BLOCKS' or 'SHARP'", "idle"),
        SettingCondition(f"{M}depth", 0, f"{M}use_depth", "on", "idle"),
        SettingCondition(f"{M}size", 0, f"{M}use_radius", "off", "idle"),
        SettingCondition(f"{M}factor", 0, f"{M}group", "not empty", "idle"),
    ]


def test_values_are_told_in_one_order() -> None:
    assert any_of(["'C'", "'A'", "'B'"]) == "'A', 'B' or 'C'"
    assert any_of(["'A'"]) == "'A'"
