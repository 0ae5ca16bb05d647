"""Which properties can be animated where they are: RNA's own flag does not ask what owns them.

Keys and drivers are kept in the animation data of a data-block, which images, brushes, texts and screens do not have.
Preferences and key maps are no data-blocks at all. An Action has none either: what it holds takes no key, and the
curves of drivers, which are of the same classes, are no reason to say so.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from kb_build.symbols.api_names import ID, TYPES
from kb_build.symbols.flag_names import ANIMATABLE

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping

_KEPT_IN = "animation_data"
_ACTION = "action"  # … of that: the Action with the curves
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


def _held(classes: _Classes, cls: str, pointed_to: Container[str] = ()) -> Iterator[str]:
    """The classes of what a struct of a class holds itself: no other data-blocks, and of those ``pointed_to`` only what
    stands in a collection that adds and removes.
    """
    for above in classes.ancestry(cls):
        for row in classes.properties[above]:
            target = row.get("target", "")
            if not target or row["path"].rpartition(".")[2] in _OF_CLASSES:
                continue
            if target == _UNTOLD:  # where RNA names no class, those that are called after the owner
                yield from classes.of_name(above)
            elif not classes.is_data_block(TYPES + target):
                if row.get("collection") or TYPES + target not in pointed_to:
                    yield TYPES + target
                yield f"{TYPES}{row.get('collection', '')}"


def _all_held(
    classes: _Classes, owners: Iterable[str], *, without: Container[str] = (), pointed_to: Container[str] = ()
) -> set[str]:
    """Classes with all that they hold, and what that holds, but nothing of the classes ``without``."""
    waiting = [*owners]
    found: set[str] = set()
    while waiting:
        for cls in classes.below(waiting.pop()):
            if cls not in found and cls not in without:
                found.add(cls)
                waiting += _held(classes, cls, pointed_to)
    return found


def _elements(classes: _Classes, owners: Iterable[str]) -> set[str]:
    """The classes of what stands in the collections of some classes."""
    rows = (row for cls in owners for row in classes.properties[cls])
    return {TYPES + row.get("target", "") for row in rows if row["type"] == "collection"}


def _with_animation(classes: _Classes) -> set[str]:
    """The classes of data-blocks with animation data, of all that these hold, and what those inherit from."""
    kept_in = [
        row
        for cls, rows in list(classes.properties.items())
        for row in rows
        if row["path"] == f"{cls}.{_KEPT_IN}"
    ]
    animation = {TYPES + row.get("target", "") for row in kept_in}
    actions = [
        TYPES + row.get("target", "")
        for cls in animation
        for row in classes.properties[cls]
        if row["path"] == f"{cls}.{_ACTION}"
    ]
    of_actions = _all_held(classes, actions)
    found = _all_held(
        classes,
        [row["owner"] for row in kept_in],
        without=animation,
        pointed_to=_elements(classes, of_actions),
    )
    found |= _all_held(classes, animation) - of_actions
    return {above for cls in found for above in classes.ancestry(cls)}


def unmark_unanimated(symbols: Mapping[str, dict[str, Any]]) -> None:
    """Takes the flag of animatable properties from those that no data-block with animation data holds."""
    classes = _Classes(symbols)
    animated = _with_animation(classes)
    for row in symbols.values():
        if row["kind"] == "property" and row["owner"] in classes and row["owner"] not in animated:
            row["flags"] = [flag for flag in row.get("flags", ()) if flag != ANIMATABLE]
