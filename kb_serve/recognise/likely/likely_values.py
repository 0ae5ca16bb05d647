"""Which items of an enumeration may be meant by a value that it lacks."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, terms, words
from kb_serve.recognise.likely.corrections import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import EnumItem, Symbol
    from kb_serve.reader import BaseReader

_MOST_LISTED = 8
_MOST = 3
_LONG = 4  # letters of an item that a wrong one begins with
_TELLING = 2  # words of a label that other texts have
_SHORT = 3  # … of a wrong one that an item begins with
_OF = " - "
_OPPOSITES = frozenset({"neg", "negative"})
# The parts that attributes are kept on, as they are called elsewhere.
_DOMAINS = {
    "POINT": frozenset({"VERT", "VERTEX", "VERTICES", "VERTS"}),
    "CORNER": frozenset({"FACE_CORNER", "LOOP", "LOOPS"}),
    "FACE": frozenset({"POLY", "POLYGON", "POLYGONS"}),
}
_MINUS = re.compile(r"-(?=[XYZ]$)")


def item_called(setting: Symbol | None, names: Iterable[str]) -> str:
    """The item of an enumeration whose label is one of some names, however it is spelled; empty for none."""
    keys = {key(name) for name in names}
    return (
        next((one.identifier for one in setting.enum_items if key(one.name) in keys), "") if setting else ""
    )


def same_elsewhere(written: str, items: Iterable[str]) -> list[str]:
    """The items of the same name that are of something else: ``AgX - High Contrast`` for ``High Contrast``."""
    name = written.rpartition(_OF)[2]
    return [item for item in items if item != written and item.rpartition(_OF)[2] == name][:_MOST]


def likely_values(written: str, items: Sequence[str]) -> list[str]:
    """The items that a wrong one may mean: those of the same name that are of something else, ``AgX - High Contrast``
    for ``Filmic - High Contrast``; of those that point the same way, ``NEGATIVE_Z`` for ``-Z``, those that are
    most like it, those that it begins with, or the other way round, or else those that it is made of and more.
    """
    written = _MINUS.sub("NEGATIVE_", written)
    if same := same_elsewhere(written, items) or _of_same_letters(written, items):
        return same
    if same := _of_same_sense(written, items) or _of_same_part(written, items):
        return same
    items = [*_without_opposites(written, items)]
    said = written.upper()
    # ``ARMATURE_AUTOMATIC`` begins with ``ARMATURE_AUTO``, ``GREASE_PENCIL_LINEART`` ends with ``LINEART``.
    begun = [item for item in items if "_" in item and said.startswith(item)]
    ended = [item for item in items if len(item) > _LONG and said.endswith(f"_{item}")]
    if begun or ended:
        return sorted(begun or ended, key=len, reverse=True)[:_MOST]
    if similar := [item for item, _ in nearest(written, items)]:
        return _with_alike(said, similar, items)
    similar = [item for item in items if len(item) >= _LONG and said.startswith(item.upper())]
    similar = similar or [item for item in items if len(said) >= _SHORT and item.upper().startswith(said)]
    if similar:
        return similar
    own = set(words(written))
    return sorted((item for item in items if set(words(item)) <= own), key=len, reverse=True)[:1]


def _of_same_letters(written: str, items: Sequence[str]) -> list[str]:
    """The items that are spelled otherwise alone: ``EVENT_BACKSLASH`` for ``EVENT_BACK_SLASH``."""
    return [item for item in items if key(item) == key(written)]


def _of_same_part(written: str, items: Sequence[str]) -> list[str]:
    """The domain of attributes that is called otherwise elsewhere: ``POINT`` for ``VERTEX``."""
    if written in items or not _DOMAINS.keys() <= {*items}:
        return []
    return [item for item, names in _DOMAINS.items() if written.upper() in names]


def _with_alike(said: str, similar: list[str], items: Iterable[str]) -> list[str]:
    """Items that one may mean, and behind the one that it only begins with those that begin so, too: ``VERTEX_3``
    behind ``VERTEX`` for ``VERTEX_TRI``.
    """
    if len(similar) > 1 or not said.startswith(f"{similar[0]}_"):
        return similar
    return [*similar, *(item for item in items if item.startswith(f"{similar[0]}_"))][:_MOST]


def value_there(written: object, items: Sequence[str]) -> str:
    """A sentence on a value for what took a name's place and takes ``items``; empty where it takes the very value."""
    if not items or written in items:
        return ""
    if likely := likely_values(written, items) if isinstance(written, str) else []:
        return f"{written!r} is {likely[0]!r} there."
    more = ", …" if len(items) > _MOST_LISTED else ""
    return f"It takes {', '.join(map(repr, items[:_MOST_LISTED]))}{more}."


def likely_items(written: str, items: Sequence[EnumItem], reader: BaseReader) -> list[str]:
    """The same of items with their labels: the one that is labelled so, ``SUBSURF`` for ``SUBDIVISION_SURFACE``; where
    none is alike, the few whose labels say it and more, or else what Blender says that things called so are.
    """
    if exact := _labelled(written, items):
        return exact
    saying_more = _saying_more(written, items)
    return (
        likely_values(written, [item.identifier for item in items])
        or (saying_more if len(saying_more) <= _MOST else [])
        or explaining(written, items, reader)
    )


def labelled_items(written: str, items: Iterable[EnumItem]) -> list[str]:
    """The items that are labelled as what is written; else those whose labels say it and more."""
    items = list(items)
    return _labelled(written, items) or _saying_more(written, items)


def _labelled(written: str, items: Iterable[EnumItem]) -> list[str]:
    """The items that are shown as what is written, ``NEGATIVE_Z`` of ``-Z``."""
    meant = written.replace("_", " ").casefold()
    return [item.identifier for item in items if item.name.casefold() == meant]


def _saying_more(written: str, items: Iterable[EnumItem]) -> list[str]:
    """The items whose labels have all words of what is written, those with the fewest others first: SUBSURF, which is
    labelled Subdivision Surface, of ``SUBDIVISION``.
    """
    said = set(terms(written))
    labels = {item.identifier: set(terms(item.name)) for item in items}
    having = [identifier for identifier, label in labels.items() if said and said <= label]
    return sorted(having, key=lambda identifier: len(labels[identifier]))


def explaining(written: str, items: Iterable[EnumItem], reader: BaseReader) -> list[str]:
    """The one item with a label of several words that the text on a collection called so has: ``CORNER``, Face Corner,
    for ``LOOP``, as the loops of a mesh are said to be face corners.
    """
    name = written.lower()
    entries = [entry for one in (name, f"{name}s") for entry in reader.names.by_name(one)]
    texts = [" ".join(terms(entry.line)) for entry in entries if entry.type == "collection"]
    labels = {item.identifier: terms(item.name) for item in items}
    found = [
        identifier
        for identifier, label in labels.items()
        if len(label) >= _TELLING and any(f" {' '.join(label)} " in f" {text} " for text in texts)
    ]
    return found if len(found) == 1 else []


def _of_same_sense(written: str, values: Iterable[str]) -> list[str]:
    """The values that have all words of one but the first, and say as it does that the opposite is meant.

    ``TRACK_NEGATIVE_Z`` for ``FORWARD_NEGATIVE_Z``.
    """
    mine = words(written)
    if _OPPOSITES.isdisjoint(mine):
        return []
    wanted = set(mine[1:]) - _OPPOSITES
    return [value for value in values if wanted <= set(words(value)) and _is_opposite(value)][:_MOST]


def _without_opposites(written: str, values: Iterable[str]) -> Iterator[str]:
    """Values without those that mean the opposite of one."""
    is_opposite = _is_opposite(written)
    return (value for value in values if _is_opposite(value) == is_opposite)


def _is_opposite(value: str) -> bool:
    return not _OPPOSITES.isdisjoint(words(value))
