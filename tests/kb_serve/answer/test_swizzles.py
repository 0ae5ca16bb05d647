"""A vector's many members of the same kind take one line."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import pytest
from told_by_blender import told_by_blender

from kb_serve.answer.facts.swizzles import swizzle_text, without_swizzles

if TYPE_CHECKING:
    from pathlib import Path

    from kb_serve.knowledge_base import KnowledgeBase
    from kb_serve.reader import BaseReader


# name → the fewest parts of a vector that has it, and whether it can be assigned.
_ASK = """
import json, sys
import bpy
from mathutils import Vector
found = {}
for name in json.load(open(sys.argv[-1])):
    has = [size for size in (2, 3, 4) if hasattr(Vector([1.0] * size), name)]
    try:
        setattr(Vector([1.0] * 4), name, [2.0] * len(name))
        is_set = True
    except AttributeError:
        is_set = False
    found[name] = [min(has), is_set]
json.dump(found, open(sys.argv[-1], "w"))
"""


def test_a_vector_names_its_parts_and_not_every_order_of_them(kb: KnowledgeBase) -> None:
    text = kb.query("mathutils.Vector", max_tokens=8_000).text
    assert "`xxyw`" not in text
    assert (
        "- `zyx`, `xx` and so on, 336 in all: `x`, `y`, `z`, `w` put together in any order, two to 4 of them, "
        "as a new Vector"
    ) in text
    assert "`length` float" in text
    assert "`normalized()`" in text


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("mathutils.Vector.wxyy", "of a vector with 4 parts · read-only, `y` is in it more than once"),
        ("mathutils.Vector.zx", "of a vector with 3 parts or more · can be assigned"),
        ("mathutils.Vector.x", ""),
        ("mathutils.Vector.length", ""),
        ("mathutils.Color.hsv", ""),
    ],
)
def test_a_name_tells_what_it_asks_of_a_vector(reader: BaseReader, path: str, expected: str) -> None:
    symbol = reader.symbol(path)
    assert symbol is not None
    assert swizzle_text(symbol, reader) == expected


def test_every_vector_takes_what_the_names_of_its_parts_say(reader: BaseReader, tmp_path: Path) -> None:
    told = {
        entry.name: swizzle_text(symbol, reader)
        for entry in reader.members("mathutils.Vector").values()
        if (symbol := reader.symbol(entry.path)) and swizzle_text(symbol, reader)
    }
    assert len(told) == 336
    found = told_by_blender(_ASK, tmp_path, [*told])
    assert found == {
        name: [int(re.findall(r"with (\d)", text)[0]), "can be assigned" in text]
        for name, text in told.items()
    }


def test_other_classes_keep_all_members(reader: BaseReader) -> None:
    for cls in ("mathutils.Quaternion", "mathutils.Color", "bpy.types.Object"):
        members = list(reader.members(cls).values())
        assert without_swizzles(members) == (members, "")
