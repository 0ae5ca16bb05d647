"""Sockets that a node has only if the script gives them to it: those of groups, zones, bundles and their like.

```python
tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
group_input = tree.nodes.new("NodeGroupInput")
group_input.outputs["Geometry"]  # tree.interface.new_socket("Geometry", in_out="INPUT", ...) comes first
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Instance, literal_texts
from kb_build.symbols.api_names import SIDES
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import called_operators
from kb_check.calls.sites import calls, calls_by_node
from kb_check.nodes.group_inputs import makes_all_groups
from kb_check.running.computing import CALLING, computing
from kb_check.running.out_of_sight import knows_all
from kb_check.running.raised import LACKS_KEY
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import is_new
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_NEW_SOCKET = f"{T}NodeTreeInterface.new_socket"
_OF_EDITORS = "bpy.ops.node."
# The two nodes of a group, with the side on which they have its sockets, and how the interface calls that.
_OF_GROUP = {f"{T}NodeGroupInput": ("outputs", "INPUT"), f"{T}NodeGroupOutput": ("inputs", "OUTPUT")}
# Nodes whose other sockets are called as items of theirs are.
_OF_ITEMS = frozenset(
    f"{T}{name}"
    for name in (
        "CompositorNodeOutputFile", "GeometryNodeBake", "GeometryNodeCaptureAttribute",
        "GeometryNodeForeachGeometryElementInput", "GeometryNodeForeachGeometryElementOutput",
        "GeometryNodeRepeatInput", "GeometryNodeRepeatOutput", "GeometryNodeSimulationInput",
        "GeometryNodeSimulationOutput", "NodeClosureInput", "NodeClosureOutput", "NodeCombineBundle",
        "NodeEvaluateClosure", "NodeSeparateBundle",
    )
)  # fmt: skip
_NUMBERED = re.compile(r"[._]\d+$")  # how the second of several with one name ends


def lacking_own(script: Script) -> Iterator[tuple[ast.Subscript, str, str]]:
    """Where a node is asked for a socket that nothing gives it: (place, class of the node, what would make it)."""
    if not knows_all(script) or computing(script) & CALLING or not _names_are_written(script):
        return
    if any(path.startswith(_OF_EDITORS) for path in called_operators(script)):
        return
    for node in script.all(ast.Subscript):
        key = node.slice.value if isinstance(node.slice, ast.Constant) else None
        asked = node.value
        if not isinstance(key, str) or not isinstance(asked, ast.Attribute) or asked.attr not in SIDES:
            continue
        owner = script.type_of(asked.value)
        if not isinstance(owner, Instance) or not owner.sure or script.analysis.resolutions.get(node):
            continue
        side, in_out = _OF_GROUP.get(owner.cls, ("", ""))
        is_known = (side == asked.attr and makes_all_groups(script)) or owner.cls in _OF_ITEMS
        if (
            not is_known
            or not is_new(script, asked.value)
            or is_tried(script, node, LACKS_KEY)
            or _is_asked(script, key)
        ):
            continue
        given = _other_texts(script) | (_made_sockets(script, in_out) if in_out else _all_made(script))
        if key not in given and _NUMBERED.sub("", key) not in given:
            how = f"`tree.interface.new_socket({key!r}, in_out={in_out!r}, socket_type=…)`" if in_out else ""
            yield node, owner.cls, how


def _is_asked(script: Script, key: str) -> bool:
    """Whether the script asks if something has a name."""
    return any(
        isinstance(node.left, ast.Constant) and node.left.value == key for node in script.all(ast.Compare)
    )


@once_per_script
def _names_are_written(script: Script) -> bool:
    """Whether all names that the script gives to sockets and items are texts that stand in it."""
    known = calls_by_node(script)
    for node in script.all(ast.Call):
        if isinstance(node.func, ast.Attribute) and node.func.attr in {"new", "new_socket", "copy"}:
            call = known.get(node)
            if call is None or call.has_unpacking or (_makes_sockets(call) and not _is_written(script, call)):
                return False
    stores = {target: node.value for node in script.all(ast.Assign) for target in node.targets}
    named = [node for node in attributes(script).get("name", ()) if isinstance(node.ctx, ast.Store)]
    return all(isinstance(stores.get(node), ast.Constant) for node in named)


def _makes_sockets(call: CallSite) -> bool:
    names = {parameter.name for parameter in call.callee.parameters}
    return "name" in names and not names.isdisjoint({"socket_type", "in_out"})


def _is_written(script: Script, call: CallSite) -> bool:
    given = call.argument("name")
    texts = list(literal_texts(script.type_of(given) or UNKNOWN)) if given else []
    return bool(texts) and all(texts)  # an empty one becomes the name of the type


@once_per_script
def _sides_of_sockets(script: Script) -> dict[ast.Constant, str]:
    """The names that are written out where sockets of a group are made → the side that is written out there."""
    found: dict[ast.Constant, str] = {}
    for call in calls(script):
        if call.callee.symbol.path != _NEW_SOCKET:
            continue
        name, side = call.argument("name"), call.argument("in_out")
        if isinstance(name, ast.Constant) and (side is None or isinstance(side, ast.Constant)):
            found[name] = "INPUT" if side is None else str(side.value)
    return found


def _made_sockets(script: Script, in_out: str) -> frozenset[object]:
    return frozenset(name.value for name, side in _sides_of_sockets(script).items() if side == in_out)


def _all_made(script: Script) -> frozenset[object]:
    return frozenset(name.value for name in _sides_of_sockets(script))


@once_per_script
def _other_texts(script: Script) -> frozenset[object]:
    """The texts of a script but for those that it asks sockets by, and the names of sockets with a known side."""
    keys = {
        node.slice
        for node in script.all(ast.Subscript)
        if isinstance(node.value, ast.Attribute) and node.value.attr in SIDES
    }
    apart = keys | set(_sides_of_sockets(script))
    return frozenset(node.value for node in script.all(ast.Constant) if node not in apart)
