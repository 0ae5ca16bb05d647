"""A node or a socket type that does not exist, given by its name, or a node that its tree does not take.

Looked at where a literal is given to ``nodes.new`` or to ``interface.new_socket``. A name that only an add-on's node
could have is left alone, as is a former one that this Blender still takes: reported is what another Blender had, and
what begins as Blender's own nodes do.

```python
nodes.new("ShaderNodeTexMusgrave")  # reported since 4.1: ShaderNodeTexNoise
nodes.new("ShaderNodeTexNoise")
tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
tree.nodes.new("ShaderNodeBsdfPrincipled")  # reported: geometry node trees take none
tree.nodes.new("GeometryNode")  # reported: the class that the others derive from
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.facts import T
from kb_build.flow.types import Collection, Instance
from kb_build.records import last_name
from kb_build.symbol_lines import NODE_FAMILIES, alike_nodes
from kb_check.calls import CallSite, calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.script import once_for_each

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.known_names import Lacking
    from kb_check.script import Script

_TAKERS = {f"{T}Nodes.new": "type", f"{T}NodeTreeInterface.new_socket": "socket_type"}
_BLENDERS_OWN = re.compile(rf"({'|'.join(NODE_FAMILIES)}|NodeSocket)[A-Z]\w+")
_NODE, _TREE = f"{T}Node", f"{T}NodeTree"


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        wanted = _TAKERS.get(call.callee.symbol.path)
        for parameter, node in call.arguments() if wanted else ():
            if (
                parameter.name != wanted
                or not isinstance(node, ast.Constant)
                or not isinstance(node.value, str)
            ):
                continue
            name = node.value
            if name in script.own_identifiers:
                continue
            if script.api.is_class(f"{T}{name}"):
                yield from _refused(script, call, node, name)
                continue
            if script.package.has(("bpy.types",), name) or script.names.still_works(f"{T}{name}"):
                continue
            if script.names.was("bpy.types", name) or _BLENDERS_OWN.fullmatch(name):
                lacking = _lacking(script, name)
                yield Finding(
                    RULE.id, "error", script.span(node), lacking.message, lacking.symbol,
                    tuple(path for path in lacking.instead if script.api.is_class(path)),
                )  # fmt: skip


@once_for_each
def _lacking(script: Script, name: str) -> Lacking:
    return script.names.member("bpy.types", name)


def _refused(script: Script, call: CallSite, node: ast.expr, name: str) -> Iterator[Finding]:
    """A class of nodes that no tree takes, or not the one that it is given to."""
    symbol = script.api.symbols.symbol(f"{T}{name}")
    if symbol is None or not script.api.descends(symbol.path, _NODE):
        return
    tree = _tree(script, call)
    if not symbol.trees:
        said = f"`{symbol.path}` is a class of nodes that no tree takes: `nodes.new` refuses it"
    elif tree and tree not in symbol.trees:
        said = f"`{symbol.path}` is a node of {' and '.join(symbol.trees)}: a `{tree}` refuses it"
    else:
        return
    others = _others(script, name, tree) if tree else ()
    instead = f" Use {' or '.join(f'`{other}`' for other in others)}." if others else ""
    yield Finding(RULE.id, "error", script.span(node), f"{said}.{instead}", symbol.path, others)


def _tree(script: Script, call: CallSite) -> str:
    """The type of the tree whose nodes are added to; empty where that is not sure."""
    nodes = script.type_of(call.node.func.value) if isinstance(call.node.func, ast.Attribute) else None
    tree = nodes.owner if isinstance(nodes, Collection) else None
    if not isinstance(tree, Instance) or not tree.sure or tree.cls == _TREE:
        return ""
    return last_name(tree.cls) if script.api.descends(tree.cls, _TREE) else ""


def _others(script: Script, name: str, tree: str) -> tuple[str, ...]:
    """The nodes of a tree that are called as another tree's: ``ShaderNodeMath`` for ``CompositorNodeMath``."""
    symbols = map(script.api.symbols.symbol, alike_nodes(name))
    return tuple(symbol.path for symbol in symbols if symbol and tree in symbol.trees)


RULE = Rule("unknown-node", "error", "A node or socket type that does not exist, or not in that tree", _check)
