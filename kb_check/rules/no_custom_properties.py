"""Custom properties of what takes none.

Brackets, `in` and functions such as `get` and `keys` mean custom properties. An operator has none, and the preferences
of an add-on have none since Blender 5.0: each property is an attribute. Blender refuses the rest with a TypeError.

```python
class Count(bpy.types.Operator):
    bl_idname, bl_label = "object.count", "Count"
    number: bpy.props.IntProperty()

    def execute(self, context):
        self["number"] = 3  # reported: self.number = 3
        return {"FINISHED"}


bpy.context.preferences.addons["cycles"].preferences.keys()  # reported
```

Not reported: what a class of the script answers itself, by a `__getitem__` or a `keys` of its own.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.types import UNKNOWN, Instance, LocalInstance, members
from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Finding, Fix
from kb_check.own_classes import own_classes
from kb_check.rule import Rule
from kb_check.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.own_classes import OwnClass
    from kb_check.script import Script

_SINCE = 5, 0
_PREFERENCES = f"{T}AddonPreferences"
# Whose instances refuse all custom properties, as tried.
_CLASSES = (f"{T}Operator", f"{T}Macro", _PREFERENCES)
_METHODS = frozenset({"get", "items", "keys", "pop", "values"})
_OF_BRACKETS = frozenset({"__getitem__", "__setitem__", "__delitem__", "__contains__"})


def _check(script: Script) -> Iterator[Finding]:
    is_there = any(own.path in _CLASSES for own in own_classes(script))
    if script.version < _SINCE or not (is_there or "preferences" in script.code or "operator" in script.code):
        return
    for node in script.all(ast.Subscript, ast.Compare, ast.Call):
        for owner, names in _asked(node):
            found = _class_of(script, owner, names)
            if found and not is_tried(script, node):
                cls, own = found
                since = " since Blender 5.0" if cls == _PREFERENCES else ""
                key = (
                    node.slice.value
                    if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Constant)
                    else None
                )
                name = key if isinstance(key, str) and key.isidentifier() else ""
                advice = f"write `{ast.unparse(owner)}.{name}`" if name else "its properties are attributes"
                yield Finding(
                    RULE.id, "error", script.span(node),
                    f"An instance of `{cls}` takes no custom properties{since}: {advice}.", cls, (),
                    _fix(script, node, name) if own and _declares(own, name) else None,
                )  # fmt: skip


def _asked(node: ast.Subscript | ast.Compare | ast.Call) -> Iterator[tuple[ast.expr, frozenset[str]]]:
    """What a node asks for custom properties, if it does, and the functions by which a class may answer itself."""
    match node:
        case ast.Subscript():
            yield node.value, _OF_BRACKETS
        case ast.Compare(ops=operators):
            for operator, right in zip(operators, node.comparators, strict=True):
                if isinstance(operator, (ast.In, ast.NotIn)):
                    yield right, _OF_BRACKETS
        case ast.Call(func=ast.Attribute(value=owner, attr=name)) if name in _METHODS:
            yield owner, frozenset({name})
        case _:
            pass


def _class_of(script: Script, node: ast.expr, names: frozenset[str]) -> tuple[str, OwnClass | None] | None:
    """The class without custom properties that a value surely is of, and the script's own one below it."""
    kinds = members(script.type_of(node) or UNKNOWN)
    if len(kinds) != 1:
        return None
    row = script.analysis.resolutions.get(node)
    if row is not None and (row.guarded or not row.sure):
        return None
    match kinds[0]:
        case Instance(cls=cls, sure=True):
            base = next((one for one in _CLASSES if script.api.descends(cls, one)), "")
            answers = any(
                one.path == base and not all(map(one.lacks, names))
                for one in (own_classes(script) if base else ())
            )
            return (base, None) if base and not answers else None
        case LocalInstance(number=number):
            definition = script.analysis.classes[number]
            own = next((one for one in own_classes(script) if one.node is definition), None)
            return (own.path, own) if own and own.path in _CLASSES and all(map(own.lacks, names)) else None
        case _:
            return None


def _declares(own: OwnClass, name: str) -> bool:
    """Whether a class has an annotation of a name: a property, as a rule."""
    return any(
        isinstance(statement, ast.AnnAssign)
        and isinstance(statement.target, ast.Name)
        and statement.target.id == name
        for statement in own.node.body
    )


def _fix(script: Script, node: ast.expr, name: str) -> Fix | None:
    return (
        Fix(f"Write .{name}", (script.as_attribute(node, name),)) if isinstance(node, ast.Subscript) else None
    )


RULE = Rule("no-custom-properties", "error", "Custom properties of what takes none", _check)
