"""The types of objects, and the classes of the data that objects of a type have."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


class ObjectKinds:
    """The types of one base's objects."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def data_of(self, kind: str) -> str:
        """The class of the data of an object's type: Volume of ``VOLUME``; empty for a type without data."""
        return self._classes.get(kind, "")

    def of_data(self, cls: str) -> str:
        """The type of an object whose data is of a class; empty for none."""
        return next((kind for kind, data in self._classes.items() if self._reader.descends(cls, data)), "")

    def is_data(self, cls: str) -> bool:
        """Whether instances of a class are the data of objects."""
        return any(entry.path in self._data for entry in self._reader.lineage(cls))

    @cached_property
    def _data(self) -> frozenset[str]:
        return frozenset(self._classes.values())

    @cached_property
    def _classes(self) -> dict[str, str]:
        """An object's type → the class of its data."""
        types = self._reader.symbol(f"{TYPES}Object.type")
        classes = {key(name): path for path, name in self._reader.data_classes if path == f"{TYPES}{name}"}
        found: dict[str, str] = {}
        for item in types.enum_items if types else ():
            for name in (key(item.identifier), key(item.name)):
                if name in classes and self._is_animated(classes[name]):
                    found.setdefault(item.identifier, classes[name])
        return found

    def _is_animated(self, cls: str) -> bool:
        """Whether things of a class have animation data, as all data of objects has; a text has none."""
        return self._reader.entry(f"{cls}.animation_data") is not None
