"""Symbols of other versions that a base lacks, what replaces them, and since when it has the others."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import LOST_MODULES
from kb_build.index.analysis import key, short_path
from kb_build.symbols.api_names import interface_part
from kb_build.symbols.paths import item_of, socket_name, socket_side, split_path
from kb_build.versions.arrivals import told_arrivals
from kb_build.versions.history import SHARED, paths_of
from kb_build.versions.moved_sockets import find_moved_sockets
from kb_build.versions.similar_names import find_similar_names
from kb_build.versions.socket_places import SocketPlaces
from kb_build.versions.successors import Successors, load_successors, lost_modules

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_build.versions.history import ApiHistory


_MODULE = "bpy.types"
_MADE_IN_USE = re.compile(
    r"bpy\.types\.(?:CompositorNode(?:RLayers|Image|OutputFile)|GeometryNode(?:Bake|RepeatOutput|Viewer|CaptureAttribute))"
    r"\.(?:in|out)puts\["
)
_EXTENDED = frozenset({"", "PT", "MT", "HT"})

_MEMBER = re.compile(r"(bpy\.types\.\w+)(\.\w+)(?!\w|\[)")  # not sockets


@dataclass(frozen=True, slots=True)
class RemovedSymbols:
    """Rows of the tables removed, removed_names, successors, similar_names, since and moved_sockets (see schema.DDL).

    ``versions`` are all that the history knows, oldest first; ``unknown_modules`` those that the version's build lacks,
    which says nothing about the version.
    """

    removed: tuple[tuple[str, str, str, str, str], ...] = ()
    names: tuple[tuple[str, str], ...] = ()
    successors: tuple[tuple[str, int, str, str, str, str], ...] = ()
    similar_names: tuple[tuple[str, str, float], ...] = ()
    since: tuple[tuple[str, str, str], ...] = ()
    moved_sockets: tuple[tuple[str, str, str], ...] = ()
    versions: tuple[str, ...] = ()
    unknown_modules: tuple[str, ...] = ()


def is_asked_for(path: str, history: ApiHistory, version: str) -> bool:
    """Whether scripts use it: a class, member, operator or enum item; a parameter of a function that is still there.

    Of the interface only menus, panels and headers as such: scripts add to them. Not sockets that nodes get from
    what they are used with, such as the passes of a render layer: an instance has others.
    """
    if path.startswith(SHARED) or _MADE_IN_USE.match(path):
        return False
    above, mark, name = split_path(path)
    if mark == "(" or above.endswith(")"):
        return bool(history.exists(above, version))
    if above == _MODULE:
        return interface_part(name) in _EXTENDED
    return not interface_part(above)


def _keys(path: str, items: Counter[str]) -> Iterator[str]:
    yield key(path)
    if (item := item_of(path)) and items[item] == 1:  # one that only one enumeration had
        yield key(item)
    if path.endswith('"]'):  # a socket is also asked for on a node whose class is not known
        yield key(socket_side(path) + socket_name(path))
    if (short := short_path(path)) != path:
        yield key(short)


def find_removed_symbols(symbols: Sequence[Symbol], history: ApiHistory, version: str) -> RemovedSymbols:
    """Compares ``symbols``, those of a (minor) version, with what the history knows of other versions.

    What extraction found, enum items and parameters too, is never called removed, whatever the history says.
    """
    known = {path for symbol in symbols for path in paths_of(symbol)}
    bases = {symbol.path: symbol.base for symbol in symbols if symbol.base}
    table = load_successors()
    successors = Successors([*table, *lost_modules()], history, version, bases, known)

    def moved_up(path: str) -> bool:
        """Whether a base of the class has it now: then it is still there."""
        found = _MEMBER.match(path)
        base = bases.get(found[1], "") if found else ""
        while found and base:
            if base + found[2] in known:
                return True
            base = bases.get(base, "")
        return False

    spans = [
        span
        for span in history.removed_from(version)
        if span.path not in known and is_asked_for(span.path, history, version) and not moved_up(span.path)
    ]
    removed = [(span.path, successors.came(span)[0], *successors.dated(span)) for span in spans]
    doubted = [(span.path, *came) for span in spans if (came := successors.came(span))[1]]
    dated = {row[0] for row in removed}
    stated = [
        (row.old, "", successors.before(row.version), row.version)
        for row in successors.stated()
        if row.old not in dated and row.old not in known
    ]
    items = Counter(item_of(path) for path, *_ in removed)
    # An item that an enumeration had means that one, and not also what calls that are gone took.
    others = Counter(item for path, *_ in stated if (item := item_of(path)) not in items)
    names = [(spelled, path) for path, *_ in removed for spelled in _keys(path, items)]
    # Modules of Python are plain words too (``pipes``, ``chunk``): only code means them.
    names += [
        (spelled, path) for path, *_ in stated if path not in LOST_MODULES for spelled in _keys(path, others)
    ]
    removed += stated
    rows = [
        (path, position, row.new[0] if row.new else "", row.how, row.version, row.source)
        for path, *_ in removed
        for position, row in enumerate(successors.of(path))
    ]
    return RemovedSymbols(
        removed=tuple((*row, split_path(row[0])[2]) for row in removed),
        names=tuple(names),
        successors=tuple(rows),
        similar_names=tuple(find_similar_names(symbols, history, version, {path for path, *_ in rows})),
        since=(*told_arrivals(symbols, history, version, table), *doubted),
        moved_sockets=tuple(find_moved_sockets(symbols, SocketPlaces.load(), version, rows)),
        versions=history.versions,
        unknown_modules=tuple(path for path in history.modules(version) if path not in known),
    )
