"""Sockets of a zone's nodes, which are there once the two nodes of the zone have been paired."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import PAIRS, WHEN_PAIRED
from kb_check.script import once_per_script
from kb_check.syntax.bodies import statement_of
from kb_check.syntax.words import attributes, named_words

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_PLAIN = (ast.Expr, ast.Assign, ast.AnnAssign)


def unpaired(script: Script, sockets: list[Symbol], node: ast.Subscript) -> str:
    """What is wrong with asking for a socket of a zone before its nodes are paired; empty if nothing surely is."""
    if not all(WHEN_PAIRED in socket.flags for socket in sockets) or _names_zones(script):
        return ""
    is_place = isinstance(node.slice, ast.Constant) and isinstance(node.slice.value, int)
    if is_place or (PAIRS in named_words(script) and not _is_paired_later(script, node)):
        return ""  # another socket is in its place before
    return f"`{sockets[0].path}` is there once `{PAIRS}` has been called, which comes before."


@once_per_script
def _names_zones(script: Script) -> bool:
    return any("zone" in word for word in named_words(script))


def _is_paired_later(script: Script, node: ast.Subscript) -> bool:
    """Whether every pairing stands further down, all of them in the body of the module itself."""
    here = statement_of(script.tree.body, node)
    if here < 0 or not isinstance(script.tree.body[here], _PLAIN):
        return False
    first = _first_pairing(script)
    return first is None or first > here


@once_per_script
def _first_pairing(script: Script) -> int | None:
    """The place of the statement that pairs first; -1 where one of them is not to be seen, None for no pairing."""
    body = script.tree.body
    places = [statement_of(body, call) for call in attributes(script).get(PAIRS, ())]
    return min((place if isinstance(body[place], _PLAIN) else -1 for place in places), default=None)
