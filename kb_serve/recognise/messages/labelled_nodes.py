"""Finds the socket that a message lacks on the node that is named beside it as Blender shows it: Render Layers."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.symbols.paths import last_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_serve.reader import BaseReader

_WORD = re.compile(r"[A-Za-z0-9]+")
_MOST_WORDS = 5  # of a label
_SIDES = ("inputs", "outputs")


def sockets_of_labelled_nodes(name: str, query: str, reader: BaseReader) -> list[str]:
    """The paths of the sockets called so, those of the side first that the query has; none without such a node."""
    sides = sorted(_SIDES, key=lambda side: side not in query)
    paths = (f'{node}.{side}["{name}"]' for node in _labelled(query, reader) for side in sides)
    return [path for path in paths if reader.entry(path)]


def _labelled(query: str, reader: BaseReader) -> Iterator[str]:
    """The classes of nodes whose labels stand in the query, the longest first."""
    words = [word.lower() for word in _WORD.findall(query)]
    for length in range(_MOST_WORDS, 1, -1):
        for start in range(len(words) - length + 1):
            label = " ".join(words[start : start + length])
            for path in reader.names.labelled_classes.get(label, ()):
                if "Node" in last_name(path):
                    yield path
