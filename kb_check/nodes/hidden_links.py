"""Links, by index, to sockets that no setting of their node shows as the script leaves them."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.calls.resolved import callee_path
from kb_check.nodes.settings import setting_of
from kb_check.nodes.socket_modes import deciding, is_shown, showing
from kb_check.scene.made_here import LINKS_NEW, is_new
from kb_check.script import once_per_script
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def hidden_link(script: Script, socket: Symbol, node: ast.Subscript, owner: ast.expr) -> str:
    """What is wrong with a link to a socket of a node, ``owner``; empty if nothing surely is."""
    if (
        node not in _linked(script)
        or not socket.modes
        or not isinstance(owner, ast.Name)
        or not is_new(script, owner)
    ):
        return ""
    names = showing(socket)
    if len(names) > 1 and not (deciding(script, [socket]) - names).isdisjoint(named_words(script)):
        return ""
    settings = {name: setting_of(script, owner, f"{socket.owner}.{name}", node) for name in names}
    known = {name: value for name, value in settings.items() if value is not None}
    if len(known) < len(settings) or is_shown(socket, known):
        return ""
    so = " and ".join(f"`{name}` is {value!r}" for name, value in sorted(known.items()))
    return (
        f"`{script.text(script.span(node))}`, {socket.identifier!r} of the node, is hidden while {so}: a link to it "
        f"has no effect.{_shown_instead(script, socket, known)}"
    )


def _shown_instead(script: Script, socket: Symbol, settings: Mapping[str, str]) -> str:
    """A sentence about the one socket of the same label that settings show; empty where there are none, or several."""
    alike = [
        subscript
        for other in script.api.sockets(socket.owner, socket.side)
        if other.label == socket.label
        and other.path != socket.path
        and other.modes
        and is_shown(other, settings)
        for subscript in other.subscripts[-1:]
    ]
    return f" `{alike[0]}` is the one to link." if len(alike) == 1 else ""


@once_per_script
def _linked(script: Script) -> frozenset[ast.AST]:
    """The sockets that are linked by index."""
    return frozenset(
        part
        for node in script.all(ast.Call)
        if callee_path(script, node) == LINKS_NEW
        for part in (*node.args, *(keyword.value for keyword in node.keywords))
        if isinstance(part, ast.Subscript)
        and isinstance(part.slice, ast.Constant)
        and isinstance(part.slice.value, int)
    )
