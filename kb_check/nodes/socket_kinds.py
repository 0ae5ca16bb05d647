"""Which sockets can be joined: numbers become one another, and most other things nothing else.

It is the same in every tree of every Blender (3.4 to 5.3), as the links of two sockets of each type tell.
"""

from __future__ import annotations

import re

_CLASS = re.compile(r"bpy\.types\.NodeSocket([A-Z][a-z]+)\w*")
_NUMBERS = frozenset({"Bool", "Color", "Float", "Int", "Vector"})
_THINGS = frozenset(
    {
        "Bundle", "Closure", "Collection", "Font", "Geometry", "Image", "Material", "Matrix", "Object", "Rotation",
        "Shader", "String",
    }
)  # fmt: skip
_TURNS = frozenset(
    {
        ("Float", "Rotation"), ("Matrix", "Rotation"), ("Rotation", "Matrix"), ("Rotation", "Vector"),
        ("Vector", "Rotation"),
    }
)  # fmt: skip
# Named like a number's, and of another kind.
_OTHERS = ("IntVector", "Virtual", "Standard")


def kind_of(cls: str) -> str:
    """What a socket of a class carries, ``Float`` for ``NodeSocketFloatFactor``; empty for what is not known here."""
    match = _CLASS.fullmatch(cls)
    kind = match[1] if match else ""
    is_other = cls.rpartition("NodeSocket")[2].startswith(_OTHERS)
    return kind if kind in _NUMBERS | _THINGS and not is_other else ""


def can_be_joined(source: str, target: str) -> bool:
    """Whether what a socket carries (see :func:`kind_of`) can go into another one."""
    if source == target or (source, target) in _TURNS:
        return True
    return source in _NUMBERS and (target in _NUMBERS or target == "Shader")
