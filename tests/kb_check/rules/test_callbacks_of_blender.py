"""What Blender calls a script's functions with: a mistake in them is found, and what is right there is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.checker import Checker

_BEFORE = "import bpy\nmanager = bpy.context.window_manager\nhandlers = bpy.app.handlers\n"
_LACKS = {
    "def draw(menu, context):\n    menu.layout.lable(text='x')\nmanager.popup_menu(draw, title='x')": "UILayout.lable",
    "manager.popup_menu(title='x', draw_func=lambda menu, _: menu.layout.lable())": "UILayout.lable",
    "def draw(popover, context):\n    popover.layout.lable(text='x')\nmanager.popover(draw)": "UILayout.lable",
    "class Drawer:\n    def draw(self, menu, context):\n        menu.layout.lable(text='x')\n"
    "manager.popup_menu(Drawer().draw)": "UILayout.lable",
    "def draw(one, of):\n    of.draw_type\n"
    "bpy.types.SpaceView3D.draw_handler_add(draw, (1, bpy.context.scene), 'WINDOW', 'POST_PIXEL')": "Scene.draw_type",
    "class Group(bpy.types.PropertyGroup):\n    one: bpy.props.PointerProperty("
    "type=bpy.types.Object, poll=lambda self, one: one.draw_type == 'WIRE')": "Object.draw_type",
    "def follow(of):\n    of.frame_curent\nhandlers.frame_change_post.append(follow)": "Scene.frame_curent",
    "def follow(of, graph):\n    graph.refresh()\nhandlers.depsgraph_update_post.append(follow)": "Depsgraph.refresh",
    "handlers.frame_change_pre.append(lambda of: of.frame_curent)": "Scene.frame_curent",
    "handlers.render_pre.insert(0, lambda of: of.frame_curent)": "Scene.frame_curent",
}
_RIGHT = (
    "handlers.frame_change_post.append(lambda of, graph: [one.object for one in graph.object_instances])",
    "handlers.depsgraph_update_pre.append(lambda of, graph: graph is None)",
    "handlers.save_pre.append(lambda path: path.upper())",
    "handlers.render_stats.append(lambda text: text.upper())",
    "def draw(menu, context):\n    menu.layout.label(text='x')\nmanager.popup_menu(draw, title='x')",
)
_OF_ANOTHER_NUMBER = (
    "class Group(bpy.types.PropertyGroup):\n    one: bpy.props.PointerProperty("
    "type=bpy.types.Object, poll=lambda one: one.display_type == 'WIRE')",
    "class Group(bpy.types.PropertyGroup):\n    one: bpy.props.IntProperty("
    "update=lambda context: context.view_layer.update())",
    "def draw(context):\n    context.area.tag_redraw()\nmanager.popup_menu(draw, title='x')",
)
_ASKED = """
import bpy
seen = []
def note(*given):
    seen.append([type(one).__name__ for one in given])
bpy.app.handlers.{name}.append(note)
bpy.context.scene.frame_set(3)
bpy.ops.mesh.primitive_cube_add()
bpy.context.view_layer.update()
bpy.app.handlers.{name}.remove(note)
assert seen and all(row == {kinds} for row in seen), seen
"""
_CALLED = {
    "frame_change_pre": ["Scene", "NoneType"],
    "frame_change_post": ["Scene", "Depsgraph"],
    "depsgraph_update_pre": ["Scene", "NoneType"],
    "depsgraph_update_post": ["Scene", "Depsgraph"],
}


@pytest.mark.parametrize(("code", "symbol"), _LACKS.items())
def test_what_a_callback_is_given_is_known(rule_checker: Checker, code: str, symbol: str) -> None:
    found = rule_checker.check(f"{_BEFORE}{code}\n", rules=["unknown-attribute"])
    assert [finding.symbol for finding in found] == [f"bpy.types.{symbol}"]


@pytest.mark.parametrize("code", _RIGHT)
def test_what_is_right_in_a_callback_is_no_finding(rule_checker: Checker, code: str) -> None:
    found = rule_checker.check(f"{_BEFORE}{code}\n")
    assert [one.message for one in found if one.severity == "error"] == []


@pytest.mark.parametrize("code", _OF_ANOTHER_NUMBER)
def test_what_is_called_with_another_number_of_arguments_gets_none_of_them(
    rule_checker: Checker, code: str
) -> None:
    rules = ["unknown-attribute", "own-property", "never-true"]
    assert rule_checker.check(f"{_BEFORE}{code}\n", rules=rules) == []


@pytest.mark.blender
def test_blender_calls_handlers_with_these(tmp_path: Path) -> None:
    done = run_statements(
        tmp_path, [_ASKED.format(name=name, kinds=kinds) for name, kinds in _CALLED.items()]
    )
    assert [row[0] for row in done] == ["" for _ in _CALLED]
