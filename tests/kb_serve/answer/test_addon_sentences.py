"""What add-ons write in several places: it is told where it is asked for, and tried in Blender."""

from __future__ import annotations

import re
import sys
import types
from typing import TYPE_CHECKING, Any

import pytest

from kb_serve.answer.known.addon_sentences import ADDON_SENTENCES

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

CODE = re.compile(r"`([^`]+)`")
NAME = "bl_ext.user_default.tried"


def told(kb: KnowledgeBase, question: str) -> list[str]:
    notes = kb.query(question).notes
    return [recipe.text for recipe in ADDON_SENTENCES if recipe.text in notes]


@pytest.mark.parametrize(
    ("question", "begins"),
    [
        ("register nested PropertyGroup order CollectionProperty type", "A group is registered before"),
        ("get addon preferences inside an extension", "`bpy.context.preferences.addons[__package__]"),
        ("AddonPreferences", "`bpy.context.preferences.addons[__package__]"),
        ("modal operator with timer event_timer_add", "`invoke()` ends with"),
        ("WindowManager.fileselect_add", "`invoke()` ends with"),
    ],
)
def test_it_is_told_where_it_is_asked_for(kb: KnowledgeBase, question: str, begins: str) -> None:
    (text,) = told(kb, question)
    assert text.startswith(begins)


@pytest.mark.parametrize(
    "question", ["enable an add-on in preferences", "PropertyGroup", "where are the preferences saved"]
)
def test_it_is_not_told_elsewhere(kb: KnowledgeBase, question: str) -> None:
    assert told(kb, question) == []


@pytest.mark.blender
def test_groups_are_registered_in_this_order(kb: KnowledgeBase) -> None:
    bpy: Any = pytest.importorskip("bpy")
    (text,) = told(kb, "register nested PropertyGroup order CollectionProperty type")
    first, second, _, member, last = (code for code in CODE.findall(text))
    name, _, value = member.partition(": ")
    base = (bpy.types.PropertyGroup,)
    held: dict[str, Any] = {"bpy": bpy, "Item": type("Item", base, {})}
    annotations = {"__annotations__": {name: eval(value, held)}}
    early = type("Early", base, annotations)
    held["Group"] = type("Group", base, annotations)
    with pytest.raises(ValueError, match="could not register"):
        bpy.utils.register_class(early)
    exec(f"{first}\n{second}\n{last}", held)
    try:
        assert bpy.context.scene.group.items.add() is not None
    finally:
        del bpy.types.Scene.group
        for cls in (held["Group"], held["Item"]):
            bpy.utils.unregister_class(cls)


@pytest.mark.blender
def test_preferences_are_found_by_the_whole_name_of_the_package(
    kb: KnowledgeBase, monkeypatch: pytest.MonkeyPatch
) -> None:
    bpy: Any = pytest.importorskip("bpy")
    (text,) = told(kb, "AddonPreferences")
    read, _ = CODE.findall(text)[:2]
    monkeypatch.setitem(sys.modules, NAME, types.ModuleType(NAME))
    cls = type("Tried", (bpy.types.AddonPreferences,), {"bl_idname": NAME})
    bpy.utils.register_class(cls)
    addons = bpy.context.preferences.addons
    addon = addons.new()
    addon.module = NAME
    try:
        assert isinstance(eval(read, {"bpy": bpy, "__package__": NAME}), cls)
        with pytest.raises(KeyError):
            eval(read, {"bpy": bpy, "__package__": "tried"})
    finally:
        addons.remove(addon)
        bpy.utils.unregister_class(cls)


@pytest.mark.blender
def test_blender_has_all_that_is_named() -> None:
    bpy: Any = pytest.importorskip("bpy")
    manager = bpy.types.WindowManager.bl_rna.functions
    calls = {
        name for recipe in ADDON_SENTENCES for name in re.findall(r"window_manager\.(\w+)\(", recipe.text)
    }
    assert calls == {"event_timer_add", "event_timer_remove", "fileselect_add", "modal_handler_add"}
    assert calls <= {*manager.keys()}
    assert "TIMER" in bpy.types.Event.bl_rna.properties["type"].enum_items
    (result,) = (item for item in bpy.types.Operator.bl_rna.functions["modal"].parameters if item.is_output)
    assert {"RUNNING_MODAL", "FINISHED", "CANCELLED"} <= {*result.enum_items.keys()}
