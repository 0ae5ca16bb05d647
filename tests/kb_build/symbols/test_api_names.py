"""Which classes of Blender are the interface's, by their names."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.symbols.api_names import TYPES, interface_part

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase

_BASES = {
    "Panel": "PT",
    "Menu": "MT",
    "Header": "HT",
    "Operator": "OT",
    "UIList": "UL",
    "AssetShelf": "AST",
    "FileHandler": "FH",
}


@pytest.mark.parametrize(("cls", "part"), _BASES.items())
def test_a_class_is_of_the_part_that_it_derives_from(cls: str, part: str, kb: KnowledgeBase) -> None:
    below = list(kb.reader.descendants(TYPES + cls))
    assert len(below) > 5
    assert {interface_part(entry.path) for entry in below} == {part}
    assert {interface_part(entry.name) for entry in below} == {part}


def test_classes_of_data_are_of_no_part(kb: KnowledgeBase) -> None:
    assert [path for path, _ in kb.reader.names.data_classes if interface_part(path)] == []


@pytest.mark.parametrize(
    "name",
    [
        "Mesh",
        "bpy_struct",
        "MOD_HUE_SATURATION",
        "Object.VIEW3D_PT_tools",
    ],
)
def test_other_names_are_of_no_part(name: str) -> None:
    assert interface_part(name) == interface_part(TYPES + name) == ""


def test_members_are_of_what_their_class_is() -> None:
    assert interface_part(f"{TYPES}VIEW3D_PT_tools.bl_label") == "PT"
