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

from kb_build.flow.types import Collection, Instance
from kb_check.findings import Finding, Fix
from kb_check.rule import Rule
from kb_check.script import once_per_script
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_SINCE = 5, 0
_NODE = "bpy.types.CompositorNodeRLayers"
_OUTPUTS = "bpy.types.Node.outputs"
NAMES = {
    "AO": "Ambient Occlusion", "DiffCol": "Diffuse Color", "DiffDir": "Diffuse Direct", "DiffInd": "Diffuse Indirect",
    "Emit": "Emission", "Env": "Environment", "GlossCol": "Glossy Color", "GlossDir": "Glossy Direct",
    "GlossInd": "Glossy Indirect", "IndexMA": "Material Index", "IndexOB": "Object Index",
    "TransCol": "Transmission Color", "TransDir": "Transmission Direct", "TransInd": "Transmission Indirect",
    "VolumeDir": "Volume Direct", "VolumeInd": "Volume Indirect",
}  # fmt: skip


def _check(script: Script) -> Iterator[Finding]:
    if script.version < _SINCE or "RLayers" not in script.code:
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
        if (
            name not in NAMES
            or not _is_of_layers(script, owner)
            or name in _own(script)
            or is_tried(script, node)
        ):
            continue
        edit = script.renamed(key, NAMES[name])
        yield Finding(
            RULE.id, "error" if isinstance(node, ast.Subscript) else "warning", script.span(key),
            f"`{_NODE}` has no output {name!r} since Blender 5.0: the pass is called {NAMES[name]!r}.", _NODE, (),
            Fix(f"Write {NAMES[name]}", (edit,), sure=True) if edit else None,
        )  # fmt: skip


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
