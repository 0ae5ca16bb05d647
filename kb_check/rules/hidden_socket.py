"""A socket that a node does not show as the script has set it, asked for by name or identifier.

Blender finds sockets by these only while the node shows them.

```python
points = tree.nodes.new("GeometryNodeDistributePointsOnFaces")
points.inputs["Density Max"]  # reported: distribute_method must be 'POISSON'
points.distribute_method = "POISSON"
points.inputs["Density"]  # reported: it shows "Density Max" now
zone = tree.nodes.new("GeometryNodeSimulationInput")
zone.inputs["Geometry"]  # reported: zone.pair_with_output(…) comes first
```

So is what a node never shows, as the `Weight` of shaders, which renderers use.

By index it finds the others as well. A link to one of them has no effect, and is a warning:

```python
mix = tree.nodes.new("ShaderNodeMix")
mix.data_type = "RGBA"
tree.links.new(mix.outputs[0], emission.inputs[0])  # a warning: mix.outputs[2] is the one of colours
```

A pass that no new view layer has is a warning, where the script nowhere names the setting that turns it on:

```python
layers = tree.nodes.new("CompositorNodeRLayers")
layers.outputs["Depth"]  # a warning: view_layer.use_pass_z = True comes first
```

Not reported: nodes that the script did not make itself, settings that the script may give in a way that is not plain to
see, and scripts that compute names or import modules which may change scenes.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import HIDDEN
from kb_build.symbols.lines import shown_when
from kb_check.findings import Finding
from kb_check.nodes.hidden_links import hidden_link
from kb_check.nodes.shown_sockets import hidden_by_settings, index_beyond
from kb_check.nodes.socket_modes import deciding, is_by_others, is_internal
from kb_check.nodes.zone_pairing import unpaired
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import is_new
from kb_check.script import once_per_script
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

# The settings of a view layer, and of what belongs to it, in what shows a socket.
_PASS = re.compile(r"view_layer(?:\.\w+)*\.(\w+)=")


def _check(script: Script) -> Iterator[Finding]:
    yield from _never_shown(script)
    if not knows_all(script):
        return
    yield from _beyond(script)
    for row in script.resolutions("item"):
        node = row.node
        certain = bool(row.symbols) and row.sure and not row.guarded and not row.missing
        if not certain or not isinstance(node, ast.Subscript) or not isinstance(node.value, ast.Attribute):
            continue
        sockets = [symbol for path in row.symbols if (symbol := script.api.symbols.symbol(path))]
        if row.value in _asked(script):
            continue
        owner = node.value.value
        if any(map(is_by_others, sockets)):
            if (message := _off(script, sockets, row)) and is_new(script, owner):
                yield Finding(RULE.id, "warning", script.span(node), message, sockets[0].path)
            continue
        message = (
            unpaired(script, sockets, node)
            or _hidden(script, sockets, row)
            or hidden_by_settings(script, sockets, node)
        )
        if message and is_new(script, owner):
            yield Finding(RULE.id, "error", script.span(node), message, sockets[0].path)
        elif len(sockets) == 1 and (message := hidden_link(script, sockets[0], node, owner)):
            yield Finding(RULE.id, "warning", script.span(node), message, sockets[0].path)


def _beyond(script: Script) -> Iterator[Finding]:
    """Indices of sockets that nodes do not have as the script has set them."""
    for node in script.all(ast.Subscript):
        if (message := index_beyond(script, node)) and not is_tried(script, node):
            path = f"{script.class_of(node.value.value)}" if isinstance(node.value, ast.Attribute) else ""
            yield Finding(RULE.id, "error", script.span(node), message, path)


def _never_shown(script: Script) -> Iterator[Finding]:
    """Sockets that their nodes show in no mode, asked for by name or identifier."""
    for row in script.resolutions("item"):
        sockets = [symbol for path in row.symbols if (symbol := script.api.symbols.symbol(path))]
        certain = bool(sockets) and row.sure and not row.guarded and not row.missing
        if (
            certain
            and row.value not in _asked(script)
            and all(
                row.value in {*one.socket_names, one.identifier} and is_internal(script.api, one, row.value)
                for one in sockets
            )
        ):
            yield Finding(
                RULE.id, "error", script.span(row.node),
                f"A `{sockets[0].owner}` never shows its socket {row.value!r}, and finds only what it shows.",
                sockets[0].path,
            )  # fmt: skip


@once_per_script
def _asked(script: Script) -> frozenset[str]:
    """The texts of which the script asks whether something has them."""
    return frozenset(
        node.left.value
        for node in script.all(ast.Compare)
        if isinstance(node.left, ast.Constant)
        and isinstance(node.left.value, str)
        and isinstance(node.ops[0], (ast.In, ast.NotIn))
    )


def _hidden(script: Script, sockets: list[Symbol], row: Resolution) -> str:
    """What is wrong with asking for sockets of one name, none of which a new node shows; empty if nothing surely is."""
    if not deciding(script, sockets).isdisjoint(named_words(script)):
        return ""
    for socket in sockets:
        side = socket.side
        is_name = row.value in socket.socket_names
        needed = {"hidden-by-default", "name-when-shown" if is_name else "identifier-when-shown"}
        if (
            not (is_name or row.value == socket.identifier)
            or f'{side}["{row.value}"]' in socket.subscripts
            or not shown_when(socket)
            or not needed.issubset(socket.flags)
        ):
            return ""
    first = sockets[0]
    return (
        f"A new `{first.owner}` shows no socket {row.value!r}, and finds only what it shows: it is there "
        f"with {shown_when(first)}."
    )


def _off(script: Script, sockets: list[Symbol], row: Resolution) -> str:
    """What is wrong with asking for a pass that no new view layer has, and that the script does not turn on."""
    settings = {word for socket in sockets for word in _PASS.findall(shown_when(socket))}
    is_off = bool(settings) and all(HIDDEN in socket.flags for socket in sockets)
    if not is_off or not settings.isdisjoint(named_words(script)):
        return ""
    return (
        f"A new view layer does not have the pass {row.value!r}, and `{sockets[0].owner}` finds only what it shows: "
        f"it is there with {shown_when(sockets[0])}."
    )


RULE = Rule("hidden-socket", "error", "A socket that the node's mode does not have", _check)
