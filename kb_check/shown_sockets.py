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

from kb_build.flow.types import Instance
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flags import usual_default
from kb_check.node_settings import setting_of
from kb_check.socket_modes import showing

if TYPE_CHECKING:
    from collections.abc import Mapping

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
    deciding = {name for socket in sockets for name in (*showing(socket), *socket.type_settings)}
    cls = sockets[0].owner
    settings = {name: setting_of(script, owner, f"{cls}.{name}", node) for name in deciding}
    known = {name: value for name, value in settings.items() if value is not None}
    found = [_class_of(script, socket, known) for socket in sockets if not _is_hidden(socket, known)]
    so = " and ".join(f"`{name}` is {value!r}" for name, value in sorted(known.items()))
    return Shown(tuple(dict.fromkeys(found)), f" while {so}" if so else "") if found and all(found) else None


def _is_hidden(socket: Symbol, settings: Mapping[str, str]) -> bool:
    """Whether one of some settings surely hides a socket."""
    modes = (mode.partition("=") for mode in socket.modes)
    return any(name in settings and settings[name] not in values.split("|") for name, _, values in modes)


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
