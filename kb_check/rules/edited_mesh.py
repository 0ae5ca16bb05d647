"""Mesh data that are changed while the mesh is in Edit Mode.

```python
ob = bpy.context.object
bpy.ops.object.mode_set(mode="EDIT")
ob.data.vertices[0].select = True  # reported: lost when Edit Mode is left
bm = bmesh.new()
bm.to_mesh(ob.data)  # reported: Blender refuses it
bpy.ops.object.mode_set(mode="OBJECT")
ob.data.vertices[0].select = True
```

In Edit Mode a mesh has a BMesh of its own, that of `bmesh.from_edit_mesh`: operators work on it, and it overwrites the
mesh when Edit Mode is left. What is lost is a warning, what Blender refuses an error.

Not reported: modes that are entered or left elsewhere than in the statements around; objects that these do not make
active themselves; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import called_operators, callee_path, member_path
from kb_check.findings import Finding
from kb_check.modes.keeping import keeps_mode, run_in
from kb_check.modes.state import MODE_SET
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.scene.held_objects import HeldObjects
from kb_check.syntax.bindings import bindings, iterated, once_bound
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ELEMENTS = ("vertices", "edges", "polygons", "loops")
_CLASSES = tuple(f"{T}Mesh{kind}." for kind in ("Vertex", "Edge", "Polygon", "Loop"))
_TO_MESH = "bmesh.types.BMesh.to_mesh"
# Methods of the mesh, and of its elements, that are refused, and those whose effect is lost.
_REFUSED = frozenset(
    {f"{T}Mesh.from_pydata", *(f"{T}Mesh{kind}.add" for kind in ("Vertices", "Edges", "Loops", "Polygons"))}
)
_LOST = frozenset({f"{T}Mesh.transform", f"{T}Mesh.clear_geometry", f"{T}Mesh.flip_normals"})
_FILLING = "foreach_set"
_OF_GROUPS = frozenset({f"{T}VertexGroup.add", f"{T}VertexGroup.remove"})
_SIMPLE = (ast.Expr, ast.Assign, ast.AugAssign)
_LEAVING = "`bpy.ops.object.mode_set(mode='OBJECT')` comes before"


def _check(script: Script) -> Iterator[Finding]:
    if computes_names(script) or called_operators(script).isdisjoint(MODE_SET):
        return
    for body in bodies(script):
        objects = HeldObjects(script)
        for statement in body:
            if objects.edited and (isinstance(statement, _SIMPLE) or keeps_mode(script, statement)):
                yield from _changed(script, statement, objects)
            objects.pass_by(statement)


def _changed(script: Script, statement: ast.stmt, objects: HeldObjects) -> Iterator[Finding]:
    """The first thing that a statement, or what stands within it, does to the mesh that is edited."""
    for node in run_in(statement):
        match node:
            case ast.Call():
                refused, lost, path = (
                    _refused_of(script, node),
                    _lost_of(script, node),
                    callee_path(script, node),
                )
            case ast.Attribute(ctx=ast.Store()) | ast.Subscript(ctx=ast.Store()):
                refused, (lost, path) = None, _set_of(script, node)
            case _:
                continue
        changed = refused or lost
        is_edited = changed is not None and objects.edited in (objects.owner(changed), objects.thing(changed))
        if is_edited and not is_tried(script, node):
            told = (
                f"Blender refuses this: {_LEAVING}"
                if refused
                else f"this is lost when that is left: {_LEAVING}, or change the BMesh of `bmesh.from_edit_mesh`"
            )
            yield Finding(
                RULE.id, "error" if refused else "warning", script.span(node),
                f"The mesh is in Edit Mode here, and {told}.", path,
            )  # fmt: skip
            return


def _refused_of(script: Script, call: ast.Call) -> ast.expr | None:
    """The mesh, or the object, that a call needs out of Edit Mode."""
    path = callee_path(script, call)
    match call:
        case ast.Call(args=[mesh]) if path == _TO_MESH:
            return mesh
        case ast.Call(func=ast.Attribute(value=ast.Attribute(value=mesh, attr=name))) if (
            path in _REFUSED and name in _ELEMENTS
        ):
            return mesh
        case ast.Call(func=ast.Attribute(value=mesh)) if path in _REFUSED:
            return mesh
        case ast.Call(func=ast.Attribute(value=group)) if path in _OF_GROUPS:
            return _owner_of_group(script, group)
        case _:
            return None


def _owner_of_group(script: Script, group: ast.expr) -> ast.expr | None:
    """The object whose group of vertices an expression is."""
    match once_bound(script, group):
        case (
            ast.Call(func=ast.Attribute(value=ast.Attribute(value=owner, attr="vertex_groups")))
            | ast.Subscript(value=ast.Attribute(value=owner, attr="vertex_groups"))
        ):
            return owner
        case _:
            return None


def _lost_of(script: Script, call: ast.Call) -> ast.expr | None:
    """The mesh that a call changes to no effect in Edit Mode."""
    match call:
        case ast.Call(func=ast.Attribute(value=ast.Attribute(value=mesh, attr=name), attr=filling)) if (
            filling == _FILLING and name in _ELEMENTS
        ):
            return mesh
        case ast.Call(func=ast.Attribute(value=mesh)) if callee_path(script, call) in _LOST:
            return mesh
        case _:
            return None


def _set_of(script: Script, target: ast.expr) -> tuple[ast.expr | None, str]:
    """The mesh of whose elements a target is, with the path of what is set of them: ``mesh`` of
    ``mesh.vertices[0].co.x``.
    """
    while isinstance(target, (ast.Attribute, ast.Subscript)):
        path = member_path(script, target) if isinstance(target, ast.Attribute) else ""
        if path.startswith(_CLASSES):
            return _mesh_of(script, target.value), path
        target = target.value
    return None, ""


def _mesh_of(script: Script, element: ast.expr) -> ast.expr | None:
    """The mesh that an element is of: one by index, or those that loops over the elements of one mesh go through."""
    match element:
        case ast.Subscript(value=elements):
            return _mesh_with(elements)
        case ast.Name(id=name):
            through = iterated(script).get(name, [])
            meshes = [_mesh_with(elements) for elements in through]
            texts = {ast.unparse(mesh) if mesh else "" for mesh in meshes}
            is_one = len(texts) == 1 and len(through) == len(bindings(script).get(name, ()))
            return meshes[0] if is_one else None
        case _:
            return None


def _mesh_with(elements: ast.expr) -> ast.expr | None:
    match elements:
        case ast.Attribute(value=mesh, attr=name) if name in _ELEMENTS:
            return mesh
        case _:
            return None


RULE = Rule("edited-mesh", "warning", "Mesh data that are changed while the mesh is in Edit Mode", _check)
