"""A vector's many members of the same kind take one line."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.answer.swizzles import without_swizzles

if TYPE_CHECKING:
    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


def test_a_vector_names_its_parts_and_not_every_order_of_them(kb: KnowledgeBase) -> None:
    text = kb.query("mathutils.Vector", max_tokens=8_000).text
    assert "`xxyw`" not in text
    assert (
        "- `zyx`, `xx` and so on, 336 in all: `x`, `y`, `z`, `w` put together in any order, two to 4 of them, "
        "as a new Vector"
    ) in text
    assert "`length` float" in text
    assert "`normalized()`" in text


def test_other_classes_keep_all_members(reader: BaseReader) -> None:
    for cls in ("mathutils.Quaternion", "mathutils.Color", "bpy.types.Object"):
        members = list(reader.members(cls).values())
        assert without_swizzles(members) == (members, "")
