"""Sockets that are asked for by their places: ``node.inputs[7]``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import NODE

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


class SocketAt(NamedTuple):
    """``place`` is the path that the history has for it, ``class.inputs[7]``."""

    place: str
    number: int
    socket: Symbol

    @property
    def by_name(self) -> str:
        """The subscript that gives it by its name, ``inputs["IOR"]``; empty where only its place does."""
        return by_name(self.socket)


def by_name(socket: Symbol) -> str:
    """The subscript that gives a socket by its name; empty where only its place does."""
    return next((subscript for subscript in socket.subscripts if '["' in subscript), "")


def socket_at(script: Script, node: ast.Subscript) -> SocketAt | None:
    """The socket that a subscript gives by its number; None where the node's class is not sure, or has none there."""
    number = node.slice.value if isinstance(node.slice, ast.Constant) else None
    if not isinstance(node.value, ast.Attribute) or type(number) is not int:
        return None
    cls, side = script.class_of(node.value.value), node.value.attr
    if not cls or not script.api.descends(cls, NODE):
        return None
    subscript = f"{side}[{number}]"
    for socket in script.api.sockets(cls, side):
        if subscript in socket.subscripts:
            return SocketAt(f"{socket.owner}.{subscript}", number, socket)
    return None
