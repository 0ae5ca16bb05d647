"""What a thing is of, after its type was set: a name keeps the class that it had, what is looked up anew does not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_LINES = """\
import bpy
li = bpy.data.lights['Light']
li.type = 'SUN'
li.angle = .1
bpy.data.lights['Light'].angle = .1
bpy.data.objects['Light'].data.angle = .1
bpy.data.lights.get('Light').angle = .1
made = bpy.data.lights.new('made', 'POINT')
ob = bpy.data.objects.new('made', made)
made.type = 'SUN'
made.angle = .2
ob.data.angle = .2
del made
ob.data.type = 'SPOT'
ob.data.spot_size = .2
ob.data.type = 'AREA'
ob.data.shape = 'DISK'
ob.data.sahpe = 'DISK'
clouds = bpy.data.textures.new('made', 'CLOUDS')
clouds.type = 'WOOD'
clouds.wood_type = 'BANDS'
bpy.data.textures['made'].wood_type = 'BANDS'
"""


def test_a_type_that_is_set_is_known_of_what_is_looked_up_anew(rule_checker: Checker, tmp_path: Path) -> None:
    lines = _LINES.splitlines()
    refused = [at for at, (error, *_) in enumerate(run_statements(tmp_path, lines), 1) if error]
    found = rule_checker.check(_LINES, rules=["unknown-attribute"])
    # The first was looked up, and its type may have been set before.
    assert [4, *(one.span.line for one in found)] == refused
    assert len(refused) == 4


def test_a_chain_forgets_its_type_when_that_is_set(rule_checker: Checker) -> None:
    code = """\
import bpy
if bpy.context.light.type == 'POINT':
    bpy.context.light.type = 'SUN'
    bpy.context.light.angle = .1
"""
    assert rule_checker.check(code, rules=["unknown-attribute"]) == []
    narrowed = code.replace("bpy.context.light.type = 'SUN'", "pass")
    assert [one.span.line for one in rule_checker.check(narrowed, rules=["unknown-attribute"])] == [4]


def test_a_space_is_forgotten_when_its_area_shows_another_editor(rule_checker: Checker) -> None:
    code = """\
import bpy
for area in bpy.context.screen.areas:
    if area.type == 'VIEW_3D':
        area.{name} = '{value}'
        area.spaces.active.image = None
if bpy.context.space_data.type == 'VIEW_3D':
    bpy.context.area.{name} = '{value}'
    bpy.context.space_data.image = None
"""
    for name, value in (("type", "IMAGE_EDITOR"), ("ui_type", "UV")):
        assert rule_checker.check(code.format(name=name, value=value), rules=["unknown-attribute"]) == []
    kept = rule_checker.check(code.format(name="tag", value=""), rules=["unknown-attribute"])
    assert [one.span.line for one in kept if one.symbol.endswith("SpaceView3D.image")] == [5, 8]
