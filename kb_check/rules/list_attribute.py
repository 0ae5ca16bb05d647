"""An attribute that a list or a tuple does not have.

Read from several things together, and meant for one of them, or from a list of handlers, which has Python's methods.

```python
obj.driver_add("location").driver  # reported: a list of three curves, for there is no index
obj.driver_add("location", 0).driver
bpy.app.handlers.load_post.add(follow)  # reported: append
bpy.context.selected_objects.location  # reported: each of them has one
quaternion.to_axis_angle().x  # reported: a tuple of the axis and the angle
obj.children.append(child)  # reported: a tuple, which nothing is added to
scene["sizes"] = [1, 2]
scene["sizes"].append(3)  # reported: such a custom property is an array
```

Not reported: what stands in a ``try`` that catches AttributeError, and names that the script asks for by a text.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import NONE, UNKNOWN, Instance, Sequence, Tuple, Type, members
from kb_check.findings import Finding
from kb_check.registered.handler_lists import handler_list
from kb_check.rule import Rule
from kb_check.running.raised import LACKS
from kb_check.running.tried import is_tried
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.words import words_in_texts
from kb_check.values.custom_values import is_number_array
from kb_check.values.misfits import describe
from kb_serve.recognise.elsewhere.elements import elsewhere

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ADDING = "bpy.types.bpy_struct.driver_add"
_OF_ARRAY = frozenset({"to_list", "typecode"})
_GROWING = frozenset({"append", "extend", "insert"})
_LONGEST = 60  # expression that is shown


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Attribute):
        if hasattr(tuple, node.attr):
            continue
        if not hasattr(list, node.attr) and (name := handler_list(script, node.value)):
            yield Finding(
                RULE.id, "error", script.name_span(node),
                f"`{name}` is a list, which has no `{node.attr}`: `append` adds a function, `remove` takes one out.",
                name,
            )  # fmt: skip
            continue
        told = _told(script, node) or _of_array(script, node)
        if told and not is_tried(script, node, LACKS):
            yield Finding(RULE.id, "error", script.name_span(node), told)


def _told(script: Script, node: ast.Attribute) -> str:
    """What is wrong with reading an attribute of what the API gives; empty where it may be no list or tuple."""
    source = once_bound(script, node.value)
    row = script.analysis.resolutions.get(source)
    kinds = [kind for kind in members(script.type_of(node.value) or UNKNOWN) if kind != NONE]
    if row is None or not row.sure or row.guarded or row.possible or len(kinds) != 1:
        return ""
    if node.attr in words_in_texts(script) or _has(kinds[0], node.attr):
        return ""
    match kinds[0]:
        case Sequence(kind="list", element=Instance()) if row.value == _ADDING:
            return (
                "`driver_add` of a property with several values gives a list of curves, one for each: "
                "give an index, `driver_add(path, index)`, or take one of the list."
            )
        case Sequence(kind="list" | "tuple" as several, element=element):
            other = elsewhere(row.symbols[0], node.attr, script.names.reader) if row.symbols else None
            advice = f" {other.how}" if other else _advice(script, element, node.attr)
            return f"`{_short(source)}` is a {several}, which has no `{node.attr}`.{advice}"
        case Tuple(items=items):
            held = ", ".join(describe(item) or "something else" for item in items)
            return f"`{_short(source)}` is a tuple, which has no `{node.attr}`. It holds {held}."
        case _:
            return ""


def _of_array(script: Script, node: ast.Attribute) -> str:
    """The same of a custom property that keeps the numbers of a list: an array, whose length never changes."""
    has_it = node.attr in _OF_ARRAY or node.attr.startswith("__")
    if has_it or node.attr in words_in_texts(script) or not is_number_array(script, node.value):
        return ""
    whole = _short(once_bound(script, node.value))
    advice = (
        f"Assign a new list: `{whole} = [*{whole}, …]`." if node.attr in _GROWING else "It has `to_list`."
    )
    return f"`{whole}` is an array of numbers, which has no `{node.attr}`. {advice}"


def _has(kind: Type, name: str) -> bool:
    """Whether Python's class of several things has an attribute: a tuple surely has not what only lists have."""
    is_tuple = isinstance(kind, Sequence) and kind.kind == "tuple"
    return hasattr(tuple if is_tuple else list, name)


def _advice(script: Script, element: Type, name: str) -> str:
    has_it = isinstance(element, Instance) and script.api.member(element.cls, name)
    return " Its items do." if has_it else ""


def _short(node: ast.expr) -> str:
    return ast.unparse(node)[:_LONGEST]


RULE = Rule("list-attribute", "error", "An attribute that a list or a tuple does not have", _check)
