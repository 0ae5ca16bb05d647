"""Blender's types that scripts derive classes from and register.

What Blender demands of such a class, and which of its functions it calls, is in the base: it was asked.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import MUST_HAVE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.blender.api import Api
    from kb_build.symbols.records import Symbol

_WITH_PROPERTIES = (
    "AddonPreferences", "Gizmo", "GizmoGroup", "Macro", "Node", "NodeSocket", "NodeTree", "Operator", "PropertyGroup",
    "UIList",
)  # fmt: skip
_WITHOUT = ("AssetShelf", "FileHandler", "Header", "KeyingSetInfo", "Menu", "Panel", "RenderEngine")
# Those on which annotations become properties, which the others only drop.
MAKE_PROPERTIES = frozenset(f"{T}{name}" for name in _WITH_PROPERTIES)
TYPES = MAKE_PROPERTIES | frozenset(f"{T}{name}" for name in _WITHOUT)
# An operator gets the name of its class where it has no ``bl_idname``, and such a name is refused.
_NAMED = frozenset({f"{T}Macro", f"{T}Operator"})
# Functions that may take fewer arguments than they get, and the fewest, with ``self``.
FEWEST_ARGUMENTS = {f"{T}UIList.draw_item": 7}


def needs(path: str, api: Api) -> tuple[str, ...]:
    """The attributes and functions without which Blender refuses a class derived from a type."""
    symbol = api.symbols.symbol(path)
    names = symbol.flagged(MUST_HAVE) if symbol else ()
    return ("bl_idname", *names) if path in _NAMED else names


def callbacks(path: str, api: Api) -> Iterator[Symbol]:
    """The functions that Blender calls on classes derived from a type."""
    for symbol in api.symbols.members(path):
        if symbol.is_called_back:
            yield symbol
