"""Values of which a script only knows the base class: ``object.modifiers[0]`` is a Modifier, and has more than that.

A family is a class that derives from every class below its base, so it has the members of all of them and is accepted
where any of them is. A member that they declare differently is the base's, or anything. A family is only ever used as
``family | Any``: what no member has is an error, and ``isinstance`` decides the rest.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS, OPEN_CLASSES
from kb_build.symbols.api_names import ID, NODE, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.flow.blender.api import Api

MODULE = "bpy._families"
OBJECT_DATA_FAMILY = f"{MODULE}.AnyObjectData"
_WITHOUT = frozenset({STRUCT, f"{T}Operator", f"{T}Panel", f"{T}Menu", f"{T}Header", f"{T}UIList"})
# Scripts derive nodes, trees and sockets too, but read far more of Blender's own.
_OWN = frozenset({NODE, f"{T}NodeTree", f"{T}NodeSocket", f"{T}NodeTreeInterfaceSocket"})

Members = dict[str, str]  # name → declaration


class Families:
    """The families of one Blender's classes."""

    def __init__(self, api: Api) -> None:
        self._api = api
        self._names: dict[str, str] = {}

    def name(self, cls: str) -> str:
        """The family of a class in full; empty where none is needed."""
        if cls not in self._names:
            self._names[cls] = f"{MODULE}.Any{cls.rpartition('.')[2]}" if self._is_family(cls) else ""
        return self._names[cls]

    def _is_family(self, cls: str) -> bool:
        if not cls.startswith(T) or cls in _WITHOUT or cls in OPEN_CLASSES:
            return False
        if cls in DERIVED_BY_SCRIPTS and cls not in _OWN:
            return False
        return any(self._is_data(child) for child in self._api.descendants(cls))

    def _is_data(self, cls: str) -> bool:
        symbol = self._api.symbols.symbol(cls)
        return symbol is not None and not symbol.is_of_interface

    def members(self, cls: str) -> tuple[str, ...]:
        """The classes that a family derives from: those below ``cls`` that nothing derives from."""
        below = [child for child in self._api.descendants(cls) if self._is_data(child)]
        return tuple(sorted(child for child in below if not set(self._api.descendants(child)) & set(below)))

    def lines(self, declared: Mapping[str, Members]) -> list[str]:
        """The stub of the families; ``declared``: class → what it declares itself."""
        rows: list[str] = []
        for cls, name in sorted(self._names.items()):
            if name:
                rows += self._family(name, cls, self.members(cls), declared)
        data = {T + cls for cls in OBJECT_DATA.values()} & set(declared)
        data |= {member for cls in data for member in self.members(cls)}
        rows += self._family(OBJECT_DATA_FAMILY, ID, tuple(sorted(data)), declared)
        return rows

    def _family(
        self, name: str, base: str, members: tuple[str, ...], declared: Mapping[str, Members]
    ) -> list[str]:
        found: dict[str, set[str]] = {}
        for member in members:
            own: Members = {}
            for cls in reversed(self._api.lineage(member)):
                if cls != base and self._api.descends(cls, base):
                    own |= declared.get(cls, {})
            for attribute, declaration in own.items():
                found.setdefault(attribute, set()).add(declaration)
        of_base: Members = {}
        for cls in reversed(self._api.lineage(base)):
            of_base |= declared.get(cls, {})
        leaves = [cls for cls in members if not any(cls in self._api.lineage(other)[1:] for other in members)]
        rows = [f"class {name.rpartition('.')[2]}({', '.join(leaves)}):"]
        for attribute, declarations in sorted(found.items()):
            if attribute in of_base:
                rows += [f"    {line}" for line in of_base[attribute].splitlines()]
            elif len(declarations) > 1:
                rows.append(f"    {attribute}: typing.Any")
        return rows if len(rows) > 1 else [f"{rows[0]} ..."]
