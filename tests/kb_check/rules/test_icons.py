"""Icons that another Blender has, and this one does not."""

from __future__ import annotations

from textwrap import indent
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from kb_check.checker import Checker

_PANEL = """\
import bpy


class Panel(bpy.types.Panel):
    bl_idname = "VIEW3D_PT_own"
    bl_label = "Own"
    bl_space_type = 'VIEW_3D'
    bl_region_type = 'UI'

    def draw(self, context):
        layout = self.layout
"""
_MIXED = """\
import bpy


class Drawing:
    def draw(self, context):
        layout = self.layout
"""


@pytest.mark.parametrize("around", [_PANEL, _MIXED])
@pytest.mark.parametrize(
    ("line", "edits"),
    [
        ("layout.label(icon='SEQUENCE_COLOR_01')", ["'STRIP_COLOR_01'"]),
        ("layout.row().operator('mesh.subdivide', icon='SEQUENCE_COLOR_09')", ["'STRIP_COLOR_09'"]),
        ("layout.label(icon='HAIR' if context.object else 'NONE')", [None]),
        ("layout.label(icon='STRIP_COLOR_01')", []),
        ("layout.label(icon=context.name)", []),
    ],
)
def test_former_icons_are_found(
    rule_checker: Checker, around: str, line: str, edits: list[str | None]
) -> None:
    found = rule_checker.check(around + indent(line, " " * 8) + "\n", rules=["unknown-value"])
    assert [one.fix.edits[0].text if one.fix else None for one in found] == edits
    assert all(one.fix.sure for one in found if one.fix)


def test_what_is_no_former_icon_may_be_anothers(rule_checker: Checker) -> None:
    code = _MIXED + "        layout.label(icon='OWN_ICON')\n        context.other(icon='HAIR')\n"
    assert rule_checker.check(code, rules=["unknown-value"]) == []


def test_a_menu_of_a_message_takes_the_icons_that_it_is_drawn_with(rule_checker: Checker) -> None:
    code = _BOX + "box('Saved')\nbox('Lost', icon='ERROR')\nbox('Lost', icon='WARNING')\n"
    found = rule_checker.check(code, rules=["unknown-value"])
    assert [code.splitlines()[one.span.line - 1] for one in found] == [_BOX.splitlines()[-1]]
    assert "'WARNING' is not a value" in found[0].message


_BOX = """\
import bpy


def box(text, icon='INFO'):
    def draw(self, context):
        self.layout.label(text=text)
    bpy.context.window_manager.popup_menu(draw, title="Own", icon=icon)
"""
