"""A call that Blender refuses although its arguments are those that the signature asks for.

What is refused was tried: without arguments that may be left out and are wanted all the same, by what is of another
kind, a second time. So are calls of what is not a function.

```python
strips = scene.sequence_editor.strips
strips.new_effect("Sky", "COLOR", channel=1, frame_start=1)  # reported: without `length`
spline = curve.splines.new("BEZIER")
spline.points.add(3)  # reported: a Bézier spline has `bezier_points`
mesh.attributes.new("weight", "FLOAT", "CURVE")  # reported: meshes have no such domain
vector.length()  # reported: a property
gpu.types.GPUShader(
    vertex, fragment
)  # reported since 5.0: functions make it, such as `gpu.shader.create_from_info`
bpy.utils.register_class(Grow())  # reported: Blender makes the instances of its classes, and takes Grow
bpy.data.meshes.remove(ob.to_mesh())  # reported: ob.to_mesh_clear()
repeat_input.pair_with_output(simulation_output)  # reported: of another zone
tree.links.new(noise.outputs["Color"], wave.outputs["Color"])  # reported: two outputs
```

What returns None instead of raising an error is a warning. Not reported: what depends on the mode (see
not-in-edit-mode), and what crashes Blender (see crash).
"""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, ClassObject, Instance, LocalClass, members
from kb_build.symbols.api_names import NODE, STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import PAIRS
from kb_build.symbols.lines import with_article
from kb_build.symbols.paths import last_name
from kb_check.calls.repeated import follows
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import CallSite, calls
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.registered.classes import own_classes, plain_classes
from kb_check.registered.order import registrations
from kb_check.rule import Rule
from kb_check.running.tried import is_tried
from kb_check.scene.made_here import LINKS_NEW, makers
from kb_check.scene.refusing_kind import refusing_kind
from kb_check.scene.removed import OUTSIDE_MAIN
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings, once_bound
from kb_check.syntax.literals import number

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Refusal
    from kb_check.script import Script

_WITH_PROPERTIES = (T, "mathutils.", "bmesh.types.")
_VALUES = frozenset({"property", "context"})  # kinds of what is read, not called
# Modules whose classes are written in C and have a signature if, and only if, they can be called.
_SIGNED = frozenset({"bmesh.types", "gpu.types", "idprop.types", "imbuf.types"})
_REGISTERING = frozenset({"bpy.utils.register_class", "bpy.utils.unregister_class"})
_NOT_AFTER = {"any": "a second time", "other": "after another", "same": "a second time"}
_FIRST_OF_ZONE, _SECOND_OF_ZONE = "Input", "Output"
_REMOVES_DATA = re.compile(r"bpy\.types\.BlendData\w+\.remove")


def _check(script: Script) -> Iterator[Finding]:
    yield from _called_properties(script)
    yield from _called_classes(script)
    yield from _called_structs(script)
    yield from _plain_registered(script)
    unknown = {row.node for row in script.missing("keyword")}
    earlier: dict[tuple[str, str, str], CallSite] = {}
    for call in calls(script):
        yield from _removing_of_object(script, call)
        yield from _mispaired(script, call)
        yield from _of_one_side(script, call)
        refusals = call.callee.symbol.refusals
        if not refusals or call.has_unpacking or not isinstance(call.node.func, ast.Attribute):
            continue
        owner = call.node.func.value
        for refusal in refusals:
            key = (ast.unparse(owner), *_key(refusal, call))
            before = earlier.setdefault(key, call) if refusal.again else call
            if not _is_of(script, refusal, call) or (
                not refusal.given and not refusal.by and _gives_more(call)
            ):
                continue
            if refusal.given and not unknown.isdisjoint(call.node.keywords):  # one of those may stand for it
                continue
            if refusal.again:
                why = _NOT_AFTER.get(refusal.again, "")
                if why and before is not call and follows(script, before.node, call.node, owner):
                    yield _finding(script, call, refusal, why)
            elif refusal.given:
                if lacking := [name for name in refusal.given if name not in call.given]:
                    names = " and ".join(f"`{name}`" for name in lacking)
                    yield _finding(script, call, refusal, f"without {names}")
            elif refusal.by:
                if kind := refusing_kind(script, owner, refusal):
                    word = "to" if refusal.values else "by"
                    yield _finding(script, call, refusal, f"{word} {with_article(kind)}")
            elif refusal.values and refusal.message:
                yield _finding(script, call, refusal, "")


def _called_classes(script: Script) -> Iterator[Finding]:
    """Calls of classes of which only functions make instances."""
    for node in script.all(ast.Call):
        kind = script.type_of(node.func)
        if not isinstance(kind, ClassObject) or kind.cls.rpartition(".")[0] not in _SIGNED:
            continue
        row, symbol = script.analysis.resolutions.get(node.func), script.api.symbols.symbol(kind.cls)
        is_guarded = (row is not None and (row.guarded or not row.sure)) or is_tried(script, node)
        if symbol is not None and symbol.kind == "class" and not symbol.signature and not is_guarded:
            yield Finding(
                RULE.id, "error", script.span(node),
                f"`{kind.cls}` cannot be called: Blender says “cannot create '{last_name(kind.cls)}' instances”. "
                f"Functions of `{kind.cls.partition('.')[0]}` make them.",
                kind.cls,
            )  # fmt: skip


def _called_structs(script: Script) -> Iterator[Finding]:
    """Calls of classes of data, and of those that a script derives from them: they take an instance, and nothing else.

    Blender makes the instances of those that it registers.
    """
    for node in script.all(ast.Call):
        path = _struct_called(script, node.func)
        if not path:
            continue
        row = script.analysis.resolutions.get(node.func)
        is_open = any(isinstance(given, ast.Starred) for given in node.args) or any(
            keyword.arg is None for keyword in node.keywords
        )
        is_copied = len(node.args) == 1 and not node.keywords and not isinstance(node.args[0], ast.Constant)
        if (
            is_open
            or is_copied
            or (row is not None and (row.guarded or not row.sure))
            or is_tried(script, node)
        ):
            continue
        is_registered = node in _registered(script)
        advice = " Give the class itself." if is_registered else ""
        yield Finding(
            RULE.id, "error", script.span(node),
            f"`{ast.unparse(node.func)}` cannot be called: Blender makes the instances of a `{path}`.{advice}",
            path, (), _uncalled(script, node, "Give the class") if is_registered else None,
        )  # fmt: skip


def _plain_registered(script: Script) -> Iterator[Finding]:
    """Classes that are registered, and derive from none of Blender's."""
    for name in sorted(plain_classes(script) & registrations(script).keys()):
        for one in registrations(script)[name]:
            if not is_tried(script, one.node):
                told = f"`{name}` derives from no class of Blender's, as an Operator does: it cannot be registered."
                yield Finding(RULE.id, "error", script.span(one.node), told, "bpy.utils.register_class")


def _struct_called(script: Script, node: ast.expr) -> str:
    """The class of Blender's data that an expression surely is, or derives from; empty for none."""
    paths: list[str] = []
    for kind in members(script.type_of(node) or UNKNOWN):
        if isinstance(kind, ClassObject) and script.api.descends(kind.cls, STRUCT):
            paths.append(kind.cls)
        elif isinstance(kind, LocalClass):
            paths.append(_derived(script).get(script.analysis.classes[kind.number], ""))
        else:
            paths.append("")
    return paths[0] if all(paths) else ""


@once_per_script
def _derived(script: Script) -> dict[ast.ClassDef, str]:
    """Each class of the script that Blender makes the instances of → what it derives from."""
    return {own.node: own.path for own in own_classes(script) if own.lacks("__new__")}


@once_per_script
def _registered(script: Script) -> frozenset[ast.expr]:
    """What is given to be registered or no longer registered."""
    return frozenset(
        node
        for call in calls(script)
        if call.callee.symbol.path in _REGISTERING
        for _, node in call.arguments()
    )


def _removing_of_object(script: Script, call: CallSite) -> Iterator[Finding]:
    """Data that an object makes for itself, and that the script removes from Blender's."""
    path = call.callee.symbol.path
    given = call.node.args[0] if _REMOVES_DATA.fullmatch(path) and call.node.args else None
    match given:
        case ast.Name(id=name):
            made, made_by = bindings(script).get(name, []), makers(script, name)
        case ast.Call():
            made, made_by = [given], frozenset({callee_path(script, given)})
        case _:
            return
    maker = next(iter(made_by)) if len(made_by) == 1 else ""
    clearing = OUTSIDE_MAIN.get(maker, "")
    if not clearing or script.api.symbols.symbol(clearing) is None or is_tried(script, call.node):
        return
    match made:
        case [ast.Call(func=ast.Attribute(value=owner))]:
            pass
        case _:
            owner = None
    is_fixed = isinstance(owner, ast.Name) and len(bindings(script).get(owner.id, ())) == 1
    clear = last_name(clearing)
    edit = Edit(script.span(call.node), f"{ast.unparse(owner)}.{clear}()") if owner and is_fixed else None
    yield Finding(
        RULE.id, "error", script.span(call.node),
        f"What `{maker}` returns belongs to its object and is not in `bpy.data`: `{path}` refuses it. "
        f"`{clearing}` removes it.",
        path, (clearing,), Fix(f"Write {clear}", (edit,)) if edit else None,
    )  # fmt: skip


def _mispaired(script: Script, call: CallSite) -> Iterator[Finding]:
    """A zone's first node that is paired with what is not the second one of such a zone."""
    zone, _, function = call.callee.symbol.path.rpartition(".")
    output = f"{zone.removesuffix(_FIRST_OF_ZONE)}{_SECOND_OF_ZONE}"
    if function != PAIRS or not zone.endswith(_FIRST_OF_ZONE) or not script.api.is_class(output):
        return
    given = next((node for _, node in call.arguments()), None)
    kind = script.type_of(given) if given is not None else None
    if (
        isinstance(kind, Instance)
        and kind.sure
        and kind.cls != output
        and NODE in script.api.lineage(kind.cls)
        and not script.api.descends(output, kind.cls)
        and not is_tried(script, call.node)
    ):
        yield Finding(
            RULE.id, "error", script.span(call.node),
            f"`{call.callee.symbol.path}` takes a `{output}`, the other node of its zone, and no `{kind.cls}`.",
            call.callee.symbol.path, (output,),
        )  # fmt: skip


def _of_one_side(script: Script, call: CallSite) -> Iterator[Finding]:
    """A link of two outputs, or of two inputs."""
    if call.callee.symbol.path != LINKS_NEW:
        return
    sides = [_side(script, node) for name in ("input", "output") if (node := call.argument(name)) is not None]
    if sides in (["inputs"] * 2, ["outputs"] * 2) and not is_tried(script, call.node):
        yield Finding(
            RULE.id, "error", script.span(call.node),
            f"`{LINKS_NEW}` links an output to an input, in any order, and is given two {sides[0]}.", LINKS_NEW,
        )  # fmt: skip


def _side(script: Script, node: ast.expr) -> str:
    """Whether an expression is one of a node's ``inputs`` or of its ``outputs``; empty where that is not known."""
    match once_bound(script, node):
        case ast.Subscript(value=ast.Attribute(value=owner, attr="inputs" | "outputs" as side)):
            cls = script.class_of(owner)
            return side if cls and NODE in script.api.lineage(cls) else ""
        case _:
            return ""


def _called_properties(script: Script) -> Iterator[Finding]:
    """Calls of what is a value: Blender says that it is not callable."""
    for node in script.all(ast.Call):
        if not isinstance(node.func, ast.Attribute):
            continue
        row, owner = script.analysis.resolutions.get(node.func), script.type_of(node.func.value)
        certain = row is not None and row.sure and not (row.guarded or row.missing or row.possible)
        if row is None or not certain or len(row.symbols) != 1 or not isinstance(owner, Instance):
            continue
        symbol = script.api.symbols.symbol(row.symbols[0])
        if not symbol or symbol.kind not in _VALUES or not symbol.type:
            continue
        if symbol.owner.startswith(_WITH_PROPERTIES):
            yield Finding(
                RULE.id, "error", script.name_span(node.func),
                f"`{symbol.path}` is a property: it is read without `()`.", symbol.path, (), _uncalled(script, node),
            )  # fmt: skip


def _uncalled(script: Script, node: ast.Call, title: str = "Read it") -> Fix | None:
    if node.args or node.keywords:
        return None
    called, whole = script.span(node.func), script.span(node)
    behind = Span(called.end_line, called.end_column, whole.end_line, whole.end_column)
    return Fix(title, (Edit(behind, ""),), sure=True) if script.text(behind) == "()" else None


def _is_of(script: Script, refusal: Refusal, call: CallSite) -> bool:
    """Whether a call has one of the values that are refused, if only some are, or surely the same as another one."""
    if refusal.again == "same" and not _is_written_out(script, call):
        return False
    if not refusal.values:
        return True
    given = call.argument(refusal.argument)
    return isinstance(given, ast.Constant) and given.value in refusal.values


def _gives_more(call: CallSite) -> bool:
    """Whether a call has arguments that may be left out: with these it was not tried."""
    return not call.given <= {parameter.name for parameter in call.callee.parameters if parameter.required}


def _key(refusal: Refusal, call: CallSite) -> tuple[str, str]:
    """The function, and the value that is refused the second time, if only some are, and only after itself."""
    if refusal.again == "same":
        return call.callee.symbol.path, ", ".join(map(ast.unparse, (*call.node.args, *call.node.keywords)))
    given = call.argument(refusal.argument) if refusal.again != "other" else None
    return call.callee.symbol.path, ast.unparse(given) if given else ""


def _is_written_out(script: Script, call: CallSite) -> bool:
    """Whether all that a call is given are literals: the same texts are then the same values."""
    return all(
        isinstance(given, ast.Constant) or number(script, given) is not None for _, given in call.arguments()
    )


def _finding(script: Script, call: CallSite, refusal: Refusal, why: str) -> Finding:
    path = call.callee.symbol.path
    what = f" {refusal.argument}={_key(refusal, call)[1]}" if refusal.values else ""
    said = f"Blender says “{refusal.message}”" if refusal.message else "it returns None"
    how = " ".join(filter(None, (f"`{path}`", f"refuses{what}" if what else "is refused", why)))
    severity = "error" if refusal.message else "warning"
    return Finding(RULE.id, severity, script.span(call.node), f"{how}: {said}.", path)


RULE = Rule("refused-call", "error", "A call that is refused as things stand", _check)
