"""Methods of Python's own values are none that Blender lacks: what they are read of is the answer."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from asking import first_id

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

READ = {
    "objs = bpy.context.selected_objects.copy()": "bpy.context.selected_objects",
    "bpy.context.selected_objects.sort(key=lambda o: o.name)": "bpy.context.selected_objects",
    "bpy.context.visible_objects.index(obj)": "bpy.context.visible_objects",
    "selected_objects.sort(key=lambda o: o.name)": "bpy.types.Context.selected_objects",
    "bpy.context.selected_objects.copy()[0].location": "bpy.types.Object.location",
    "bpy.app.version_string.split('.')": "bpy.app.version_string",
    "bpy.app.version_string.split('.')[0].isdigit()": "bpy.app.version_string",
    "bpy.app.build_hash.decode('ascii')": "bpy.app.build_hash",
    "bpy.app.driver_namespace.get('x')": "bpy.app.driver_namespace",
    "bpy.app.version.index(5)": "bpy.app.version",
    "bpy.context.mode.startswith('EDIT')": "bpy.context.mode",
    "obj.name.split('.')[0]": "bpy.types.ID.name",
    "obj.type.lower() == 'mesh'": "bpy.types.Object.type",
}


@pytest.mark.parametrize("written", READ)
def test_a_method_of_a_value_leads_to_what_holds_it(kb: KnowledgeBase, written: str) -> None:
    answer = kb.query(written)
    assert first_id(answer) == READ[written]
    assert not [note for note in answer.notes if "has no" in note or "does not exist" in note]


@pytest.mark.parametrize(
    ("written", "said"),
    [
        ("bpy.context.selected_objects.append(obj)", "`append` changes that one only. Select an object with"),
        ("bpy.context.visible_objects.sort()", "`sort` changes that one only. Keep it in a variable"),
        ("bpy.context.mode.split('_')", "`bpy.context.mode` is a Python `str`, which has `split`."),
    ],
)
def test_what_a_method_does_there_is_said(kb: KnowledgeBase, written: str, said: str) -> None:
    assert [note for note in kb.query(written).notes if said in note]


def test_what_a_method_gives_is_no_value_of_the_property(kb: KnowledgeBase) -> None:
    assert not [
        note for note in kb.query("bpy.context.mode.split('_')[0] == 'EDIT'").notes if "'EDIT'" in note
    ]


def test_a_name_that_no_text_has_is_still_missing(kb: KnowledgeBase) -> None:
    assert "`bpy.app.version_string` has no `spilt`" in " ".join(
        kb.query("bpy.app.version_string.spilt").notes
    )


@pytest.mark.parametrize("code", ["value.upper()", "node.upper()", "key.lower()", "mat.startswith(1)"])
def test_a_variable_that_does_what_texts_do_holds_one(kb: KnowledgeBase, code: str) -> None:
    assert "has no" not in "\n".join(kb.query(code).notes)


@pytest.mark.parametrize("code", ["obj.append(1)", "image.shape"])
def test_what_lists_and_arrays_do_is_looked_at(kb: KnowledgeBase, code: str) -> None:
    assert "has no" in "\n".join(kb.query(code).notes)
