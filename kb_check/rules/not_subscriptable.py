"""Items of what cannot be asked for them so.

Brackets on one of Blender's structures mean its custom properties, so the key is a text; on a collection they take an
index, a slice without a step, or a name if its items have names.

```python
scene[0]  # reported
mesh.vertices["Corner"]  # reported: vertices have no names
bpy.data.objects[::2]  # reported: bpy.data.objects[:][::2]
bpy.types["Object"]  # reported: getattr(bpy.types, "Object")
bmesh.ops.extrude_face_region(bm, geom=faces)["verts"]  # reported: it gives `geom`
mesh.vertices.add(1)[0]  # reported: it returns nothing
vert[bm.loops.layers.uv.active]  # reported: a layer of loops
Settings.__annotations__["count"][1]  # reported: .keywords, since 2.93
```

Reported too: items of a collection that are deleted, or assigned to (materials are, by index); an index beyond a
vector, or beyond the sockets of a node whose sockets are always the same. Not reported: names that may be there or not.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.api import ARRAY
from kb_build.flow.blender.facts import LAYER_ACCESS, LAYER_ITEM, LAYERS_OF, NODES_WITH_SOCKETS_OF_THEIR_OWN
from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Collection,
    Instance,
    Mapping,
    Module,
    NoneValue,
    Operator,
    Plain,
    Sequence,
    Tuple,
    Type,
    members,
    without_none,
)
from kb_build.symbols.api_names import BLEND_DATA, CONTEXT, GROUPS, SIDES, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NAMES_ITEMS
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import nothing_from
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.raised import LACKS_KEY, REFUSES
from kb_check.running.tried import is_tried
from kb_check.script import once_per_script
from kb_check.syntax.annotated import ONE_IS_WRONG, annotated
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import number
from kb_check.values.documented import LENGTHS
from kb_check.values.lengths import CHANGING_ARRAYS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_VECTORS = frozenset({*LENGTHS, "mathutils.Vector", "mathutils.Matrix"})
_NO_STEPS = frozenset({"bmesh.types.BMVertSeq", "bmesh.types.BMEdgeSeq", "bmesh.types.BMFaceSeq",
                       "bmesh.types.BMLoopSeq", "bmesh.types.BMElemSeq"})  # fmt: skip
# The collections of which items are assigned to, and those of the script's own.
_ASSIGNED = frozenset({f"{T}IDMaterials", GROUPS})
# Structures that refuse custom properties of any name, as tried.
_NO_CUSTOM_PROPERTIES = frozenset({CONTEXT, BLEND_DATA, f"{T}RenderSettings", f"{T}MeshVertex"})
_DECLARATIONS_SINCE = 2, 93
_BMESH, _ELEMENT = "bmesh.ops.", "bmesh.types.BM"
_FILLING = frozenset({"update", "setdefault"})
_ELEMENTS = frozenset({"Vert", "Edge", "Face", "Loop"})
_PARTS = {"verts": "BMVert", "edges": "BMEdge", "faces": "BMFace"}
# What the classes of collections have, which annotations name: ``nodes: bpy.types.Nodes``.
_OF_COLLECTIONS = frozenset(
    {"active", "add", "append", "clear", "create", "get", "link", "load", "new", "remove"}
)


def _check(script: Script) -> Iterator[Finding]:
    for node in script.all(ast.Subscript):
        if (function := nothing_from(script, node.value)) and not is_tried(script, node, REFUSES):
            told = f"`{function}` returns nothing: there are no items."
            yield Finding(RULE.id, "error", script.span(node), told, function)
        if _is_of_declaration(script, node):
            told = "A declaration in `__annotations__` has no items: what it was given is its `.keywords`."
            yield Finding(RULE.id, "error", script.span(node), told)
        if (kind := script.type_of(node.value)) is None:
            continue
        told = {_refusal(script, node, member) for member in members(kind) if member != NONE}
        if (missing := _of_result(script, node)) and isinstance(kind, Mapping):
            told = {missing}
        if len(told) == 1 and (message := told.pop()) and not _is_guarded(script, node):
            if isinstance(kind, Instance) and (said := annotated(script, node.value, kind.cls)):
                told = f"{message} {said}: {ONE_IS_WRONG}."
                yield Finding(RULE.id, "warning", script.span(node), told)
                continue
            yield Finding(RULE.id, "error", script.span(node), message, "", (), _fix(script, node))


def _is_of_declaration(script: Script, node: ast.Subscript) -> bool:
    """Whether an item is asked of what a class is annotated with: a pair before 2.93, if it is one of bpy.props."""
    match node:
        case ast.Subscript(
            value=ast.Subscript(value=ast.Attribute(attr="__annotations__")), slice=ast.Constant(value=0 | 1)
        ):
            knows_both = any(part.attr == "keywords" for part in script.all(ast.Attribute))
            declares = any(row.value.endswith("Property") for row in script.resolutions("call", "name"))
            is_read = script.type_of(node.value) is not None
            return (
                script.version >= _DECLARATIONS_SINCE
                and is_read
                and declares
                and not knows_both
                and not is_tried(script, node, REFUSES)
            )
        case _:
            return False


def _is_guarded(script: Script, node: ast.Subscript) -> bool:
    """Whether the script is ready for a refusal, or the type of the owner is a guess."""
    for part in walk(node):
        row = script.analysis.resolutions.get(part)
        if row is not None and (row.guarded or not row.sure):
            return True
    return False


def _refusal(script: Script, node: ast.Subscript, kind: Type) -> str:
    """What is wrong with asking a value of one type for these items; empty if nothing surely is."""
    key = None if isinstance(node.slice, ast.Slice) else script.type_of(node.slice)
    step = node.slice.step if isinstance(node.slice, ast.Slice) else None
    match kind:
        case Module() | Operator():
            return f"`{kind.path}` is not a collection: its members are attributes."
        case Plain(kind="int" | "float" | "bool") if node.value in script.analysis.resolutions:
            return f"{_subject(script, node)} is one {kind.kind}: it has no items."
        case Collection():
            return _of_changed(node, kind, key) or _of_collection(script, kind, key, step)
        case Instance() if kind.sure:
            return _of_instance(script, node, kind, key, step)
        case Sequence(kind="list") if (
            _is_text(key) and script.analysis.resolutions.get(node.value) is not None
        ):
            return f"{_subject(script, node)} is a list: its items are found by index, not by name."
        case _:
            return ""


def _of_result(script: Script, node: ast.Subscript) -> str:
    """What is wrong with a key of what an operator of bmesh gives."""
    call = node.value
    if isinstance(call, ast.Name):
        values = bindings(script).get(call.id, [])
        call = (
            values[0]
            if len(values) == 1 and values[0] is not None and call.id not in _filled(script)
            else call
        )
    path = callee_path(script, call) if isinstance(call, ast.Call) else ""
    symbol = (
        script.api.symbols.symbol(path)
        if path.startswith(_BMESH) and isinstance(node.ctx, ast.Load)
        else None
    )
    names = [result.name for result in symbol.returns] if symbol else []
    key = node.slice.value if isinstance(node.slice, ast.Constant) else None
    if not names or not isinstance(key, str) or key in names or is_tried(script, node, LACKS_KEY):
        return ""
    advice = ""
    if cls := _PARTS.get(key) if "geom" in names else None:
        advice = (
            f" Choose from its `geom`: `[e for e in result['geom'] if isinstance(e, bmesh.types.{cls})]`."
        )
    return f"`{path}` gives {', '.join(f'`{name}`' for name in names)}, and no {key!r}.{advice}"


@once_per_script
def _filled(script: Script) -> frozenset[str]:
    """The names of dictionaries that the script may give keys of its own."""
    owners = [node.value for node in script.all(ast.Subscript) if isinstance(node.ctx, ast.Store)]
    owners += [node.value for node in script.all(ast.Attribute) if node.attr in _FILLING]
    return frozenset(owner.id for owner in owners if isinstance(owner, ast.Name))


def _of_changed(node: ast.Subscript, kind: Collection, key: Type | None) -> str:
    """What is wrong with assigning to an item of a collection, or with deleting it."""
    path = kind.path or kind.container
    if isinstance(node.ctx, ast.Del):
        return f"Items of `{path}` are not deleted with `del`: call what the collection has for it, `remove` or `pop`."
    if isinstance(node.ctx, ast.Store) and _is_text(key):
        return f"Items of `{path}` are assigned to by index, not by name."
    is_item = isinstance(node.ctx, ast.Store) and not isinstance(node.slice, ast.Slice)
    if is_item and isinstance(kind.element, Instance) and kind.container not in _ASSIGNED:
        return f"Items of `{path}` are not assigned to: set a property of one, as `item.name = value`."
    return ""


def _of_collection(script: Script, kind: Collection, key: Type | None, step: ast.expr | None) -> str:
    path = kind.path or kind.container
    if step is not None and kind.container != GROUPS:
        return f"A slice of `{path}` takes no step: slice the list that `[:]` makes of it."
    # A parameter that is called ``mat`` may hold the name of a material: such a guess is no key that is refused.
    if (
        isinstance(key, NoneValue)
        or (isinstance(key, Instance) and key.sure)
        or (isinstance(key, Plain) and key.kind == "float")
    ):
        return f"`{path}` is asked by index or by name, not by {_described(key)}."
    element = kind.element
    if (
        _is_text(key)
        and isinstance(element, Instance)
        and kind.container != GROUPS
        and _is_nameless(script, element)
    ):
        return f"The items of `{path}` have no names: they are found by index."
    side = path.rpartition(".")[2]
    if side in SIDES and isinstance(kind.owner, Instance) and kind.owner.sure:
        return _beyond_sockets(script, kind.owner, side, key)
    return ""


def _beyond_sockets(script: Script, owner: Instance, side: str, key: Type | None) -> str:
    index = key.value if isinstance(key, Plain) and key.kind == "int" else None
    count = len(list(script.api.sockets(owner.cls, side)))
    fixed = owner.cls.rpartition("Node")[2] not in NODES_WITH_SOCKETS_OF_THEIR_OWN
    if not isinstance(index, int) or not count or not fixed or -count <= index < count:
        return ""
    return f"`{owner.cls}` has {count} {side}: there is no `{side}[{index}]`."


def _is_nameless(script: Script, element: Instance) -> bool:
    api = script.api
    if not api.is_class(element.cls) or not element.cls.startswith(T) or api.member(element.cls, "name"):
        return False
    if api.below(element.cls, "name"):
        return False
    named = (
        NAMES_ITEMS in symbol.flags
        for cls in (*api.lineage(element.cls), *api.descendants(element.cls))
        for symbol in api.symbols.members(cls)
    )
    return not any(named) and not api.descends(element.cls, f"{T}PropertyGroup")


def _of_instance(  # noqa: PLR0911 - one return a class
    script: Script, node: ast.Subscript, kind: Instance, key: Type | None, step: ast.expr | None
) -> str:
    cls = kind.cls
    if cls in _VECTORS or cls in _NO_STEPS or cls == ARRAY:
        if step is not None:
            return f"A slice of {_subject(script, node)} takes no step."
        if (
            _is_text(key)
            or isinstance(key, (NoneValue, Tuple))
            or (isinstance(key, Plain) and key.kind == "float")
        ):
            return f"The items of {_subject(script, node)} are found by index, not by {_described(key)}."
        index = number(script, node.slice)
        length = _length(script, node, cls)
        if isinstance(index, int) and length and not -length <= index < length:
            return f"{_subject(script, node)} has {length} items: there is no item {index}."
        return ""
    if cls.startswith(_ELEMENT):
        return _of_layer(script, node, cls, key)
    if not cls.startswith(T) or cls.startswith(f"{T}bpy_") or not script.api.is_class(cls):
        return ""
    if _is_open(script, cls):
        return ""
    if isinstance(node.slice, ast.Slice) or isinstance(key, NoneValue) or (
        isinstance(key, Plain) and key.kind in {"int", "float", "bool"}
    ):  # fmt: skip
        return f"Brackets on an instance of `{cls}` mean its custom properties, which have names."
    if cls in _NO_CUSTOM_PROPERTIES and _is_text(key):
        return f"An instance of `{cls}` has no custom properties: its members are attributes."
    return ""


def _of_layer(script: Script, node: ast.Subscript, cls: str, key: Type | None) -> str:
    """What is wrong with asking an element of a BMesh for its value in a layer: it is one of other elements."""
    layer = without_none(key or UNKNOWN)
    of = (
        layer.trait(LAYERS_OF)
        if isinstance(layer, Instance) and layer.cls == LAYER_ITEM and layer.sure
        else None
    )
    name = of.cls.removeprefix(LAYER_ACCESS) if isinstance(of, Instance) else ""
    element = cls.removeprefix(_ELEMENT)
    if not name or element not in _ELEMENTS or name == element:
        return ""
    many = f"{name.lower()}s"
    names = (many, f"link_{many}", name.lower())
    own = next((own for own in names if script.api.member(cls, own)), "")
    advice = f" Ask its `{own}`." if own else ""
    return f"`{ast.unparse(node.slice)}` is a layer of {many}: `{cls}` has no value in it.{advice}"


def _is_open(script: Script, cls: str) -> bool:
    """Whether a value that is declared so may be a collection."""
    return cls in {STRUCT, f"{T}AnyType"} or not _OF_COLLECTIONS.isdisjoint(script.api.own(cls))


def _length(script: Script, node: ast.Subscript, cls: str) -> int:
    """How many items a vector or an array has; 0 if that is not known."""
    if cls in LENGTHS:
        return LENGTHS[cls]
    row = script.analysis.resolutions.get(node.value)
    symbol = script.api.symbols.symbol(row.symbols[0]) if row is not None and len(row.symbols) == 1 else None
    if symbol is None or symbol.path in CHANGING_ARRAYS or cls == "mathutils.Matrix":
        return 0
    return symbol.array[0] if symbol.array else 0


def _is_text(key: Type | None) -> bool:
    return isinstance(key, Plain) and key.kind == "str"


def _described(key: Type | None) -> str:
    match key:
        case Plain(kind="str"):
            return "name"
        case Plain():
            return f"a {key.kind}"
        case Instance():
            return f"an instance of `{key.cls}`"
        case Tuple():
            return "several at once"
        case _:
            return "None"


def _subject(script: Script, node: ast.Subscript) -> str:
    row = script.analysis.resolutions.get(node.value)
    return f"`{row.symbols[0]}`" if row is not None and row.symbols else f"`{ast.unparse(node.value)[:60]}`"


def _fix(script: Script, node: ast.Subscript) -> Fix | None:
    """``collection[::2]`` → ``collection[:][::2]``."""
    kind = script.type_of(node.value)
    if isinstance(kind, Collection) and isinstance(node.slice, ast.Slice) and isinstance(node.ctx, ast.Load):
        return Fix("Make a list of it first", (Edit.behind(script.span(node.value), "[:]"),), sure=True)
    return None


RULE = Rule("not-subscriptable", "error", "Items of what cannot be asked for them so", _check)
