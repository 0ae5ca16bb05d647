"""A link between two sockets of which one cannot become the other.

Blender makes it without an error, draws it red, and passes nothing on: the input keeps its own value.

```python
links.new(emission.outputs["Emission"], mix.inputs["Factor"])  # reported: a shader is no number
links.new(cube.outputs["Mesh"], math.inputs[0])  # reported: a geometry is no number
links.new(
    value.outputs[0], principled.inputs["Base Color"]
)  # numbers, vectors and colours become one another
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.nodes.socket_kinds import can_be_joined, kind_of
from kb_check.rule import Rule
from kb_check.scene.made_here import LINKS_NEW

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# Whose sockets become what they are linked to, or are others in another kind of tree.
_ADAPTING = frozenset(
    f"{T}{name}" for name in ("NodeReroute", "GeometryNodeRepeatInput", "GeometryNodeRepeatOutput")
)
# Whose names of attributes take the numbers that stand for them.
_TAKING_TEXTS = f"{T}ShaderNodeVolumePrincipled"
_NOTHING = "", ast.Name("")


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script):
        if call.callee.symbol.path != LINKS_NEW or call.has_unpacking or len(call.node.args) != 2:
            continue
        ends = {side: (kind, node) for node in call.node.args for side, kind in [_end(script, node)]}
        (source, giving), (target, taking) = ends.get("outputs", _NOTHING), ends.get("inputs", _NOTHING)
        if source and target and not can_be_joined(source, target):
            yield Finding(
                RULE.id, "warning", script.span(call.node),
                f"`{script.text(script.span(giving))}` gives a {source.lower()}, and "
                f"`{script.text(script.span(taking))}` takes a {target.lower()}: Blender makes the link, and nothing "
                "comes through.",
                LINKS_NEW,
            )  # fmt: skip


def _end(script: Script, node: ast.expr) -> tuple[str, str]:
    """(side of its node, what it carries) of a socket that is asked of a node, where both are sure."""
    if not isinstance(node, ast.Subscript) or not isinstance(node.value, ast.Attribute):
        return "", ""
    owner, kind = script.class_of(node.value.value), kind_of(script.class_of(node))
    is_open = owner in _ADAPTING or (owner == _TAKING_TEXTS and kind == "String")
    return ("", "") if is_open else (node.value.attr, kind)


RULE = Rule("invalid-link", "warning", "A link between sockets of which one cannot become the other", _check)
