"""Which arrays of numbers Blender gives as values of mathutils, by their subtype and size."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_OF_SUBTYPE = {
    "TRANSLATION": "Vector", "XYZ": "Vector", "DIRECTION": "Vector", "VELOCITY": "Vector", "ACCELERATION": "Vector",
    "XYZ_LENGTH": "Vector", "COORDINATES": "Vector", "EULER": "Euler", "QUATERNION": "Quaternion",
    "MATRIX": "Matrix", "COLOR": "Color", "COLOR_GAMMA": "Color",
}  # fmt: skip


def math_class(symbol: Symbol) -> str:
    """The class of mathutils that a property's value is an instance of: ``mathutils.Color``; empty for none.

    A colour with alpha is an array, as are numbers of other sizes.
    """
    name = _OF_SUBTYPE.get(symbol.subtype, "") if symbol.type == "float" else ""
    return f"mathutils.{name}" if _has_size_of(name, symbol.array) else ""


def _has_size_of(name: str, array: tuple[int, ...]) -> bool:
    match name:
        case "Matrix":
            return len(array) == 2
        case "Color" | "Euler":
            return array == (3,)
        case "Quaternion":
            return array == (4,)
        case "Vector":
            return len(array) == 1 and 2 <= array[0] <= 4
        case _:
            return False
