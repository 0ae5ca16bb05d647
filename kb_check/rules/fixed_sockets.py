"""Sockets that are added to a node of Blender's own, or taken from it: it has those of its kind.

```python
node = nodes.new("ShaderNodeRGB")
node.outputs.new("NodeSocketColor", "Tint")  # reported: RuntimeError
group = nodes.new("ShaderNodeGroup")
group.inputs.new("NodeSocketFloat", "Size")  # reported: group.node_tree.interface.new_socket makes it
```

A script node (``ShaderNodeScript``) and the nodes that an add-on defines take them. Not reported: nodes whose kind is
not known, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import NODE, SIDES
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_CHANGING = frozenset(
    f"{T}Node{side}.{name}" for side in ("Inputs", "Outputs") for name in ("clear", "move", "new", "remove")
)
_TAKING = f"{T}ShaderNodeScript"
_OF_GROUPS = re.compile(r"bpy\.types\.(\w+NodeGroup|NodeGroup(In|Out)put)")
_INTERFACE = f"{T}NodeTreeInterface.new_socket"


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        if call.callee.symbol.path not in _CHANGING:
            continue
        match call.node.func:
            case ast.Attribute(value=ast.Attribute(value=node, attr=side)) if side in SIDES:
                cls = script.class_of(node)
            case _:
                continue
        if _is_kind_of_node(script, cls) and not is_tried(script, call.node):
            yield Finding(
                RULE.id, "error", script.span(call.node), _told(script, cls), call.callee.symbol.path
            )


def _is_kind_of_node(script: Script, cls: str) -> bool:
    """Whether a class is a built-in kind of node, and not what kinds derive from."""
    is_node = bool(cls) and cls != _TAKING and script.api.descends(cls, NODE)
    return is_node and "Custom" not in cls and not script.api.descendants(cls)


def _told(script: Script, cls: str) -> str:
    told = f"`{cls}` is built in, and has the sockets of its kind: RuntimeError."
    if not _OF_GROUPS.match(cls):
        return told
    if script.api.symbols.symbol(_INTERFACE):
        return f"{told} Those of a group are its tree's: `node_tree.interface.new_socket(…)`."
    return f"{told} Those of a group are its tree's: `node_tree.inputs.new(…)`, `node_tree.outputs.new(…)`."


RULE = Rule("fixed-sockets", "error", "A socket that is added to a built-in node, or taken from it", _check)
