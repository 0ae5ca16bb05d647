"""Where a script surely deletes all objects that can be selected, or all that there are, one after the other.

```python
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
for ob in list(bpy.data.objects):
    bpy.data.objects.remove(ob)
```
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import builtin_called, callee_path, member_path
from kb_check.script import once_per_script
from kb_check.syntax.bindings import alias
from kb_check.syntax.bodies import places

if TYPE_CHECKING:
    from kb_check.script import Script

_DELETE, _SELECT = "bpy.ops.object.delete", "bpy.ops.object.select_all"
_SELECT_SET = f"{OBJECT}.select_set"
_REMOVE = f"{T}BlendDataObjects.remove"
_ALL = frozenset({f"{T}BlendData.objects", f"{T}Scene.objects"})
_SCENE = f"{T}Context.scene"
_COPYING = frozenset({"list", "tuple"})


@once_per_script
def deleting_selected(script: Script) -> frozenset[ast.stmt]:
    """The statements that delete all objects that can be selected: one before has selected them."""
    return frozenset(
        node
        for node in script.all(ast.Expr)
        if _operator(script, node) == _DELETE
        and node in places(script)
        and _is_behind_selecting(script, node)
    )


@once_per_script
def deleting_all(script: Script) -> frozenset[ast.stmt]:
    """The statements behind which there surely is no object that was there before: loops over all of them."""
    return frozenset(node for node in script.all(ast.For) if _removes_all(script, node))


def _is_behind_selecting(script: Script, statement: ast.Expr) -> bool:
    body, place = places(script)[statement]
    match body[place - 1] if place else None:
        case ast.For(
            target=ast.Name(id=name),
            iter=gone_through,
            body=[
                ast.Expr(
                    value=ast.Call(
                        func=ast.Attribute(value=ast.Name(id=selected)), args=[ast.Constant(value=True)]
                    ) as call
                )
            ],
        ):
            is_selecting = name == selected and callee_path(script, call) == _SELECT_SET
            return is_selecting and _is_all(script, gone_through)
        case (
            ast.Expr(
                value=ast.Call(
                    args=[], keywords=[ast.keyword(arg="action", value=ast.Constant(value="SELECT"))]
                )
            ) as before
        ):
            return _operator(script, before) == _SELECT
        case _:
            return False


def _operator(script: Script, statement: ast.Expr) -> str:
    match statement.value:
        case ast.Call(args=[]) as call:
            return callee_path(script, call)
        case _:
            return ""


def _removes_all(script: Script, loop: ast.For) -> bool:
    match loop:
        case ast.For(
            target=ast.Name(id=name),
            body=[ast.Expr(value=ast.Call(args=[ast.Name(id=removed), *_]) as call)],
        ):
            return name == removed and callee_path(script, call) == _REMOVE and _is_all(script, loop.iter)
        case _:
            return False


def _is_all(script: Script, node: ast.expr) -> bool:
    """Whether an expression is all objects of the file, or of the scene, or a copy of their list."""
    match node:
        case ast.Call(args=[held]) as call if builtin_called(script, call) in _COPYING:
            return _is_all(script, held)
        case ast.Subscript(value=held, slice=ast.Slice(lower=None, upper=None, step=None)):
            return _is_all(script, held)
        case _:
            match alias(script, node):
                case ast.Attribute(value=owner) as objects:
                    path = member_path(script, objects)
                    is_scene = isinstance(owner, ast.Attribute) and member_path(script, owner) == _SCENE
                    return path in _ALL and (is_scene or not path.startswith(f"{T}Scene"))
                case _:
                    return False
