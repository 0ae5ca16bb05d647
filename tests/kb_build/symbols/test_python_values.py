"""Which values are Python's own, as Blender itself gives them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_build.symbols.lines import type_text
from kb_build.symbols.python_values import is_new_list, python_class

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_LISTS = (
    "editable_objects", "objects_in_mode", "objects_in_mode_unique_data", "selectable_objects",
    "selected_editable_objects", "selected_objects", "visible_objects",
)  # fmt: skip
_EXPRESSIONS = {
    **{f"bpy.types.Context.{name}": f"bpy.context.{name}" for name in _LISTS},
    "bpy.types.Context.mode": "bpy.context.mode",
    "bpy.types.Object.type": "bpy.context.object.type",
    "bpy.types.ID.name": "bpy.context.object.name",
    "bpy.types.Object.pass_index": "bpy.context.object.pass_index",
    "bpy.types.Object.empty_display_size": "bpy.context.object.empty_display_size",
    "bpy.types.Object.hide_render": "bpy.context.object.hide_render",
    "bpy.types.Object.users_collection": "bpy.context.object.users_collection",
    "bpy.types.ToolSettings.snap_elements": "bpy.context.tool_settings.snap_elements",
    "bpy.types.Object.children_recursive": "bpy.context.object.children_recursive",
    "bpy.app.version": "bpy.app.version",
    "bpy.app.version_string": "bpy.app.version_string",
    "bpy.app.build_hash": "bpy.app.build_hash",
    "bpy.app.driver_namespace": "bpy.app.driver_namespace",
    "bpy.app.handlers.save_pre": "bpy.app.handlers.save_pre",
    "bpy.types.Object.location": "bpy.context.object.location",
    "bpy.types.Object.modifiers": "bpy.context.object.modifiers",
    "bpy.types.Context.object": "bpy.context.object",
    "bpy.types.Scene.objects": "bpy.context.scene.objects",
}
_ASKED = """
import bpy, json, sys
with open(sys.argv[-1]) as file:
    given = json.load(file)
with open(sys.argv[-1], "w") as file:
    json.dump([type(eval(text)).__name__ for text in given], file)
"""


@pytest.fixture(scope="module")
def given_by_blender(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    names = told_by_blender(_ASKED, tmp_path_factory.mktemp("classes"), list(_EXPRESSIONS.values()))
    return dict(zip(_EXPRESSIONS, names, strict=True))


@pytest.mark.parametrize("path", _EXPRESSIONS)
def test_values_are_what_blender_makes_of_them(
    path: str, kb: KnowledgeBase, given_by_blender: dict[str, str]
) -> None:
    symbol = kb.reader.symbol(path)
    assert symbol is not None
    kind = python_class(symbol)
    blenders_own = {"Vector", "bpy_prop_collection", "Object"}
    assert (given_by_blender[path] if given_by_blender[path] not in blenders_own else None) == (
        kind.__name__ if kind else None
    )


def test_what_the_context_puts_together_is_said_to_be_a_list(kb: KnowledgeBase) -> None:
    for name in _LISTS:
        symbol = kb.reader.symbol(f"bpy.types.Context.{name}")
        assert symbol is not None
        assert is_new_list(symbol.kind, symbol.type)
        assert type_text(symbol) == "list[Object]"
