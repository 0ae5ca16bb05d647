"""Sockets that are asked for by their places: ``node.inputs[7]``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import NODE, SIDES

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


class SocketAt(NamedTuple):
    """``place`` is the path that the history has for it, ``class.inputs[7]``, ``subscript`` its end."""

    place: str
    subscript: str
    socket: Symbol

    @property
    def by_name(self) -> str:
        """The subscript that gives it by its name, ``inputs["IOR"]``; empty where only its place does."""
        return by_name(self.socket)


def by_name(socket: Symbol) -> str:
    """The subscript that gives a socket by its name; empty where only its place does."""
    return next((subscript for subscript in socket.subscripts if '["' in subscript), "")


def sockets_by_place(script: Script) -> Iterator[tuple[ast.Subscript, SocketAt]]:
    """Each subscript that gives a socket by its number, with that; not where the node's class is not sure."""
    for node in script.all(ast.Subscript):
        number = node.slice.value if isinstance(node.slice, ast.Constant) else None
        if not isinstance(node.value, ast.Attribute) or type(number) is not int:
            continue
        cls, side = script.class_of(node.value.value), node.value.attr
        if side not in SIDES or not cls or not script.api.descends(cls, NODE):
            continue
        subscript = f"{side}[{number}]"
        for socket in script.api.sockets(cls, side):
            if subscript in socket.subscripts:
                yield node, SocketAt(f"{socket.owner}.{subscript}", subscript, socket)
                break
