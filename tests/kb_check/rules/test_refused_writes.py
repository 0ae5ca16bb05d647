"""Writes are found where Blender refuses them: in what it asks and draws."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_START = """\
import bpy
from bpy.props import IntProperty, PointerProperty
class Settings(bpy.types.PropertyGroup):
    level: IntProperty()
bpy.utils.register_class(Settings)
bpy.types.Scene.settings = PointerProperty(type=Settings)
bpy.types.WindowManager.settings = PointerProperty(type=Settings)
cube = bpy.data.objects['Cube']
cube.modifiers.new('Subdivision', 'SUBSURF')
done = []
"""
_WRITES = [
    "context.scene.frame_current = 7",
    "context.scene.render.fps = 30",
    "context.scene.settings.level = 3",
    "context.scene['level'] = 3",
    "context.scene.frame_step += 1",
    "context.view_layer.objects.active = None",
    "bpy.data.objects['Cube'].location.x = 1",
    "bpy.data.objects['Cube'].location[0] = 1",
    "bpy.data.objects['Cube'].modifiers[0].show_viewport = False",
    "bpy.ops.object.select_all(action='SELECT')",
    "scene = context.scene\nscene.render.engine = 'CYCLES'",
    # Taken.
    "context.window_manager.settings.level = 3",
    "context.window_manager['level'] = 3",
    "bpy.data.screens[0].show_statusbar = False",
    "bpy.data.workspaces[0].name = 'Other'",
    "context.preferences.view.ui_scale = 1.0",
    "bpy.data.objects['Cube'].color[0] = 1",
    "bpy.data.objects['Cube'].select_set(True)",
    "bpy.data.meshes.new('x')",
    "bpy.ops.object.select_all.poll()",
    "place = bpy.data.objects['Cube'].location.copy()\nplace.x = 3",
    "try:\n    context.scene.frame_current = 7\nexcept AttributeError:\n    pass",
]
# What a write stands in, and how it is run; ``menu`` is what a popup menu is drawn with.
_PLACES = {
    "poll": (
        "class C{0}(bpy.types.Operator):\n    bl_idname = 'writing.c{0}'\n    bl_label = 'x'\n    @classmethod\n"
        "    def poll(cls, context):\n{1}\n        done.append({0})\n        return True\n"
        "bpy.utils.register_class(C{0})\n",
        "bpy.ops.writing.c{0}.poll()",
    ),
    "draw": (
        "class MENU_MT_c{0}(bpy.types.Menu):\n    bl_label = 'x'\n    def draw(self, context):\n{1}\n"
        "        done.append({0})\nbpy.utils.register_class(MENU_MT_c{0})\n",
        "menu.layout.menu_contents('MENU_MT_c{0}')",
    ),
    "appended": (
        "class MENU_MT_c{0}(bpy.types.Menu):\n    bl_label = 'x'\n    def draw(self, context):\n        pass\n"
        "def more{0}(self, context):\n{1}\n        done.append({0})\nbpy.utils.register_class(MENU_MT_c{0})\n"
        "MENU_MT_c{0}.append(more{0})\n",
        "menu.layout.menu_contents('MENU_MT_c{0}')",
    ),
    "execute": (
        "class C{0}(bpy.types.Operator):\n    bl_idname = 'writing.c{0}'\n    bl_label = 'x'\n"
        "    def execute(self, context):\n{1}\n        done.append({0})\n        return {{'FINISHED'}}\n"
        "bpy.utils.register_class(C{0})\n",
        "bpy.ops.writing.c{0}()",
    ),
    "popup": (
        "def draw{0}(self, context):\n{1}\n        done.append({0})\n"
        "bpy.context.window_manager.popup_menu(draw{0})\n",
        "draw{0}(menu, bpy.context)",
    ),
    "property": (
        "def changed{0}(self, context):\n{1}\n        done.append({0})\n"
        "bpy.types.Object.c{0} = IntProperty(update=changed{0})\n",
        "cube.c{0} = 5",
    ),
}
# What has no window may draw a popup menu, and no more.
_RUN = """
import json, os, sys, traceback
import bpy
start, parts, runs, is_drawn = json.load(open(sys.argv[-1]))
names = {}
exec(start, names)
for part in parts:
    exec(part, names)
def run_all(menu, _context):
    names["menu"] = menu
    for run in runs:
        try:
            exec(run, names)
        except Exception:
            traceback.print_exc()
    with open(sys.argv[-1], "w") as file:
        json.dump(names["done"], file)
    sys.stdout.flush()
    os._exit(0)
if is_drawn:
    bpy.context.window_manager.popup_menu(run_all)
run_all(None, None)
"""


@pytest.mark.parametrize("place", _PLACES)
def test_writes_are_found_where_blender_refuses_them(
    place: str, rule_checker: Checker, tmp_path: Path
) -> None:
    bodies = ["\n".join(" " * 8 + line for line in write.splitlines()) for write in _WRITES]
    defined, run = _PLACES[place]
    parts = [defined.format(number, body) for number, body in enumerate(bodies)]
    defining = [part.replace("bpy.context.window_manager.popup_menu", "str") for part in parts]
    runs = [run.format(number) for number in range(len(parts))]
    done = told_by_blender(_RUN, tmp_path, [_START, defining, runs, "menu" in run], seconds=240)
    refused = [write for number, write in enumerate(_WRITES) if number not in done]
    assert bool(refused) == (place in {"poll", "draw", "appended"})
    found = [
        write
        for write, part in zip(_WRITES, parts, strict=True)
        if rule_checker.check(_START + part, rules=["refused-write"])
    ]
    assert found == refused
