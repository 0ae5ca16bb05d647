"""Sockets of a node group are made by its interface: ``group.interface.new_socket(…)``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place

_SIDES = {
    "bpy.types.NodeTree.inputs": "INPUT",
    "bpy.types.NodeTree.outputs": "OUTPUT",
}


def _propose(place: Place) -> Iterator[Change]:
    for row, symbol in place.gone(*_SIDES):
        method = place.parent(row.node)
        call = place.parent(method) if method is not None else None
        if (
            not isinstance(row.node, ast.Attribute)
            or not isinstance(method, ast.Attribute)
            or not isinstance(call, ast.Call)
            or call.func is not method
        ):
            continue
        interface = f"{place.operand(row.node.value)}.interface"
        if method.attr == "remove" and len(call.args) == 1:
            yield place.change(REWRITE.id, symbol, [place.write(method, f"{interface}.remove")])
        elif method.attr == "new" and (made := _arguments(place, call)):
            kind, name = made
            text = f'{interface}.new_socket(name={name}, in_out="{_SIDES[symbol]}", socket_type={kind})'
            yield place.change(
                REWRITE.id, symbol, [place.write(call, text)],
                targets=["bpy.types.NodeTreeInterface.new_socket"],
            )  # fmt: skip


def _arguments(place: Place, call: ast.Call) -> tuple[str, str] | None:
    """The type and the name that a socket was made with, as they are written now; None if one is not certain."""
    given = dict(zip(("type", "name"), call.args, strict=False))
    given |= {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    if set(given) != {"type", "name"} or any(isinstance(value, ast.Starred) for value in given.values()):
        return None
    kind = given["type"]
    if not isinstance(kind, ast.Constant):
        return place.argument(kind), place.argument(given["name"])
    # The interface has one type for all kinds of a socket: NodeSocketFloatFactor is a NodeSocketFloat.
    return (place.text(kind), place.argument(given["name"])) if kind.value in _TYPES else None


_TYPES = frozenset(
    f"NodeSocket{name}"
    for name in (  # noqa: SIM905
        "Float Int Bool Vector Color Rotation Matrix String Menu Shader Geometry Object Collection Image "
        "Material Texture"
    ).split()
)
REWRITE = Rewrite("interface-socket", _propose)
