"""Finds the input of a node that is meant by a name which the node lacks, or what is made of such nodes:
``material.base_color``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import NODE, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_ZONE_START, _ZONE_END = "Input", "Output"  # the last words of the classes of nodes that are made in pairs
# What is made of nodes → the one of a new one's that says how it looks.
_LOOK = {
    f"{TYPES}Material": f"{TYPES}ShaderNodeBsdfPrincipled",
    f"{TYPES}World": f"{TYPES}ShaderNodeBackground",
}


class MeantInput(NamedTuple):
    """The path of an input, and a sentence on where it is, if that is not the thing that lacks the name."""

    path: str
    note: str = ""


def input_meant(owner: str, name: str, reader: BaseReader) -> MeantInput | None:
    """The input that is called as a name: of the node that lacks it, of the node where a zone begins that ends with it,
    or of the node that a thing which lacks it is made with.
    """
    look = reader.entry(_LOOK.get(owner, ""))
    if look is not None:
        found = _called(name, look, reader)
        return MeantInput(found.path, _of_look(owner, found, look)) if found else None
    for node in _nodes(owner, reader):
        if found := _called(name, node, reader):
            return MeantInput(found.path)
    return None


def _nodes(owner: str, reader: BaseReader) -> Iterator[SymbolEntry]:
    node = reader.entry(owner)
    if node is None or not reader.descends(node.path, NODE):
        return
    yield node
    if owner.endswith(_ZONE_END) and (start := reader.entry(owner.removesuffix(_ZONE_END) + _ZONE_START)):
        yield start


def _called(name: str, node: SymbolEntry, reader: BaseReader) -> SymbolEntry | None:
    """The input whose label is a name, else the first whose label begins with its words."""
    inputs = [member for own, member in reader.members(node.path).items() if own.startswith("inputs[")]
    said = words(name)
    begins = (one for one in inputs if said and words(one.label)[: len(said)] == said)
    return next((one for one in inputs if key(one.label) == key(name)), None) or next(begins, None)


def _of_look(owner: str, found: SymbolEntry, look: SymbolEntry) -> str:
    cls = owner.removeprefix(TYPES)
    access = f'{cls.lower()}.node_tree.nodes["{look.label}"].inputs["{found.label}"].default_value'
    return f"What a {cls.lower()} looks like is set at its nodes, here `{access}`."
