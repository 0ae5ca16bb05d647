"""A render pass by the name that it had before Blender 5.0.

The outputs of a Render Layers node are called as the passes are, which have their names in full now.

```python
layers = tree.nodes.new("CompositorNodeRLayers")
layers.outputs["DiffCol"]  # reported: layers.outputs["Diffuse Color"]
```

Not reported: a name that the script gives to something of its own, as to a pass of a shader (AOV).
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance
from kb_check.findings import Finding, Fix
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_NODE = "bpy.types.CompositorNodeRLayers"
_OUTPUTS = "bpy.types.Node.outputs"


def _check(script: Script) -> Iterator[Finding]:
    if "RLayers" not in script.code:
        return
    for node in script.all(ast.Subscript, ast.Call):
        match node:
            case ast.Subscript(value=owner, slice=ast.Constant(value=str(name)) as key):
                pass
            case ast.Call(
                func=ast.Attribute(value=owner, attr="get"), args=[ast.Constant(value=str(name)) as key, *_]
            ):
                pass
            case _:
                continue
        if not _is_of_layers(script, owner):
            continue
        now, since = _name_now(script, name)
        if not now or name in _own(script) or is_tried(script, node):
            continue
        edit = script.renamed(key, now)
        yield Finding(
            RULE.id, "error" if isinstance(node, ast.Subscript) else "warning", script.span(key),
            f"`{_NODE}` has no output {name!r} since Blender {since}: the pass is called {now!r}.", _NODE, (),
            Fix(f"Write {now}", (edit,), sure=True) if edit else None,
        )  # fmt: skip


def _name_now(script: Script, name: str) -> tuple[str, str]:
    """The name of a pass that was called so, and since when: the output has that of the setting that turns it on."""
    for row in script.names.reader.history.successors(f'{_NODE}.outputs["{name}"]'):
        if setting := script.api.symbols.symbol(row.target):
            return setting.label, row.version
    return "", ""


def _is_of_layers(script: Script, node: ast.expr) -> bool:
    kind = script.type_of(node)
    owner = kind.owner if isinstance(kind, Collection) and kind.path == _OUTPUTS else None
    return isinstance(owner, Instance) and owner.sure and owner.cls == _NODE


@once_per_script
def _own(script: Script) -> frozenset[str]:
    """The texts that the script gives to something: names of passes that it makes itself are among them."""
    given = [node.value for node in script.all(ast.Assign)]
    given += [keyword.value for keyword in script.all(ast.keyword)]
    return frozenset(
        node.value for node in given if isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


RULE = Rule("former-pass", "error", "A render pass by its name before 5.0", _check)
