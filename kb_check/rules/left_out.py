"""An object of a type that a pointer does not take: Blender leaves most of them out without an error.

```python
boolean = ob.modifiers.new("Cut", "BOOLEAN")
boolean.object = bpy.data.objects.new("Cutter", None)  # reported: stays None, as it takes meshes alone
curve = ob.modifiers.new("Curve", "CURVE")
curve.object = camera_object  # reported
ob.parent = ob  # reported: refused with an error
group.node_tree = tree  # reported where the node is in that tree itself
```

Not reported: objects of which the script does not tell what data they have.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import Instance
from kb_build.symbols.accepted import ITSELF, TAKES, accepted, accepted_text, noun
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA, data_class
from kb_check.findings import Finding
from kb_check.given import assigned
from kb_check.made_here import callee_path, once_bound
from kb_check.raised import REFUSES
from kb_check.rule import Rule
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_NEW_OBJECT = f"{T}BlendDataObjects.new"
_EMPTY = "EMPTY"
_HOLDERS = frozenset({"constraints", "grease_pencil_modifiers", "modifiers", "nodes", "shader_effects"})


def _check(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("store"):
        symbol = script.api.symbols.symbol(row.symbols[0]) if len(row.symbols) == 1 else None
        kinds = accepted(symbol) if symbol else {}
        is_certain = row.sure and not row.missing and not row.possible and not row.is_ready_for(*REFUSES)
        if not symbol or not kinds or not is_certain or not isinstance(row.node, ast.Attribute):
            continue
        value = assigned(row.statement, row.node)
        if value is None or is_tried(script, row.node):
            continue
        if kinds.get(ITSELF, TAKES) != TAKES and _is_itself(script, row.node.value, value):
            told = f"`{symbol.path}` does not take the {noun(symbol)} that it belongs to."
        elif (given := _types(script, value)) and all(kinds.get(kind, TAKES) != TAKES for kind in given):
            told = f"`{symbol.path}` {accepted_text(symbol)}. This one's type is {' or '.join(given)}."
        else:
            continue
        yield Finding(RULE.id, "error", script.span(value), told, symbol.path)


def _types(script: Script, node: ast.expr) -> list[str]:
    """The types that an object may have, by its data; none where that is not sure."""
    kind = script.type_of(node)
    if not isinstance(kind, Instance) or kind.cls != OBJECT or not kind.sure:
        return []
    made = once_bound(script, node)
    if isinstance(made, ast.Call) and callee_path(script, made) == _NEW_OBJECT:
        match [*made.args[1:2], *(one.value for one in made.keywords if one.arg == "object_data")]:
            case [ast.Constant(value=None)]:
                return [_EMPTY]
            case _:
                pass
    data = kind.trait("data")
    if not isinstance(data, Instance) or not data.sure:
        return []
    classes = {each: T + data_class(each, lambda name: script.api.is_class(T + name)) for each in OBJECT_DATA}
    # A value that is declared as a Curve may be a TextCurve; one that is a SpotLight is a Light.
    narrower = [each for each, cls in classes.items() if script.api.descends(cls, data.cls)]
    return narrower or [each for each, cls in classes.items() if script.api.descends(data.cls, cls)][-1:]


def _is_itself(script: Script, owner: ast.expr, value: ast.expr) -> bool:
    """Whether a value is what the owner of a pointer is, or belongs to: a modifier to an object, a node to a tree."""
    text = ast.unparse(value)
    match once_bound(script, owner):
        case ast.Call(func=ast.Attribute(value=ast.Attribute(value=holder, attr=attr), attr="new")):
            is_its = attr in _HOLDERS and ast.unparse(holder) == text
        case _:
            is_its = False
    is_one = isinstance(value, ast.Name) and once_bound(script, value) is not value
    return is_one and (is_its or ast.unparse(owner) == text)


RULE = Rule("left-out", "error", "A thing that a pointer leaves out", _check)
