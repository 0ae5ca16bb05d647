"""An element is read or replaced in a collection that is empty on a new thing, and nothing in the script adds one.

```python
mesh = bpy.data.meshes.new("Sheet")
mesh.materials[0] = material  # reported: mesh.materials.append(material) adds one
bpy.ops.mesh.primitive_cube_add()
bpy.context.object.material_slots[0].material = material  # reported
```

Not reported: things that the script did not make itself; scripts that do anything else with a collection of the name,
that call a function of the thing, give it to one, or run an operator, since that may fill it (``mesh.from_pydata(…)``);
that compute names, or import modules which may change scenes; and what stands in a ``try``.
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Instance
from kb_build.index.analysis import stem, words
from kb_build.symbols.api_names import OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import EMPTY
from kb_build.symbols.paths import last_name
from kb_check.calls.resolved import callee_path, member_path
from kb_check.findings import Finding
from kb_check.modes.edit_bones import edited_outside
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import (
    MESH,
    has_new_data,
    has_plain_operators_only,
    is_new,
    is_primitive,
    is_primitive_mesh,
)
from kb_check.script import once_for_each, once_per_script
from kb_check.values.documented import is_related

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

# What fills nothing of the thing that it is called on, and what only takes a thing in.
_HARMLESS = frozenset(
    {"hide_get", "hide_set", "select_get", "select_set", "shade_flat", "shade_smooth", "update", "update_tag"}
)
_TAKING = frozenset({"link", "new"})
_ADDING = ("append", "new", "add", "link")
# Collections that Blender fills as another one of the same thing is filled, with the stem of its name.
_FILLED_BESIDE = {"particle_systems": {stem("modifiers")}}
# What the operators that make meshes fill of them.
_OF_PRIMITIVES = frozenset(
    {
        "attributes",
        "corner_normals",
        "edges",
        "loop_triangle_polygons",
        "loop_triangles",
        "loops",
        "polygon_normals",
        "polygons",
        "uv_layers",
        "vertex_normals",
        "vertices",
    }
)
_TREE = f"{T}NodeTree"
_WORD = re.compile(r"\w+")
_SCENES = frozenset({f"{T}Context.collection", f"{T}Scene.collection"})


def _check(script: Script) -> Iterator[Finding]:
    for collection, node in _subscripts(script).items():
        symbol = _empty(script, collection)
        if (
            symbol
            and knows_all(script)
            and _is_made_empty(script, symbol, collection.value)
            and not is_tried(script, node)
            and node not in edited_outside(script)
            and not _may_be_filled(script, symbol.path)
        ):
            message = f"`{symbol.path}` is empty on what is new, and nothing in this script adds to it"
            yield Finding(
                RULE.id, "warning", script.span(node), f"{message}{_adding(script, symbol)}.", symbol.path
            )


def _is_made_empty(script: Script, symbol: Symbol, owner: ast.expr) -> bool:
    """Whether the script surely has made the owner of a collection, and without anything in that."""
    if symbol.owner == OBJECT and is_primitive(script, owner):
        return True
    if symbol.owner == MESH and symbol.name not in _OF_PRIMITIVES and is_primitive_mesh(script, owner):
        return True
    return is_new(script, owner) and (symbol.owner != OBJECT or has_new_data(script, owner))


@once_per_script
def _subscripts(script: Script) -> dict[ast.Attribute, ast.Subscript]:
    """The attributes of which the script takes an element by a constant, with the first place of each."""
    return {
        node.value: node
        for node in script.all(ast.Subscript)
        if isinstance(node.value, ast.Attribute) and isinstance(node.slice, (ast.Constant, ast.UnaryOp))
    }


def _empty(script: Script, collection: ast.Attribute) -> Symbol | None:
    """The symbol of a collection that is empty on all that is new."""
    symbol = script.api.symbols.symbol(member_path(script, collection))
    return symbol if symbol and EMPTY in symbol.flags else None


def _adding(script: Script, symbol: Symbol) -> str:
    functions = script.names.reader.members(f"{T}{symbol.collection}") if symbol.collection else {}
    names = [name for name in _ADDING if name in functions]
    return f": `.{symbol.name}.{names[0]}()` does" if names else ""


@once_for_each
def _may_be_filled(script: Script, path: str) -> bool:
    """Whether anything in the script may add to a collection, or asks for its size."""
    symbol = script.api.symbols.symbol(path)
    if symbol is None:
        return True
    own = _stems(symbol.name) | _FILLED_BESIDE.get(symbol.name, set())
    return (
        not has_plain_operators_only(script)
        or symbol.name in _texts(script)
        or any(own & _stems(name) for name in _mentioned(script))
        or any(is_related(script, cls, symbol.owner) for cls in _worked_on(script))
    )


def _stems(name: str) -> set[str]:
    return set(map(stem, words(name)))


@once_per_script
def _texts(script: Script) -> frozenset[str]:
    """The words of the script's texts, but for the keys that it takes elements by."""
    keys = {node.slice for node in _subscripts(script).values()}
    nodes = (node for node in script.all(ast.Constant) if node not in keys)
    return frozenset(
        word for node in nodes if isinstance(node.value, str) for word in _WORD.findall(node.value)
    )


@once_per_script
def _mentioned(script: Script) -> frozenset[str]:
    """The attributes that the script reads or sets, but for the collections whose elements it takes by a constant, and
    what is on the way to link an object: that fills other collections.
    """
    left_out = {*_subscripts(script), *_linking(script), *_given_trees(script)}
    elements = set(_subscripts(script).values())
    return frozenset(
        node.attr
        for node in script.all(ast.Attribute)
        if node not in left_out and node.value not in elements and not _is_of_data(script, node)
    )


def _is_of_data(script: Script, node: ast.Attribute) -> bool:
    """Whether an attribute is a collection of ``bpy.data``."""
    row = script.analysis.resolutions.get(node)
    symbols = row.symbols if row else ()
    return bool(symbols) and all(path.startswith(f"{T}BlendData.") for path in symbols)


@once_per_script
def _given_trees(script: Script) -> frozenset[ast.Attribute]:
    """The attributes that a tree of nodes is assigned to, as it is: ``scene.compositing_node_group = tree``."""
    return frozenset(
        target
        for node in script.all(ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Attribute) and script.api.descends(script.class_of(node.value), _TREE)
    )


@once_per_script
def _linking(script: Script) -> frozenset[ast.Attribute]:
    """The attributes of ``scene.collection.objects.link``, where the script has not made the scene."""
    found: set[ast.Attribute] = set()
    for node in script.all(ast.Attribute):
        match node:
            case ast.Attribute(
                attr="link",
                value=ast.Attribute(attr="objects", value=ast.Attribute() as collection) as objects,
            ):
                row = script.analysis.resolutions.get(collection)
                if row and set(row.symbols) <= _SCENES and not is_new(script, collection.value):
                    found |= {node, objects, collection}
            case _:
                pass
    return frozenset(found)


@once_per_script
def _worked_on(script: Script) -> frozenset[str]:
    """The classes of what the script calls functions of, gives to functions or assigns, where that may fill it."""
    found: list[ast.expr] = []
    for node in script.all(ast.Call, ast.Assign, ast.Return):
        match node:
            case ast.Call(func=ast.Attribute(value=thing, attr=name)) if name not in _HARMLESS:
                found.append(thing)
                if last_name(callee_path(script, node)) not in _TAKING:
                    found += [*node.args, *(keyword.value for keyword in node.keywords)]
            case ast.Call():
                found += [*node.args, *(keyword.value for keyword in node.keywords)]
            case ast.Assign(targets=[ast.Attribute() as target]) if target in _given_trees(script):
                pass
            case (
                ast.Assign(targets=[ast.Attribute() | ast.Subscript()], value=value)
                | ast.Return(value=ast.expr() as value)
            ):
                found.append(value)
            case _:
                pass
    return frozenset(kind.cls for kind in map(script.type_of, found) if isinstance(kind, Instance))


RULE = Rule("empty-collection", "warning", "An element of what is empty on a new thing", _check)
