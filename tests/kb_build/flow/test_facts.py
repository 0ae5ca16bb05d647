"""What is written down of Blender by hand is true of the one that is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import NODES_WITH_SOCKETS_OF_THEIR_OWN
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


def test_nodes_whose_items_are_sockets_are_known(reader: BaseReader) -> None:
    rows = reader.rows(
        "SELECT owner FROM symbols WHERE kind = 'socket' AND name = '__extend__' GROUP BY owner"
    )
    names = {owner.removeprefix(T) for (owner,) in rows}
    unknown = {
        name
        for name in names
        if {name, name.rpartition("Node")[2]}.isdisjoint(NODES_WITH_SOCKETS_OF_THEIR_OWN)
    }
    assert len(names) > 10
    assert unknown == set()
