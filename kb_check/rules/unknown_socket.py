"""A socket that a node does not have, or does not find by what it is asked for.

Sockets are asked for by the name that the node shows, or by identifier; a few nodes take names only. What the running
Blender still takes by a former name is not a finding, nor is a `get` whose None the script is ready for.

```python
principled = nodes.new("ShaderNodeBsdfPrincipled")
principled.inputs["Specular"]  # reported since 4.0: Specular IOR Level
principled.inputs.get("Specular") or principled.inputs.get("Specular IOR Level")  # of any Blender
mix = nodes.new("ShaderNodeMix")
mix.inputs["A_Color"]  # reported: an identifier; mix.inputs["A"] while colours are mixed, or mix.inputs[6]
```

So are sockets of groups, zones and bundles that nothing in the script makes:

```python
group_input = tree.nodes.new("NodeGroupInput")
group_input.outputs["Geometry"]  # reported unless tree.interface.new_socket("Geometry", ...) stands somewhere
```

So are the inputs of a group that the script makes, where its modifier is asked for them by identifiers of before 4.0:

```python
modifier = ob.modifiers.new("Scatter", "NODES")
modifier.node_group = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
modifier["Input_2"] = 10.0  # a warning: Socket_2, or what `item.identifier` says
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance, Resolution
from kb_build.symbols.api_names import SIDES
from kb_build.symbols.flag_names import NEVER_BY_IDENTIFIER, WHEN_PAIRED
from kb_build.symbols.lines import subscripts_text
from kb_check.findings import Finding
from kb_check.names.lacking import lacking_finding
from kb_check.nodes.group_inputs import input_now
from kb_check.nodes.own_sockets import lacking_own
from kb_check.nodes.socket_modes import is_internal
from kb_check.rule import Rule
from kb_check.running.asked_for_none import is_ready_for_none
from kb_check.running.raised import LACKS_KEY
from kb_serve.recognise.chains.subscripts import NODES_MODIFIER

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("item"):
        if any(_still_works(script, node, row.value) for node in row.missing) or is_ready_for_none(
            script, row.node
        ):
            continue
        node = row.missing[0]
        sides = _sides(row)
        sockets = (socket for side in sides for socket in script.api.sockets(node, side))
        names = [_asked_by(socket) for socket in sockets if not is_internal(script.api, socket)]
        lacking = script.names.socket(node, row.value, dict.fromkeys(names), sides)
        yield lacking_finding(script, RULE.id, row, lacking)
    for row in script.resolutions("item"):
        sockets = [symbol for path in row.symbols if (symbol := script.api.symbols.symbol(path))]
        certain = sockets and row.sure and not row.is_ready_for(*LACKS_KEY) and not row.missing
        if certain and all(_is_only_identifier(socket, row.value) for socket in sockets):
            first = sockets[0]
            yield Finding(
                RULE.id, "error", script.span(row.node),
                f"`{first.owner}` finds its sockets by the names that it shows, not by identifiers as {row.value!r}: "
                f"{subscripts_text(first)}.", first.path,
            )  # fmt: skip
    for node, cls, how in lacking_own(script):
        key = str(node.slice.value) if isinstance(node.slice, ast.Constant) else ""
        if misspelt := _misspelt(script, node, cls, key):
            yield misspelt
            continue
        comes = f": {how} comes before" if how else ", as the `new` of its items would"
        told = f"Nothing in this script gives this `{cls}` a socket {key!r}{comes}."
        yield Finding(RULE.id, "error", script.span(node), told, cls)
    yield from _former_inputs(script)


def _misspelt(script: Script, node: ast.Subscript, cls: str, key: str) -> Finding | None:
    """A key that is nearly that of a socket which a node has anyway; None for others."""
    side = node.value.attr if isinstance(node.value, ast.Attribute) else ""
    sockets = (socket for socket in script.api.sockets(cls, side) if not is_internal(script.api, socket))
    names = [_asked_by(socket) for socket in sockets if WHEN_PAIRED not in socket.flags]
    lacking = script.names.socket(cls, key, dict.fromkeys(names))
    row = Resolution(node, "item", missing=(cls,), value=key)
    return lacking_finding(script, RULE.id, row, lacking) if lacking.replacement else None


def _former_inputs(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Subscript):
        kind = script.type_of(node.value)
        is_modifier = isinstance(kind, Instance) and kind.sure and kind.cls == NODES_MODIFIER
        if is_modifier and (now := input_now(script, node, node.value)):
            key = ast.unparse(node.slice)
            yield Finding(
                RULE.id, "warning", script.span(node.slice),
                f"No input of a group that this Blender makes is called {key}: since 4.0 they are called as {now!r}, "
                "and `item.identifier` of `node_group.interface.items_tree` says how.",
                NODES_MODIFIER,
            )  # fmt: skip


def _sides(row: Resolution) -> tuple[str, ...]:
    """The side of a node that is asked; both where that is not to be seen."""
    asked = row.node.value if isinstance(row.node, ast.Subscript) else None
    return (asked.attr,) if isinstance(asked, ast.Attribute) and asked.attr in SIDES else SIDES


def _asked_by(socket: Symbol) -> str:
    """What a socket is asked for by."""
    return socket.label if NEVER_BY_IDENTIFIER in socket.flags else socket.name


def _is_only_identifier(socket: Symbol, key: str) -> bool:
    return NEVER_BY_IDENTIFIER in socket.flags and key == socket.identifier and key not in socket.socket_names


def _still_works(script: Script, node: str, name: str) -> bool:
    return any(script.names.still_works(f'{node}.{side}["{name}"]') for side in SIDES)


RULE = Rule("unknown-socket", "error", "A socket that the node does not have", _check)
