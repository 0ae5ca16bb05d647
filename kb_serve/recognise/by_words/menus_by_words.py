"""Finds the menu or the header of Blender's that is to be extended: ``add an item to the object context menu``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.index.analysis import STOP_WORDS, stem, words
from kb_build.symbols.api_names import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_serve.reader import BaseReader

_MOST_WORDS = 14  # with more of them it is a question about more than a menu
_MOST_ALIKE = 3
_ADDING = frozenset({"add", "append", "attach", "extend", "insert", "prepend", "put"})
_ADDED = frozenset(
    {"button", "buttons", "entries", "entry", "item", "items", "operator", "operators", "option", "options"}
)
_KINDS = {"menu": "Menu", "menus": "Menu", "submenu": "Menu", "header": "Header", "headers": "Header"}
# What comes after the word in names of node trees: of the Menu Switch node, of sockets that are menus.
_OF_NODES = frozenset({"input", "inputs", "socket", "sockets", "switch"})
_SAY_NOTHING = STOP_WORDS | _ADDED | _KINDS.keys()
_MARKS = {"Menu": "MT", "Header": "HT"}
# What an editor's classes begin with → how people call it.
_EDITORS = {
    "VIEW3D": "view3d 3d viewport view", "TOPBAR": "topbar top bar", "NODE": "node nodes shader geometry compositor",
    "IMAGE": "image uv", "SEQUENCER": "sequencer vse video", "GRAPH": "graph",
    "DOPESHEET": "dopesheet dope sheet action",
    "NLA": "nla nonlinear", "CLIP": "clip tracking", "OUTLINER": "outliner", "TEXT": "text", "CONSOLE": "console",
    "FILEBROWSER": "file browser", "ASSETBROWSER": "asset browser", "PROPERTIES": "properties", "INFO": "info",
    "SPREADSHEET": "spreadsheet", "USERPREF": "preferences", "STATUSBAR": "status bar statusbar",
}  # fmt: skip
_LIKELIEST = {"VIEW3D": 2, "TOPBAR": 1}  # which editors are meant where none is said
_NONE = (0, 0, 0)


class ExtendedMenu(NamedTuple):
    """The path of what extends a menu, and a sentence on how it is called of those that are meant."""

    path: str
    note: str


def menu_extended(query: str, reader: BaseReader) -> ExtendedMenu | None:
    """The menus or headers that a question wants something added to; None where it is not sure which."""
    said = words(query)
    kinds = (
        _KINDS[word]
        for word, after in zip(said, [*said[1:], ""], strict=False)
        if word in _KINDS and after not in _OF_NODES
    )
    kind = next(kinds, "")
    if not kind or len(said) > _MOST_WORDS or _ADDING.isdisjoint(said) or "(" in query:
        return None
    asked = {stem(word) for word in _asked(said)}
    found = [(_fit(name, asked, kind), name) for name in _names(kind, reader)]
    best = max((fit for fit, _ in found), default=_NONE)
    meant = sorted(name for fit, name in found if fit == best)
    if best == _NONE or len(meant) > _MOST_ALIKE:
        return None
    first, *others = (f"{TYPES}{name}" for name in meant)
    also = f" Others that may be meant: {', '.join(f'`{one}`' for one in others)}." if others else ""
    note = (
        f"This {kind.lower()} is `{first}`: `{first}.append(draw)` in `register()`, and `{first}.remove(draw)` in "
        '`unregister()`, with `def draw(self, context): self.layout.operator("module.name")`, adds to its end; '
        f"`prepend`, to its beginning.{also}"
    )
    return ExtendedMenu(f"{TYPES}{kind}.append", note)


def _asked(said: Sequence[str]) -> Iterator[str]:
    """The words that may be a menu's name: ``add`` only as the Add menu, not as what is wanted."""
    for place, word in enumerate(said):
        is_of_menu = place > 0 and said[place + 1 : place + 2] == ["menu"]
        if word == "click" and said[place - 1 : place] == ["right"]:
            yield "context"
        elif (is_of_menu or word not in _ADDING) and word not in _SAY_NOTHING:
            yield word


def _names(kind: str, reader: BaseReader) -> Iterator[str]:
    return (entry.name for entry in reader.descendants(f"{TYPES}{kind}"))


def _fit(name: str, asked: set[str], kind: str) -> tuple[int, int, int]:
    """How well a class's name is what is asked for: how many of its words, which must all be said, whether its editor
    is, and whether that is the one that is mostly meant.
    """
    editor, mark, own = name.partition(f"_{_MARKS[kind]}_")
    stems = {stem(word) for word in words(own)} - {stem(kind.lower())}
    in_editor = not asked.isdisjoint(map(stem, _EDITORS.get(editor, editor.lower()).split()))
    if not mark or not stems <= asked or not (stems or in_editor):
        return _NONE
    return len(stems), int(in_editor), _LIKELIEST.get(editor, 0)
