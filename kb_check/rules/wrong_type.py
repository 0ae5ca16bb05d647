"""A value of a type that a property or a parameter does not take.

Blender refuses it with a TypeError, or with a ValueError for a sequence of the wrong length. It makes floats of ints
and takes any sequence of numbers for a vector; it takes no float for an int, no number for a name and no text for a
pointer, and a colour has as many parts as its property says.

```python
scene.frame_end = 250.0  # reported
scene.frame_start, scene.frame_end = action.frame_range  # reported: floats
scene.render.resolution_x /= 2  # reported: a float
range(ob.location.x)  # reported: a float
json.dumps({"place": ob.location})  # reported: list(ob.location)
material.diffuse_color = (1, 0, 0)  # reported: 4 floats
scene.camera = bpy.data.cameras.new("Camera")  # reported: an Object that has it
scene.render.filepath = pathlib.Path("/tmp/x.png")  # reported: str(…)
bm.from_mesh(ob)  # reported: ob.data
ob.matrix_world = Matrix.Rotation(1, 3, "Z")  # reported: 4 × 4 floats
bmesh.ops.translate(bm, vec=(0, 0, 1), verts=faces)  # reported: vertices
variable.targets[0].id = scene  # reported: variable.targets[0].id_type = "SCENE" comes first
loop[uv_layer] = (0, 0)  # reported: loop[uv_layer].uv = (0, 0)
image.pixels.foreach_set(np.ones(count))  # reported: np.ones(count, dtype=np.float32)
mesh.polygons.foreach_set("use_smooth", np.ones(count))  # reported: np.ones(count, dtype=bool)
ob["tags"] = {"red", "blue"}  # reported: a list, or a text
mix = tree.nodes.new("ShaderNodeMix")
mix.inputs["A"].default_value = (1, 0, 0, 1)  # reported: mix.data_type = "RGBA" comes first
```

So are the attributes of classes, which it reads when they are registered:

```python
class Grow(bpy.types.Operator):
    bl_label = "Grow"
    bl_options = "REGISTER"  # reported: {"REGISTER"}
```

A warning: a parameter that nothing but its annotation says is of the wrong type. Not reported: values whose type is not
sure, and what may be None only at times.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Collection, Instance, Plain
from kb_build.symbols.api_names import GROUPS, ID, NODE, OBJECT, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA
from kb_build.symbols.paths import last_name
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import nothing_from, other_way
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.registered.properties import given_to_own
from kb_check.rule import Rule
from kb_check.running.out_of_sight import knows_all
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import is_new
from kb_check.syntax.annotated import ONE_IS_WRONG, annotated
from kb_check.syntax.bindings import once_bound
from kb_check.syntax.literals import items, set_of
from kb_check.syntax.words import named_words
from kb_check.text.brackets import bracketed
from kb_check.values.buffers import float_buffer, wide_buffer
from kb_check.values.computed import computed_misfits
from kb_check.values.conversions import misfit
from kb_check.values.custom_values import refused_value
from kb_check.values.documented import layer_misfit
from kb_check.values.for_python import floats_for_ints, not_for_json
from kb_check.values.given import assigned, class_values, given_values
from kb_check.values.mathutils_sizes import MATRIX
from kb_check.values.misfits import describe
from kb_check.values.python_paths import is_path
from kb_serve.recognise.likely.likely_values import item_called

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script
    from kb_check.values.given import Given, Taker
    from kb_check.values.misfits import Misfit

_COLORS = frozenset({"COLOR", "COLOR_GAMMA"})
# Since 5.0 GreasePencilv3 has the older name.
_DATA = tuple(f"{T}{name}" for name in (*OBJECT_DATA.values(), "GreasePencil"))
_LAYER = "bmesh.types.BMLayerItem"
# How what layers hold as something with members is filled.
_HELD = {
    "bmesh.types.BMLoopUV": "loop[layer].uv = (u, v)", "bmesh.types.BMDeformVert": "vert[layer][group_index] = weight",
}  # fmt: skip
_WHOLE = " Make it whole first: `int(…)`, `round(…)`, or `//` in place of `/`."
_KEPT = (
    "keeps a number, a text, bytes, a data-block, a list of one of these kinds, or a dictionary; anything else as a "
    "text, as `json.dumps(…)` makes it"
)
_LONGEST_INT = 2**31
_RGB = 3  # numbers of a colour without alpha
_TRANSFORM = (4, 4)
_KEYED_PATH = f"{STRUCT}.keyframe_insert(data_path)"
_TARGET_ID = f"{T}DriverTarget.id"


def _check(script: Script) -> Iterator[Finding]:
    for given in (*given_values(script), *class_values(script), *given_to_own(script)):
        if all(taker.kind == "string" for taker in given.takers) and is_path(script, given.node):
            yield _path_given(script, given)
            continue
        if isinstance(given.node, ast.Call) and (function := nothing_from(script, given.node)):
            yield from _nothing_given(script, given, function)
            continue
        found = [misfit(script, taker, given.node) for taker in given.takers]
        if not found or not all(found):
            continue
        wrong, taker = found[0], given.takers[0]
        assert wrong is not None
        advice = _advice(script, taker, wrong, given.node)
        kind = script.type_of(given.node)
        if isinstance(kind, Instance) and (said := annotated(script, given.node, kind.cls)):
            yield Finding(
                RULE.id, "warning", script.span(given.node),
                f"{said}, and `{taker.path}`{given.why} takes {wrong.takes}: {ONE_IS_WRONG}.{advice}", taker.path,
            )  # fmt: skip
            continue
        yield Finding(
            RULE.id, "error", script.span(given.node),
            f"`{taker.path}`{given.why} takes {wrong.takes}, not {wrong.given}.{advice}",
            taker.path, (), _fix(script, taker, wrong, given.node) if len(given.takers) == 1 else None,
        )  # fmt: skip
    yield from _computed(script)
    yield from _items_given(script)
    yield from _other_ids(script)
    yield from _doubles(script)
    yield from _floats(script)


def _computed(script: Script) -> Iterator[Finding]:
    """What is computed for a property, as behind a tuple."""
    for found in computed_misfits(script):
        advice = _WHOLE if found.taker.kind == "int" else ""
        path, wrong = found.taker.path, found.wrong
        told = f"`{path}` takes {wrong.takes}, not {wrong.given}.{advice}"
        yield Finding(RULE.id, "error", script.span(found.node), told, path)
    for node, wanting in floats_for_ints(script):
        told = f"{wanting} an int, not a float.{_WHOLE}"
        yield Finding(RULE.id, "error", script.span(node), told)
    for node, cls in not_for_json(script):
        told = f"JSON keeps no instance of `{cls}`: give numbers, texts or lists, as `list(ob.location)`, `ob.name`."
        yield Finding(RULE.id, "error", script.span(node), told, cls)


def _doubles(script: Script) -> Iterator[Finding]:
    """Buffers of 64 bits a number for arrays of 32."""
    for call in script.all(ast.Call):
        buffer = wide_buffer(script, call)
        if buffer is None or is_tried(script, call):
            continue
        path = callee_path(script, call)
        is_plain = len(buffer.args) == 1 and not buffer.keywords and "random" not in ast.unparse(buffer.func)
        numpy = ast.unparse(buffer.func).partition(".")[0]
        fix = (
            Fix("Make them floats of 32 bits", (_typed(script, buffer, f"{numpy}.float32"),))
            if is_plain
            else None
        )
        yield Finding(
            RULE.id, "error", script.span(call.args[0]),
            f"`{path}` takes floats of 32 bits, and numpy makes these of 64: `dtype={numpy}.float32`, or "
            f"`.astype({numpy}.float32)`.",
            path, (), fix,
        )  # fmt: skip


def _floats(script: Script) -> Iterator[Finding]:
    """Buffers of floats for properties of ints or truth values."""
    for call in script.all(ast.Call):
        floats = float_buffer(script, call)
        if floats is None or is_tried(script, call, ("TypeError",)):
            continue
        buffer, given = floats.buffer, call.args[1]
        fix: Fix | None = None
        told = f"`{floats.path}` takes no floats from a buffer"
        if isinstance(buffer, ast.Call):
            told += f": `dtype={floats.dtype}`, or `.astype({floats.dtype})`"
            if len(buffer.args) == 1 and "random" not in ast.unparse(buffer.func):
                # Of a buffer that has a name, other uses may want floats.
                fix = Fix(
                    f"Make it {floats.dtype}", (_typed(script, buffer, floats.dtype),), sure=buffer is given
                )
        path = callee_path(script, call)
        yield Finding(RULE.id, "error", script.span(given), f"{told}.", path, fix=fix)


def _typed(script: Script, buffer: ast.Call, dtype: str) -> Edit:
    """The edit that has a call of numpy make numbers of a kind."""
    for keyword in buffer.keywords:
        if keyword.arg == "dtype":
            return Edit(script.span(keyword.value), dtype)
    return Edit.behind(script.span(buffer.args[-1]), f", dtype={dtype}")


def _nothing_given(script: Script, given: Given, function: str) -> Iterator[Finding]:
    """A call that returns nothing, given to what takes no None."""
    taker = given.takers[0]
    if taker.kind and not any(other.kind in {"", "pointer"} for other in given.takers):
        yield Finding(
            RULE.id, "error", script.span(given.node),
            f"`{function}` returns nothing to give to `{taker.path}`.{other_way(script, function)}", taker.path,
        )  # fmt: skip


def _path_given(script: Script, given: Given) -> Finding:
    path, span = given.takers[0].path, script.span(given.node)
    edits = (Edit.before(span, "str("), Edit.behind(span, ")"))
    return Finding(
        RULE.id, "error", span, f"`{path}` takes a str, not a path of `pathlib`.", path, (),
        Fix("Write str(…)", edits, sure=True),
    )  # fmt: skip


def _items_given(script: Script) -> Iterator[Finding]:
    """What is assigned to items of collections, which hold structures or nothing."""
    for node in script.all(ast.Assign):
        if len(node.targets) != 1:
            continue
        target = node.targets[0]
        if not isinstance(target, ast.Subscript) or isinstance(target.slice, ast.Slice):
            continue
        if (wrong := layer_misfit(script, target, node.value)) and not is_tried(script, target):
            told = f"This layer takes {wrong.takes}, not {wrong.given}.{_of_layer(script, wrong)}"
            yield Finding(RULE.id, "error", script.span(node.value), told, _LAYER)
            continue
        if (refused := refused_value(script, target, node.value)) and not is_tried(script, target):
            told = f"A custom property takes no {refused.removeprefix('a ').removeprefix('an ')}: it {_KEPT}."
            yield Finding(RULE.id, "error", script.span(node.value), told, STRUCT)
            continue
        owner, kind = script.type_of(target.value), script.type_of(node.value)
        row = script.analysis.resolutions.get(target.value)
        certain = row is None or (row.sure and not row.guarded and not row.possible)
        if (
            isinstance(owner, Collection)
            and owner.container != GROUPS
            and isinstance(kind, Plain)
            and certain
        ):
            path = owner.path or owner.container
            yield Finding(
                RULE.id, "error", script.span(node.value),
                f"An item of `{path}` takes an instance of `{_element(owner)}` or None, not {describe(kind)}.", path,
            )  # fmt: skip


def _of_layer(script: Script, wrong: Misfit) -> str:
    """What to set instead of a value that a layer holds as something with members: ``.uv`` of a BMLoopUV."""
    cls = next((cls for cls in _HELD if f"`{cls}`" in wrong.takes), "")
    return f" Set its members: `{_HELD[cls]}`." if cls and script.api.is_class(cls) else ""


def _element(owner: Collection) -> str:
    return owner.element.cls if isinstance(owner.element, Instance) else STRUCT


def _advice(script: Script, taker: Taker, wrong: Misfit, node: ast.expr) -> str:
    """What may be meant by what stands in the place of something else."""
    if taker.subtype in _COLORS and (wrong.length, taker.sizes) == (_RGB, (_RGB + 1,)):
        is_short = isinstance(node, (ast.Name, ast.Attribute, ast.Call, ast.Subscript))
        return f" With alpha: `(*{ast.unparse(node)}, 1.0)`." if is_short else ""
    if (taker.kind, wrong.given) == ("int", "a float"):
        return _WHOLE
    if taker.path == _KEYED_PATH and isinstance(node, ast.Attribute):
        return f" Give the name: `{node.attr!r}`."
    if taker.sizes == _TRANSFORM and script.class_of(node) == MATRIX:
        return " `.to_4x4()` makes one of it."
    kind = script.type_of(node)
    return _of_another_class(script, taker, kind) if isinstance(kind, Instance) else ""


def _of_another_class(script: Script, taker: Taker, kind: Instance) -> str:
    """What may be meant where an object's data, or a node, stand in the place of the object or of a socket."""
    is_data = kind.cls == ID or any(script.api.descends(kind.cls, cls) for cls in _DATA)
    if taker.target == OBJECT and is_data:
        return " Give the object that has it: `bpy.data.objects.new(name, data)` makes one."
    if kind.cls == OBJECT and (taker.target or taker.documented) in _DATA:
        return " Give its data: `.data`."
    if taker.target == f"{T}NodeSocket" and script.api.descends(kind.cls, NODE):
        return " Give one of its sockets: `node.outputs[...]`, `node.inputs[...]`."
    return ""


def _fix(script: Script, taker: Taker, wrong: Misfit, node: ast.expr) -> Fix | None:
    """The edit that leaves no doubt: a whole number without its point, a colour with or without alpha, a set of one."""
    if isinstance(node, ast.Constant):
        return _literal_fix(script, taker, node)
    parts = items(script, node)
    if parts is None or not isinstance(node, (ast.Tuple, ast.List)):
        return None
    if taker.kind == "boolean" and not wrong.length:
        bits = [part for part in parts if isinstance(part, ast.Constant) and part.value in {0, 1}]
        edits = tuple(Edit(script.span(part), str(bool(part.value))) for part in bits)
        return Fix("Write truth values", edits, sure=True) if len(bits) == len(parts) else None
    return _color_fix(script, taker, wrong, parts) if taker.subtype in _COLORS else None


def _literal_fix(script: Script, taker: Taker, node: ast.Constant) -> Fix | None:
    span, value = script.span(node), node.value
    if taker.kind == "int" and isinstance(value, float) and value.is_integer() and abs(value) < _LONGEST_INT:
        return Fix("Write an int", (Edit(span, str(int(value))),), sure=True)
    if taker.kind == "set" and isinstance(value, str):
        return set_of(script, node)
    return None


def _color_fix(script: Script, taker: Taker, wrong: Misfit, parts: list[ast.expr]) -> Fix | None:
    if not all(_is_number(script, part) for part in parts):
        return None
    if len(parts) < _RGB:
        return None
    before = bracketed(script, parts[2], parts[1])
    if (wrong.length, taker.sizes) == (3, (4,)):
        return Fix("Add alpha", (Edit.behind(before, ", 1.0"),), sure=True)
    if (wrong.length, taker.sizes) == (4, (3,)):
        last = bracketed(script, parts[3], parts[2])
        cut = Span(before.end_line, before.end_column, last.end_line, last.end_column)
        return Fix("Leave out alpha", (Edit(cut, ""),), sure=True)
    return None


def _is_number(script: Script, node: ast.expr) -> bool:
    kind = script.type_of(node)
    return isinstance(kind, Plain) and kind.kind in {"int", "float"}


def _other_ids(script: Script) -> Iterator[Finding]:
    """What is no object, given to the target of a new driver's variable, whose ``id_type`` nothing sets."""
    if "id_type" in named_words(script) or not knows_all(script):
        return
    for row in script.resolutions("store"):
        if row.symbols != (_TARGET_ID,) or not row.sure or not isinstance(row.node, ast.Attribute):
            continue
        value = assigned(row.statement, row.node)
        cls = script.class_of(value) if value else ""
        match once_bound(script, row.node.value):
            case ast.Subscript(value=ast.Attribute(value=variable)) if is_new(script, variable):
                is_other = script.api.descends(cls, ID) and cls not in {ID, OBJECT}
            case _:
                continue
        if is_other and value and not is_tried(script, row.node):
            kinds = script.api.symbols.symbol(f"{_TARGET_ID}_type")
            choice = item_called(kinds, map(last_name, script.api.lineage(cls)))
            first = f": `id_type = {choice!r}` comes first" if choice else ""
            yield Finding(
                RULE.id, "error", script.span(value),
                f"`{_TARGET_ID}` takes an instance of `{OBJECT}` while `id_type` is 'OBJECT', as it is on what is new,"
                f" not one of `{cls}`{first}.", _TARGET_ID,
            )  # fmt: skip


RULE = Rule("wrong-type", "error", "A value of a type that is not taken", _check)
