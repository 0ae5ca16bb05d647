"""What a socket of a new node surely is, where a setting decides: which of several of one name, or of which type.

```python
mix = tree.nodes.new("ShaderNodeMix")
mix.inputs["A"]  # of floats, while mix.data_type is "FLOAT"
switch = tree.nodes.new("GeometryNodeSwitch")
switch.inputs["False"]  # of geometry, while switch.input_type is "GEOMETRY"
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.values.types import Instance, members
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import SHOWN_WHEN
from kb_build.symbols.flags import usual_default
from kb_check.nodes.settings import setting_of
from kb_check.nodes.socket_modes import showing, ways_of_showing

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

_SOCKET = f"{T}NodeSocket"
# The types of data, as settings of nodes call them → the classes of sockets that are not called so.
_CALLED = {
    "BOOLEAN": "Bool", "RGBA": "Color", "FLOAT_COLOR": "Color", "FLOAT_VECTOR": "Vector", "QUATERNION": "Rotation",
    "FLOAT4X4": "Matrix",
}  # fmt: skip


class Shown(NamedTuple):
    """The classes of which a socket can be, and the settings that decide it, in words."""

    classes: tuple[str, ...]
    why: str


def socket_classes(script: Script, node: ast.expr) -> Shown | None:
    """The classes of which the socket that an expression asks for can be; None where that is not known."""
    row = script.analysis.resolutions.get(node)
    if not isinstance(node, ast.Subscript) or row is None or not row.symbols or not row.sure or row.missing:
        return None
    owner = node.value.value if isinstance(node.value, ast.Attribute) else None
    sockets = [symbol for path in row.symbols if (symbol := script.api.symbols.symbol(path))]
    if not isinstance(owner, ast.Name) or not sockets or len(sockets) < len(row.symbols):
        return None
    if _may_be_any(script, owner):
        return None
    deciding = {name for socket in sockets for name in (*showing(socket), *socket.type_settings)}
    known = _known(script, owner, sockets[0].owner, deciding, node)
    found = [_class_of(script, socket, known) for socket in sockets if not _is_hidden(socket, known)]
    so = f" while {_said(known)}" if known else ""
    return Shown(tuple(dict.fromkeys(found)), so) if found and all(found) else None


def _may_be_any(script: Script, node: ast.expr) -> bool:
    """Whether a node may also be of any kind, as one whose type the script computes: its sockets are not known."""
    kind = script.type_of(node)
    kinds = members(kind) if kind else ()
    return any(isinstance(one, Instance) and script.api.descendants(one.cls) for one in kinds)


def hidden_by_settings(script: Script, sockets: list[Symbol], node: ast.Subscript) -> str:
    """What is wrong with asking a node for sockets of one name or identifier that its settings hide, all of them.

    Empty if nothing surely is.
    """
    owner = node.value.value if isinstance(node.value, ast.Attribute) else None
    key = node.slice.value if isinstance(node.slice, ast.Constant) else None
    if not isinstance(owner, ast.Name) or not isinstance(key, str):
        return ""
    if not all(_is_found_while_shown(socket, key) for socket in sockets):
        return ""
    cls, side = sockets[0].owner, sockets[0].side
    alike = [
        other for other in script.api.sockets(cls, side) if key in {*other.socket_names, other.identifier}
    ]
    known = _known(script, owner, cls, _deciding(alike), node)
    hiding = {name: known[name] for socket in alike for name in _hiding(socket, known)}
    if not alike or not all(_is_hidden(socket, known) for socket in alike):
        return ""
    known |= _known(script, owner, cls, _deciding(script.api.sockets(cls, side)), node)
    shown = [other for other in script.api.sockets(cls, side) if not _is_hidden(other, known)]
    names = dict.fromkeys(repr(socket.label) for socket in shown if not socket.flagged(SHOWN_WHEN))
    instead = f": {', '.join(names)}" if names else ""
    return f"A `{cls}` shows no socket {key!r} while {_said(hiding)}, and finds only what it shows{instead}."


def index_beyond(script: Script, node: ast.Subscript) -> str:
    """What is wrong with an index of a node's sockets, where its settings leave fewer; empty if nothing surely is."""
    match node:
        case ast.Subscript(
            value=ast.Attribute(value=ast.Name() as owner, attr="inputs" | "outputs" as side),
            slice=ast.Constant(value=int(index)),
        ):
            cls = script.class_of(owner)
        case _:
            return ""
    sockets = [*script.api.sockets(cls, side)] if cls else []
    sometimes = [socket for socket in sockets if any(ways_of_showing(socket))]
    if not sometimes or index < 0 or not all(_is_there_while_shown(socket) for socket in sometimes):
        return ""
    known = _known(script, owner, cls, _deciding(sometimes), node)
    there = [socket for socket in sockets if not _is_hidden(socket, known)]
    if index < len(there) or index >= len(sockets):  # or no such node has so many
        return ""
    names = ", ".join(repr(socket.label) for socket in there)
    return f"A `{cls}` has no `{side}[{index}]` while {_said(known)}: its {side} are {names}."


def _is_there_while_shown(socket: Symbol) -> bool:
    """Whether a node has a socket only where it shows it: then its name always gives it."""
    return f'{socket.side}["{socket.label}"]' in socket.subscripts or (
        f'{socket.side}["{socket.identifier}"]' in socket.subscripts
    )


def _deciding(sockets: Iterable[Symbol]) -> set[str]:
    """The settings that show sockets."""
    modes = (mode for socket in sockets for way in ways_of_showing(socket) for mode in way)
    return {mode.partition("=")[0] for mode in modes}


def _known(
    script: Script, owner: ast.Name, cls: str, names: Iterable[str], before: ast.expr
) -> dict[str, str]:
    """Those settings of a node that are surely known before a place, with their values."""
    settings = {name: setting_of(script, owner, f"{cls}.{name}", before) for name in names}
    return {
        name: value
        for name, value in settings.items()
        if value is not None and not _is_of_some_trees(script, f"{cls}.{name}", value)
    }


def _is_of_some_trees(script: Script, setting: str, value: str) -> bool:
    """Whether only some trees have a value of a setting: what it shows with others besides was not tried."""
    symbol = script.api.symbols.symbol(setting)
    items = symbol.enum_items if symbol else ()
    return any(item.identifier == value and item.where and item.where.places for item in items)


def _said(settings: Mapping[str, str]) -> str:
    return " and ".join(f"`{name}` is {value!r}" for name, value in sorted(settings.items()))


def _is_found_while_shown(socket: Symbol, key: str) -> bool:
    """Whether a name or an identifier gives a socket only while its node shows it, or only then has it."""
    flag = "name-when-shown" if key in socket.socket_names else "identifier-when-shown"
    return flag in socket.flags or f'{socket.side}["{key}"]' in socket.subscripts


def _is_hidden(socket: Symbol, settings: Mapping[str, str]) -> bool:
    """Whether one of some settings surely hides a socket."""
    return bool(_hiding(socket, settings))


def _hiding(socket: Symbol, settings: Mapping[str, str]) -> list[str]:
    """The names of those of some settings that hide a socket, in all the ways in which it may be shown."""
    hiding: list[str] = []
    for modes in ways_of_showing(socket):
        against = [
            name
            for name, _, values in (mode.partition("=") for mode in modes)
            if name in settings and settings[name] not in values.split("|")
        ]
        if not against:
            return []
        hiding += against
    return hiding


def _class_of(script: Script, socket: Symbol, settings: Mapping[str, str]) -> str:
    """The class of a socket; empty where it is not known."""
    if not (names := socket.type_settings):
        kind = script.api.socket_type(socket)
        return kind.cls if isinstance(kind, Instance) else ""
    value = settings.get(names[0], "") if len(names) == 1 else ""
    setting = script.api.symbols.symbol(f"{socket.owner}.{names[0]}")
    if setting is None or (value == usual_default(setting) and _is_by_tree(setting)):
        return ""
    cls = f"{_SOCKET}{_CALLED.get(value, value.title())}"
    return cls if value and script.api.is_class(cls) else ""


def _is_by_tree(setting: Symbol) -> bool:
    """Whether the tree of a node has a say in a setting, so that a new node may begin with another value there."""
    return any(item.where is not None and item.where.places for item in setting.enum_items)
