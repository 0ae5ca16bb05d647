"""A node or a socket type that does not exist, given by its name.

Looked at where a literal is given to ``nodes.new`` or to ``interface.new_socket``. A name that only an add-on's node
could have is left alone: reported is what another Blender had, and what begins as Blender's own nodes do.

```python
nodes.new("ShaderNodeTexMusgrave")  # reported since 4.1: ShaderNodeTexNoise
nodes.new("ShaderNodeTexNoise")
```
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.facts import T
from kb_check.calls import calls
from kb_check.findings import Finding
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_TAKERS = {f"{T}Nodes.new": "type", f"{T}NodeTreeInterface.new_socket": "socket_type"}
_BLENDERS_OWN = re.compile(
    r"(ShaderNode|GeometryNode|CompositorNode|FunctionNode|TextureNode|NodeSocket)[A-Z]\w+"
)


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
            if script.api.is_class(f"{T}{name}") or name in script.own_identifiers:
                continue
            if script.package.has(("bpy.types",), name):
                continue
            if script.names.was("bpy.types", name) or _BLENDERS_OWN.fullmatch(name):
                lacking = script.names.member("bpy.types", name)
                yield Finding(
                    RULE.id, "error", script.span(node), lacking.message, lacking.symbol,
                    tuple(path for path in lacking.instead if script.api.is_class(path)),
                )  # fmt: skip


RULE = Rule("unknown-node", "error", "A node or socket type that does not exist", _check)
