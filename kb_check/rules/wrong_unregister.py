"""A class that is unregistered and never registered, or registered where it is to be unregistered.

```python
classes = (Settings, Panel)


def register():
    for cls in classes:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(classes):
        bpy.utils.register_class(cls)  # reported: unregister_class
```

Not reported: what ``unregister()`` registers in the place of what it unregisters, classes that another file names, or
that are found by themselves (``__subclasses__``), and what stands in a ``try`` that catches the error.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding, Fix
from kb_check.registered.classes import own_classes
from kb_check.registered.left_out import is_named_only_in
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.syntax.literals import times_bound

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_REGISTER, _UNREGISTER = "bpy.utils.register_class", "bpy.utils.unregister_class"
_REGISTERING, _UNREGISTERING = "register", "unregister"
_RIGHT = "unregister_class"
_REFUSED, _AGAIN = ("RuntimeError",), ("ValueError",)


def _check(script: Script) -> Iterator[Finding]:
    functions = {node.name: node for node in script.tree.body if isinstance(node, ast.FunctionDef)}
    if _REGISTERING in functions and _UNREGISTERING in functions:
        yield from _registered_again(script, functions[_UNREGISTERING], functions[_REGISTERING])
    taken = {
        call.args[0]: call
        for call in script.all(ast.Call)
        if len(call.args) == 1 and callee_path(script, call) == _UNREGISTER
    }
    own = {one.node.name: one for one in own_classes(script) if times_bound(script)[one.node.name] == 1}
    for node, call in taken.items():
        one = own.get(node.id) if isinstance(node, ast.Name) else None
        if one and is_named_only_in(script, one, taken) and not is_tried(script, call, _REFUSED):
            told = f"`{one.node.name}` is never registered: Blender refuses to unregister it."
            yield Finding(RULE.id, "error", script.span(node), told, _UNREGISTER)


def _registered_again(
    script: Script, unregister: ast.FunctionDef, register: ast.FunctionDef
) -> Iterator[Finding]:
    """What ``unregister()`` registers of what ``register()`` does, where it unregisters nothing."""
    if any(_RIGHT in (getattr(node, "attr", ""), getattr(node, "id", "")) for node in walk(unregister)):
        return
    registered = _registered(script, register).values()
    for call, text in _registered(script, unregister).items():
        edit = script.renamed(call.func, _RIGHT)
        if text in registered and edit and not is_tried(script, call, _AGAIN):
            told = "`register()` has registered this, and Blender refuses it again: `unregister_class` is meant here."
            yield Finding(
                RULE.id, "error", script.name_span(call.func), told, _REGISTER, (_UNREGISTER,),
                Fix(f"Write {_RIGHT}", (edit,), sure=True),
            )  # fmt: skip


def _registered(script: Script, function: ast.FunctionDef) -> dict[ast.Call, str]:
    """The calls of a function that register classes → the class, or the list that they go through, as it is written."""
    listed = {
        node.target.id: ast.unparse(_forwards(node.iter))
        for node in walk(function)
        if isinstance(node, ast.For) and isinstance(node.target, ast.Name)
    }
    return {
        node: listed.get(name, name)
        for node in walk(function)
        if isinstance(node, ast.Call) and callee_path(script, node) == _REGISTER and len(node.args) == 1
        if (name := ast.unparse(node.args[0]))
    }


def _forwards(node: ast.expr) -> ast.expr:
    match node:
        case ast.Call(func=ast.Name(id="reversed"), args=[several]):
            return several
        case _:
            return node


RULE = Rule("wrong-unregister", "error", "A class that is not to be registered or unregistered there", _check)
