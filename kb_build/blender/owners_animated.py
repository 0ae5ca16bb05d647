"""Which properties can be animated where they are: RNA's own flag does not ask what owns them.

Keys and drivers are kept in the animation data of a data-block, which images, brushes, texts and screens do not have.
Preferences and key maps are no data-blocks at all.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from kb_build.symbols.api_names import ID, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_ANIMATABLE = "animatable"
_KEPT_IN = "animation_data"
# Of every struct: its own class, which belongs to no data-block.
_OF_CLASSES = frozenset({"rna_type", "bl_rna"})
_UNTOLD = "UnknownType"


class _Classes:
    """RNA's classes, with what each inherits and what it has."""

    def __init__(self, symbols: Mapping[str, dict[str, Any]]) -> None:
        self._bases = {
            path: row.get("base", "") for path, row in symbols.items() if _is_class_of_rna(path, row["kind"])
        }
        self.properties: dict[str, list[dict[str, Any]]] = defaultdict(list)
        self._below: dict[str, list[str]] = defaultdict(list)
        for row in symbols.values():
            if row["kind"] == "property" and row["owner"] in self._bases:
                self.properties[row["owner"]].append(row)
        for cls in self._bases:
            for above in self.ancestry(cls):
                self._below[above].append(cls)

    def __contains__(self, cls: str) -> bool:
        return cls in self._bases

    def ancestry(self, cls: str) -> Iterator[str]:
        """A class and those that it inherits from."""
        while cls:
            yield cls
            cls = self._bases.get(cls, "")

    def below(self, cls: str) -> list[str]:
        """A class and those that inherit from it."""
        return self._below.get(cls, [])

    def of_name(self, beginning: str) -> Iterator[str]:
        """The classes whose names begin so."""
        return (cls for cls in self._bases if cls.startswith(beginning))

    def is_data_block(self, cls: str) -> bool:
        return ID in self.ancestry(cls)


def _is_class_of_rna(path: str, kind: str) -> bool:
    return kind == "class" and path.startswith(TYPES)


def _held(classes: _Classes, cls: str) -> Iterator[str]:
    """The classes of what a struct of a class holds itself: no other data-blocks."""
    for above in classes.ancestry(cls):
        for row in classes.properties[above]:
            target = row.get("target", "")
            if not target or row["path"].rpartition(".")[2] in _OF_CLASSES:
                continue
            if target == _UNTOLD:  # where RNA names no class, those that are called after the owner
                yield from classes.of_name(above)
            elif not classes.is_data_block(TYPES + target):
                yield TYPES + target
                yield f"{TYPES}{row.get('collection', '')}"


def _with_animation(classes: _Classes) -> set[str]:
    """The classes of data-blocks with animation data, of all that these hold, and what those inherit from."""
    waiting = [
        cls
        for cls, rows in list(classes.properties.items())
        if any(row["path"] == f"{cls}.{_KEPT_IN}" for row in rows)
    ]
    found: set[str] = set()
    while waiting:
        for cls in classes.below(waiting.pop()):
            if cls not in found:
                found.add(cls)
                waiting += _held(classes, cls)
    return {above for cls in found for above in classes.ancestry(cls)}


def unmark_unanimated(symbols: Mapping[str, dict[str, Any]]) -> None:
    """Takes the flag of animatable properties from those that no data-block with animation data holds."""
    classes = _Classes(symbols)
    animated = _with_animation(classes)
    for row in symbols.values():
        if row["kind"] == "property" and row["owner"] in classes and row["owner"] not in animated:
            row["flags"] = [flag for flag in row.get("flags", ()) if flag != _ANIMATABLE]
