"""Custom properties of what takes none.

Brackets, `in` and functions such as `get` and `keys` mean custom properties. An operator has none, and the preferences
of an add-on have none since Blender 5.0: each property is an attribute. A geometry-nodes modifier has none since 5.2,
where its inputs are properties. Blender refuses the rest with a TypeError.

```python
class Count(bpy.types.Operator):
    bl_idname, bl_label = "object.count", "Count"
    number: bpy.props.IntProperty()

    def execute(self, context):
        self["number"] = 3  # reported: self.number = 3
        return {"FINISHED"}


bpy.context.preferences.addons["cycles"].preferences.keys()  # reported

modifier = bpy.context.object.modifiers.new("Scatter", "NODES")
modifier["Socket_2"] = 5.0  # reported since 5.2: modifier.properties.inputs.Socket_2.value = 5.0
```

Not reported: what a class of the script answers itself, by a `__getitem__` or a `keys` of its own.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Instance, LocalInstance, members
from kb_build.symbols.api_names import TYPES as T
from kb_check.findings import Edit, Finding, Fix
from kb_check.nodes.group_inputs import input_now
from kb_check.registered.classes import own_classes
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_serve.recognise.chains.subscripts import (
    INPUT_KEY,
    NODES_MODIFIER,
    OF_NODES_MODIFIER,
    CustomProperties,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.registered.classes import OwnClass
    from kb_check.script import Script

_SINCE = 5, 0
_PREFERENCES = f"{T}AddonPreferences"
# Whose instances refuse all custom properties, as tried.
_CLASSES = (f"{T}Operator", f"{T}Macro", _PREFERENCES)
# What is asked of an input, by the end of the key that it once had: its value, or what is used instead.
_OF_INPUT = {"": "value", "_use_attribute": "type", "_attribute_name": "attribute_name"}
_INPUTS = "properties.inputs"
_METHODS = frozenset(
    {
        "get", "items", "keys", "pop", "values",
        "id_properties_clear", "id_properties_ensure", "id_properties_ui",
    }
)  # fmt: skip
_OF_BRACKETS = frozenset({"__getitem__", "__setitem__", "__delitem__", "__contains__"})


def _check(script: Script) -> Iterator[Finding]:
    classes = _CLASSES
    if "modifier" in script.code and CustomProperties(script.names.reader).inputs_are_properties:
        classes += OF_NODES_MODIFIER
    is_there = len(classes) > len(_CLASSES) or any(own.path in _CLASSES for own in own_classes(script))
    if script.version < _SINCE or not (is_there or "preferences" in script.code or "operator" in script.code):
        return
    for node in script.all(ast.Subscript, ast.Compare, ast.Call):
        for owner, names in _asked(node):
            found = _class_of(script, owner, names, classes)
            if found and not is_tried(script, node):
                cls, own = found
                if cls in OF_NODES_MODIFIER:
                    yield _of_inputs(script, node, owner, cls)
                    continue
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


def _class_of(
    script: Script, node: ast.expr, names: frozenset[str], classes: tuple[str, ...]
) -> tuple[str, OwnClass | None] | None:
    """Which of some classes without custom properties a value surely is of, and the script's own one below it."""
    kinds = members(script.type_of(node) or UNKNOWN)
    if len(kinds) != 1:
        return None
    row = script.analysis.resolutions.get(node)
    if row is not None and (row.guarded or not row.sure):
        return None
    match kinds[0]:
        case Instance(cls=cls, sure=True):
            base = next((one for one in classes if script.api.descends(cls, one)), "")
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


def _of_inputs(script: Script, node: ast.expr, owner: ast.expr, cls: str) -> Finding:
    """What is told where the inputs of a geometry-nodes modifier, which are properties, are asked for as keys."""
    told = f"An instance of `{cls}` takes no custom properties since Blender 5.2"
    modifier = ast.unparse(
        owner.value if isinstance(owner, ast.Attribute) and cls != NODES_MODIFIER else owner
    )
    asked = _input(node.slice, modifier) if isinstance(node, ast.Subscript) else None
    now = input_now(script, node, owner) if isinstance(node, ast.Subscript) and cls == NODES_MODIFIER else ""
    if now:
        told += (
            f": write `{modifier}.{_INPUTS}.{now}.value`, as this input is called {now!r} now, or as `item.identifier` "
            "of `node_group.interface.items_tree` says."
        )
        return Finding(RULE.id, "error", script.span(node), told, cls)
    if asked is None or not isinstance(node, ast.Subscript):
        told += f": its inputs are attributes, as `{modifier}.{_INPUTS}.Socket_2.value`."
        return Finding(RULE.id, "error", script.span(node), told, cls)
    text, member = asked
    if member == _OF_INPUT["_use_attribute"]:  # a truth value became one of two names
        told += f": write `{text}`, which is 'VALUE' or 'ATTRIBUTE'."
        return Finding(RULE.id, "error", script.span(node), told, cls)
    fix = None if isinstance(node.ctx, ast.Del) else Fix(f"Write {text}", (Edit(script.span(node), text),))
    return Finding(RULE.id, "error", script.span(node), f"{told}: write `{text}`.", cls, (), fix)


def _input(key: ast.expr, modifier: str) -> tuple[str, str] | None:
    """What asks the modifier for an input, and the member that is asked, by the key that the input once had; None for
    what is no key of an input.
    """
    match key:
        case ast.Constant(value=str(text)):
            if (parts := INPUT_KEY.fullmatch(text)) is None:
                return None
            member = _OF_INPUT[parts[2] or ""]
            return f"{modifier}.{_INPUTS}.{parts[1]}.{member}", member
        case ast.BinOp(left=left, op=ast.Add(), right=ast.Constant(value=str(end))) if end in _OF_INPUT:
            member = _OF_INPUT[end]
            return f"getattr({modifier}.{_INPUTS}, {ast.unparse(left)}).{member}", member
        case ast.Name() | ast.Attribute():
            return f"getattr({modifier}.{_INPUTS}, {ast.unparse(key)}).value", "value"
        case _:
            return None


def _fix(script: Script, node: ast.expr, name: str) -> Fix | None:
    return (
        Fix(f"Write .{name}", (script.as_attribute(node, name),)) if isinstance(node, ast.Subscript) else None
    )


RULE = Rule("no-custom-properties", "error", "Custom properties of what takes none", _check)
