"""The classes of Blender's API: how they derive from each other, and what each has itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.blender.symbols import Symbols
    from kb_build.symbols.records import Symbol

_MOST_CLASSES = 2_000


class Classes:
    """The classes of one Blender. What is there is kept; names that are not would be without end."""

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self._own: dict[str, dict[str, Symbol]] = {}
        self._lineages: dict[str, tuple[str, ...]] = {}
        self._descendants: dict[str, tuple[str, ...]] = {}
        self._named: dict[tuple[str, str], str] = {}

    def is_class(self, path: str) -> bool:
        """Whether the path is a class."""
        symbol = self.symbols.symbol(path)
        return symbol is not None and symbol.kind == "class"

    def lineage(self, cls: str) -> tuple[str, ...]:
        """A class and its bases, nearest first."""
        found = self._lineages.get(cls)
        if found is None:
            names: list[str] = []
            path = cls
            while path and path not in names and (symbol := self.symbols.symbol(path)):
                names.append(path)
                path = symbol.base
            found = tuple(names)
            if names:
                self._lineages[cls] = found
        return found

    def descends(self, cls: str, ancestor: str) -> bool:
        """Whether a class is ``ancestor`` or derives from it."""
        return cls == ancestor or ancestor in self.lineage(cls)

    def descendants(self, cls: str) -> tuple[str, ...]:
        """Every class below a class."""
        found = self._descendants.get(cls)
        if found is None:
            queue, names = [cls], dict[str, None]()
            while queue and len(names) < _MOST_CLASSES:
                for child in self.symbols.subclasses(queue.pop()):
                    if child not in names:
                        names[child] = None
                        queue.append(child)
            found = self._descendants[cls] = tuple(names)
        return found

    def class_named(self, name: str, scope: str = "") -> str:
        """The path of the class that a name in the text of a type means, seen from the symbol ``scope``."""
        key = name, scope
        found = self._named.get(key)
        if found is None:
            found = self._named[key] = next(
                (path for path in self._candidates(name, scope) if self.is_class(path)), ""
            )
        return found

    @staticmethod
    def _candidates(name: str, scope: str) -> Iterator[str]:
        if "." in name:
            yield name
        last = name.rpartition(".")[2]
        while "." in scope:
            scope = scope.rpartition(".")[0]
            yield f"{scope}.{last}"
        yield f"{T}{last}"
        yield f"mathutils.{last}"
        yield f"bmesh.types.{last}"
        yield f"gpu.types.{last}"
        yield f"mathutils.{last.lower()}.{last}"

    def own(self, owner: str) -> dict[str, Symbol]:
        """What a class or module has itself, by name; without sockets."""
        found = self._own.get(owner)
        if found is None:
            found = {symbol.name: symbol for symbol in self.symbols.members(owner) if symbol.kind != "socket"}
            self._own[owner] = found
        return found

    def own_member(self, owner: str, name: str) -> Symbol | None:
        """One of them; all would be thousands, of ``bpy.types`` say."""
        if (own := self._own.get(owner)) is not None:
            return own.get(name)
        symbol = self.symbols.symbol(f"{owner}.{name}")
        return symbol if symbol is not None and symbol.kind != "socket" else None

    def inherited(self, cls: str, name: str) -> Symbol | None:
        """A member of a class, inherited ones included, or of a module."""
        members = (self.own_member(ancestor, name) for ancestor in self.lineage(cls) or (cls,))
        return next((member for member in members if member is not None), None)
