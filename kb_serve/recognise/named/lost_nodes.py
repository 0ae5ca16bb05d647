"""Finds the nodes that other versions alone have by what people call them: ``Musgrave node``, ``composite node``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.index.analysis import key
from kb_build.symbols.flags import NODE_FAMILIES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.reader import BaseReader

_NODE = frozenset({"node", "nodes"})
_KINDS = ("", "Tex", "Bsdf")  # what the classes of shader nodes say besides
_KIND_WORDS = frozenset({"bsdf", "texture"})
_OF_OLD_TEXTURES = (
    "TextureNodeTex"  # the trees of textures have kept a node for each, whatever others have lost
)
_SYSTEMS = frozenset({"compositing", "compositor", "function", "geometry", "shader"})  # not a node's name
_LONGEST = 2  # words
_OF_CLASSES = 2  # dots in the path of a class


def lost_nodes(words: Sequence[str], reader: BaseReader) -> Iterator[str]:
    """The paths of the nodes that are gone, and have a successor, whose names are the words before ``node``."""
    for place, word in enumerate(words):
        is_named = word in _NODE and _SYSTEMS.isdisjoint(words[max(0, place - 1) : place])
        for length in range(min(place, _LONGEST), 0, -1) if is_named else ():
            said = "".join(one for one in words[place - length : place] if one not in _KIND_WORDS)
            named = [f"{family}{kind}{said}" for family in NODE_FAMILIES for kind in _KINDS]
            names = [key(name) for name in named if not name.startswith(_OF_OLD_TEXTURES)]
            if any(map(reader.names.by_key, names)):  # Blender has a node that is called so
                break
            found = [
                path
                for name in names
                for path in reader.history.removed_by_key(name)
                if reader.history.successors(path)
            ]
            if found:
                yield from dict.fromkeys(path for path in found if path.count(".") == _OF_CLASSES)
                break
