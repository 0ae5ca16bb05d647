"""Which nodes may be meant by a name like those of Blender's own nodes that none has: ``ShaderNodeGlass``."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import NODE, TYPES
from kb_build.symbols.flags import NODE_FAMILIES, alike_nodes
from kb_serve.recognise.likely.corrections import is_misspelling, nearest
from kb_serve.recognise.recognition import SIMILAR, MissingName

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from kb_build.symbols.records import Symbol
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_OWN = re.compile(rf"({'|'.join(NODE_FAMILIES)})([A-Z]\w+)")
_TREES = {"FunctionNode": "GeometryNodeTree"}  # of the families that are not called as their tree
_FEW = 3
_FAR = 9  # words apart


def is_like_a_node(name: str) -> bool:
    """Whether a name begins as those of Blender's own nodes do, and goes on."""
    return _OWN.fullmatch(name) is not None and not name.endswith("Tree")


def tree_of_family(name: str) -> str:
    """The class of the trees of the family of nodes that a name belongs to: CompositorNodeTree; empty for none."""
    own = _OWN.fullmatch(name)
    return _TREES.get(own[1], f"{own[1]}Tree") if own else ""


def same_in_tree(name: str, tree: str, symbol_of: Callable[[str], Symbol | None]) -> tuple[str, ...]:
    """The nodes of a tree that are called as a node of another family: ShaderNodeMath for ``CompositorNodeMath``."""
    symbols = map(symbol_of, alike_nodes(name))
    return tuple(symbol.path for symbol in symbols if symbol and tree in symbol.trees)


def nodes_meant(name: str, reader: BaseReader) -> list[str]:
    """The paths of the nodes that a name which none has may mean, the likeliest first: those of the trees of its
    family, by what it says behind the family, spelt or labelled so, or with a word more or less.
    """
    own = _OWN.fullmatch(name)
    family, said = (own[1], own[2]) if own else ("", name)
    tree = tree_of_family(name)
    leaves = [entry for entry in reader.descendants(NODE) if not any(reader.subclasses(entry.path))]
    names = {entry.path: _behind(entry.name) for entry in leaves}
    of_family = {one: path for path, one in names.items() if path.startswith(TYPES + family)}
    alike = [one for one, _ in nearest(said, of_family)]
    misspelt = [one for one in alike if is_misspelling(said, one)]
    mine = set(words(said))
    apart = {
        entry.path: min(_apart(mine, set(words(text))) for text in (names[entry.path], entry.label))
        for entry in leaves
    }
    near = [path for path in apart if apart[path] < _FAR]
    for found in (
        [path for path, one in names.items() if key(one) == key(said)],
        [entry.path for entry in leaves if key(entry.label) == key(said)],
        [of_family[one] for one in misspelt],
        sorted(near, key=lambda path: (apart[path], not path.startswith(TYPES + family))),
        [of_family[one] for one in alike],
    ):
        if taken := _of_tree(found, tree, reader):
            return taken
    return []


def add_nodes_meant(name: str, sure: float, reader: BaseReader, recognition: Recognition) -> None:
    """Adds those nodes, the first of them so sure, and that none has the name."""
    for rank, path in enumerate(nodes_meant(name, reader)):
        recognition.add(path, sure - 0.01 * rank, SIMILAR)
    recognition.missing.append(MissingName(name))


def _apart(mine: set[str], theirs: set[str]) -> int:
    """How many words a name or label has that another has not; one that lacks more than one of its words is far."""
    if mine < theirs:
        return len(theirs) - len(mine)
    return 1 if theirs < mine and len(theirs) == len(mine) - 1 else _FAR


def _behind(name: str) -> str:
    own = _OWN.fullmatch(name)
    return own[2] if own else name


def _of_tree(paths: Iterable[str], tree: str, reader: BaseReader) -> list[str]:
    """The first nodes that a tree takes; with no tree those that any does."""
    symbols = ((path, reader.symbol(path)) for path in paths)
    taken = [path for path, one in symbols if one and (tree in one.trees if tree else one.trees)]
    return taken[:_FEW]
