"""Which arrays of numbers Blender gives as values of mathutils, by their subtype and size."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_VECTORS = frozenset(
    {"TRANSLATION", "XYZ", "DIRECTION", "VELOCITY", "ACCELERATION", "XYZ_LENGTH", "COORDINATES"}
)
_ROTATIONS: dict[tuple[int, ...], str] = {
    (3,): "Euler",
    (4,): "Quaternion",
}  # of both subtypes: the size alone tells which
_MATRICES: frozenset[tuple[int, ...]] = frozenset({(3, 3), (4, 4), (9,), (16,)})


def math_class(symbol: Symbol) -> str:
    """The class of mathutils that a property's value is an instance of: ``mathutils.Color``; empty for none."""
    return math_class_of(symbol.subtype, symbol.array) if symbol.type == "float" else ""


def math_class_of(subtype: str, array: tuple[int, ...]) -> str:
    """The class of mathutils that numbers of a subtype are an instance of, by the array's size; empty for none.

    A colour with alpha is an array, as are numbers of other sizes.
    """
    name = ""
    match subtype:
        case "MATRIX":
            name = "Matrix" if array in _MATRICES else ""
        case "COLOR" | "COLOR_GAMMA":
            name = "Color" if array == (3,) else ""
        case "EULER" | "QUATERNION":
            name = _ROTATIONS.get(array, "")
        case _ if subtype in _VECTORS:
            name = "Vector" if len(array) == 1 and 2 <= array[0] <= 4 else ""
        case _:
            pass
    return f"mathutils.{name}" if name else ""
