"""An object that is unlinked from a collection which the script has just made, and which has no objects.

```python
props = bpy.data.collections.new("Props")
context.scene.collection.children.link(props)
props.objects.unlink(obj)  # reported: RuntimeError
for collection in obj.users_collection:  # those that have it
    collection.objects.unlink(obj)
props.objects.link(obj)
```

Not reported: what follows statements that may link objects, and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in, names_of_others
from kb_check.modes.keeping import is_harmless
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_MAKING = f"{T}BlendDataCollections.new"
_UNLINK, _LINK = f"{T}CollectionObjects.unlink", f"{T}CollectionObjects.link"
_ERROR = ("RuntimeError",)


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script):
        return
    for body in bodies(script):
        new: set[str] = set()
        for statement in body:
            if new and _may_link(script, statement):
                new = set()
            elif new:
                yield from _unlinked(script, statement, new)
                new -= {*bound_in(statement)}
            match statement:
                case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call) if callee_path(
                    script, call
                ) == _MAKING and name not in names_of_others(script):
                    new.add(name)
                case _:
                    pass


def _unlinked(script: Script, statement: ast.stmt, new: set[str]) -> Iterator[Finding]:
    """What a statement unlinks from collections that are new; nothing of one that defines a function or a class."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return
    for node in walk(statement):
        match node:
            case ast.Call(
                func=ast.Attribute(value=ast.Attribute(value=ast.Name(id=name), attr="objects")), args=[obj]
            ) if name in new and callee_path(script, node) == _UNLINK and not is_tried(script, node, _ERROR):
                told = f"`{name}` is new and has no objects: RuntimeError."
                if isinstance(obj, ast.Name):
                    told += (
                        f" The collections that have it: `for one in {obj.id}.users_collection: "
                        f"one.objects.unlink({obj.id})`."
                    )
                yield Finding(RULE.id, "error", script.span(node), told, _UNLINK)
            case _:
                pass


def _may_link(script: Script, statement: ast.stmt) -> bool:
    """Whether a statement may put objects into a collection: by itself, by operators, or by what is not seen."""
    for node in walk(statement):
        if isinstance(node, ast.Call):
            path = callee_path(script, node)
            if path == _LINK or path.startswith(OPERATORS) or not (path or is_harmless(script, node)):
                return True
    return False


RULE = Rule("not-linked", "error", "An object that is unlinked from a new collection", _check)
