"""Finds what a key may have meant in a node tree: a node by its name, a socket that is there only with some setting."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.api_names import NODE, TYPES
from kb_build.symbols.flag_names import HIDDEN
from kb_build.symbols.lines import shown_when
from kb_build.symbols.paths import last_name, socket_side

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.symbols.records import Symbol
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_NUMBER = re.compile(r"\.\d{3}$")  # of a name that was taken already
_NODES = re.compile(r"\bnodes\b")
_OF_TEXTURES = f"{TYPES}TextureNode"
_CALLED = (
    'A new `{node}` is called "{name}", where Blender speaks English and no other node has the name. Whatever it is '
    'called: `next(n for n in tree.nodes if n.bl_idname == "{node}")`; `{call}` makes one.'
)
_HIDDEN = "`{path}` is there only with `{setting}`."


def nodes_called(name: str, query: str, reader: BaseReader) -> list[SymbolEntry]:
    """The nodes that are called so while they are new, or so but for spaces or capitals, the most important first. By
    one word, which may be the name of anything, only in a query that speaks of nodes; those of textures only where
    there is no other.
    """
    asked = _NUMBER.sub("", name)
    are_asked = _NODES.search(query) is not None
    entries = map(reader.entry, dict.fromkeys(path for _, path in reader.names.by_key(key(asked))))
    found = [
        entry
        for entry in entries
        if entry
        and entry.kind == "class"
        and _is_called(entry.label, asked)
        and (are_asked or " " in entry.label)
    ]
    found = [entry for entry in found if reader.descends(entry.path, NODE)]
    others = [entry for entry in found if not entry.path.startswith(_OF_TEXTURES)]
    return reader.usage.heaviest(others or found)


def _is_called(label: str, name: str) -> bool:
    """Whether a name is a label or nearly so: an object is called Icosphere, a node Ico Sphere."""
    return label.casefold() == name.casefold() or label.replace(" ", "") == name


def on_called(nodes: Sequence[SymbolEntry], reader: BaseReader) -> Iterator[str]:
    """What is said of a name that new nodes get: of the most important one."""
    made = reader.makers.creations([node.path for node in nodes[:1]])
    for node in nodes[:1]:
        if node.path in made:
            yield _CALLED.format(node=last_name(node.path), name=node.label, call=made[node.path].call)


def sockets_by_setting(name: str, reader: BaseReader) -> list[Symbol]:
    """The sockets called so that nodes have only with some setting. Another one, or one of several by that name, is
    there at any time.
    """
    entries = [entry for entry in reader.names.by_name(name) if entry.kind == "socket"]
    symbols = filter(None, (reader.symbol(entry.path) for entry in entries))
    return [
        symbol
        for symbol in symbols
        if HIDDEN in symbol.flags and shown_when(symbol) and _is_alone(symbol, reader)
    ]


def _is_alone(socket: Symbol, reader: BaseReader) -> bool:
    """Whether no other socket on that side of its node has its label."""
    labelled = [path for path, label in _labels(socket.owner, reader) if label == socket.label]
    return sum(socket_side(path) == socket.side for path in labelled) == 1


def _labels(node: str, reader: BaseReader) -> Iterator[tuple[str, str]]:
    return ((entry.path, entry.label) for entry in reader.members(node).values() if entry.kind == "socket")


def on_setting(sockets: Sequence[Symbol]) -> Iterator[str]:
    """What is said of sockets that are there only with some setting."""
    for socket in sockets:
        yield _HIDDEN.format(path=socket.path.removeprefix(TYPES), setting=shown_when(socket))
