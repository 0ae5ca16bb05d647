"""An attribute that a class of Blender's does not have.

Reported where the type of what stands before the dot is known, and no class that it can be has the name: neither
Blender's own, nor what the files of the same folder register (``bpy.types.Scene.my_settings = …``). Names in
``keyframe_insert("…")``, ``layout.prop(…, "…")``, ``setattr(…, "…", …)`` and the like count too, and those that come to
them by a loop over what is written out.

```python
bpy.context.object.draw_type = "WIRE"  # reported: display_type since 2.80
bpy.context.object.display_type = "WIRE"
data_from.groups  # of bpy.data.libraries.load; reported: collections
light.energy.value = 100  # reported: a number is assigned as it is, `light.energy = 100`
mesh.vertices.add(1).co = (0, 0, 0)  # reported: the call returns nothing
```

So is what this Blender has nowhere and an earlier one had, of a value of which no more is known than what holds it
(``thing.data.use_auto_smooth``), or what it is called in a script that speaks of the class (``file_node.file_slots``,
``CompositorNodeOutputFile``), unless the script, or a file beside it, calls something of its own so.

A note, no error: what an add-on may register that the script enables and that nobody can look into here. A warning: an
object's member of a parameter, or of an element of one, that nothing but its annotation says is the object's data, and
what no class has of a parameter that nothing but its annotation says is Blender's.

Not reported: what stands behind ``hasattr``, in a ``try`` that catches AttributeError and goes on, or in a branch for
another version (``if bpy.app.version < (2, 80, 0)``).
"""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import UNKNOWN, Plain, Resolution, members
from kb_build.symbols.api_names import BLEND_DATA, CONTEXT, OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.object_data import OBJECT_DATA
from kb_build.symbols.records import SCALAR_TYPES
from kb_check.calls.resolved import callee_path, member_path
from kb_check.calls.sites import nothing_from, other_way
from kb_check.findings import Finding, Fix
from kb_check.names.former_members import former_members
from kb_check.names.lacking import data_class_that_had, lacking_finding
from kb_check.nodes.shown_sockets import socket_classes
from kb_check.rule import Rule
from kb_check.running.raised import LACKS
from kb_check.running.tried import is_tried
from kb_check.syntax.annotated import ONE_IS_WRONG, annotated
from kb_check.syntax.bindings import bindings
from kb_check.syntax.words import words_in_texts
from kb_serve.recognise.elsewhere.elements import Elsewhere, elsewhere
from kb_serve.recognise.elsewhere.holders import by_what_holds_it, of_collection
from kb_serve.recognise.elsewhere.meant_elsewhere import meant_elsewhere
from kb_serve.recognise.elsewhere.members_within import members_within

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.names.known import Lacking
    from kb_check.script import Script

_LOAD = f"{T}BlendDataLibraries.load"
_OF_OBJECTS = frozenset(OBJECT_DATA.values())
_LET_PASS = frozenset({"driver_remove"})
# Before, what is assigned to an unknown name of a property group is lost, and no error.
_OF_SCRIPTS, _REFUSED = "bpy.types.PropertyGroup", (5, 0)
_PYTHONS: dict[str, type] = {"bool": bool, "int": int, "float": float, "str": str}
_VALUE = "default_value"


def _check(script: Script) -> Iterator[Finding]:
    for row in script.missing("attribute", "store", "text", "button"):
        owner = _class_of(script, row.missing[0])
        lost = _is_lost(script, row, owner)
        if not owner.startswith("bpy.ops") and script.api.is_class(owner) and owner != CONTEXT:
            had = _owner_that_had(script, row, owner)
            lacking = script.names.member(had, row.value, reading=row.kind != "store")
            level = "warning" if lost or _is_let_pass(row) else "error"
            if not lacking.removed and _is_of_other(script, row, owner, lacking):
                level, lacking = "warning", _confused(script, row, owner, lacking)
            elif not lacking.removed and (others := _elsewhere(script, row, owner, lacking)):
                told = f"`{row.missing[0]}` has no `{row.value}`. {' '.join(other.how for other in others)}"
                instead = tuple(other.path for other in others)
                lacking = replace(lacking, message=told, instead=instead, replacement="")
            yield lacking_finding(script, RULE.id, row, lacking, level)
    yield from _of_unknown(script)
    yield from _of_python(script)
    yield from _of_libraries(script)
    yield from _of_sockets(script)


def _of_unknown(script: Script) -> Iterator[Finding]:
    """What this Blender has nowhere, of values that are known only by how they are held or called."""
    for node, owner in former_members(script):
        kind = "attribute" if isinstance(node.ctx, ast.Load) else "store"
        row = Resolution(node, kind, missing=(owner,), value=node.attr)
        lacking = script.names.member(owner, node.attr, reading=kind == "attribute")
        yield lacking_finding(
            script, RULE.id, row, lacking, "warning" if _is_lost(script, row, owner) else "error"
        )


def _is_lost(script: Script, row: Resolution, owner: str) -> bool:
    """Whether what is assigned is lost without an error."""
    return row.kind == "store" and script.version < _REFUSED and script.api.descends(owner, _OF_SCRIPTS)


def _elsewhere(script: Script, row: Resolution, owner: str, lacking: Lacking) -> list[Elsewhere]:
    """What does elsewhere what a thing or a collection is asked to do."""
    reader = script.names.reader
    if other := elsewhere(row.missing[0], row.value, reader):
        return [other]
    if lacking.replacement:
        return []
    if meant := meant_elsewhere(owner, row.value, reader):
        return [Elsewhere(meant.path, meant.how)]
    found: list[Elsewhere] = []
    if row.kind == "attribute":
        found = of_collection(row.missing[0], row.value, reader) or by_what_holds_it(owner, row.value, reader)
    return found or [
        Elsewhere(one.member.path, one.note)
        for one in members_within(owner, row.value, reader)
        if row.kind != "store" or not one.member.is_read_only
    ]


def _of_sockets(script: Script) -> Iterator[Finding]:
    """Values of sockets that have none, as settings of their node have it: those of geometry, say."""
    for node in script.all(ast.Attribute):
        if node.attr != _VALUE or script.analysis.resolutions.get(node) or is_tried(script, node, LACKS):
            continue
        found = socket_classes(script, node.value)
        if found is not None and not any(script.api.member(cls, _VALUE) for cls in found.classes):
            cls = found.classes[0]
            yield Finding(
                RULE.id, "error", script.name_span(node),
                f"`{cls}`, which this socket is{found.why}, has no `{_VALUE}`.", cls,
            )  # fmt: skip


def _is_of_other(script: Script, row: Resolution, owner: str, lacking: Lacking) -> bool:
    """Whether what is annotated as one thing is used as another: an object's data as the object, or anything as what
    the API knows nothing of. One of the two is wrong.
    """
    node = _owner_node(row)
    is_of_none = not lacking.replacement and script.names.is_nowhere(row.value)
    is_other = _is_of_object(script, row, owner) or is_of_none
    return node is not None and is_other and bool(annotated(script, node, owner))


def _is_of_object(script: Script, row: Resolution, owner: str) -> bool:
    """Whether an object's data lacks what the object has."""
    return owner.removeprefix(T) in _OF_OBJECTS and script.api.member(OBJECT, row.value) is not None


def _owner_node(row: Resolution) -> ast.expr | None:
    """What a member is asked of: by a dot, or by its name as the first argument of a function of it."""
    if isinstance(row.node, ast.Attribute):
        return row.node.value
    for node in walk(row.statement) if row.kind == "text" and row.statement else ():
        match node:
            case ast.Call(func=ast.Attribute(value=owner), args=[first, *_]) if first is row.node:
                return owner
            case _:
                pass
    return None


def _confused(script: Script, row: Resolution, owner: str, lacking: Lacking) -> Lacking:
    node = _owner_node(row)
    said = annotated(script, node, owner) if node is not None else ""
    message = f"{said}, which has no `{row.value}`"
    if not _is_of_object(script, row, owner):
        return replace(lacking, message=f"{message}, as nothing of Blender's has: {ONE_IS_WRONG}.")
    message += (
        f"; `{OBJECT}` has it: {ONE_IS_WRONG}. Annotate what is an object as `{OBJECT}`, or pass its `data` and"
        " use that."
    )
    return replace(lacking, message=message, instead=(f"{OBJECT}.{row.value}",))


def _of_libraries(script: Script) -> Iterator[Finding]:
    """Names that ``bpy.data`` has lost, of the two things that ``bpy.data.libraries.load`` gives."""
    given = [
        name for node in script.all(ast.With) for item in node.items for name in _library_names(script, item)
    ]
    names = {name for name in given if given.count(name) == len(bindings(script).get(name, ()))}
    for part in script.all(ast.Attribute) if names else ():
        if (
            isinstance(part.value, ast.Name)
            and part.value.id in names
            and script.names.had(BLEND_DATA, part.attr)
        ):
            if (
                script.type_of(part.value) is None
                or part.attr in words_in_texts(script)
                or is_tried(script, part, LACKS)
            ):
                continue
            lacking = script.names.member(BLEND_DATA, part.attr)
            owner, _, name = lacking.replacement.rpartition(".")
            edit = script.renamed(part, name) if owner == BLEND_DATA else None
            is_read = isinstance(part.ctx, ast.Load)
            lost = "" if is_read else " Nothing is loaded of what is assigned to it."
            yield Finding(
                RULE.id, "error" if is_read else "warning", script.name_span(part),
                f"Libraries list what `bpy.data` has: {lacking.message}{lost}", lacking.symbol, lacking.instead,
                Fix(f"Write {name}", (edit,), sure=lacking.sure) if edit else None,
            )  # fmt: skip


def _library_names(script: Script, item: ast.withitem) -> list[str]:
    match item:
        case ast.withitem(context_expr=ast.Call() as call, optional_vars=ast.Tuple(elts=parts)) if (
            callee_path(script, call) == _LOAD
        ):
            return [part.id for part in parts if isinstance(part, ast.Name)]
        case _:
            return []


def _of_python(script: Script) -> Iterator[Finding]:
    """Attributes of one number, truth value or text, or of None."""
    for node in script.all(ast.Attribute):
        if function := nothing_from(script, node.value):
            path, told = (
                function,
                f"`{function}` returns nothing: there is no `{node.attr}`.{other_way(script, function)}",
            )
        else:
            path = member_path(script, node.value) if isinstance(node.value, ast.Attribute) else ""
            kind = _scalar(script, path, node)
            told = f"`{path}` is one {kind}: it has no `{node.attr}`." if kind else ""
        if told and not is_tried(script, node, LACKS) and node.attr not in words_in_texts(script):
            yield Finding(RULE.id, "error", script.name_span(node), told, path)


def _scalar(script: Script, path: str, node: ast.Attribute) -> str:
    """The one type of Python's that a property surely is of which lacks an attribute; empty for none."""
    symbol = script.api.symbols.symbol(path) if path else None
    if symbol is None or symbol.kind != "property" or symbol.type not in SCALAR_TYPES or symbol.array:
        return ""
    kinds = {
        kind.kind if isinstance(kind, Plain) else ""
        for kind in members(script.type_of(node.value) or UNKNOWN)
    }
    kind = kinds.pop()
    return "" if kinds or kind not in _PYTHONS or hasattr(_PYTHONS[kind], node.attr) else kind


def _is_let_pass(row: Resolution) -> bool:
    """Whether Blender does nothing, and raises no error: ``driver_remove`` of an unknown path returns False."""
    calls = (node for node in walk(row.statement or row.node) if isinstance(node, ast.Call))
    functions = (call.func for call in calls if row.kind == "text" and row.node in call.args)
    return any(isinstance(function, ast.Attribute) and function.attr in _LET_PASS for function in functions)


def _owner_that_had(script: Script, row: Resolution, owner: str) -> str:
    """Of several classes that lack a name, of those of objects' data, and of those below a class, the one that had it;
    or the owner.
    """
    if known := next((cls for cls in row.missing if script.names.had(cls, row.value)), ""):
        return known
    if known := data_class_that_had(script, row):
        return known
    below = [cls for cls in script.api.descendants(owner) if script.names.was(cls, row.value)]
    # What went from all of them at once was one thing: each kind of light had a contact shadow.
    spans = {script.names.reader.history.removed(f"{cls}.{row.value}") for cls in below}
    return below[0] if len(spans) == 1 else owner


def _class_of(script: Script, owner: str) -> str:
    """The class of a collection that is given by its property; any other owner as it is."""
    symbol = script.api.symbols.symbol(owner)
    if symbol is None or symbol.kind != "property" or symbol.type != "collection":
        return owner
    return f"bpy.types.{symbol.collection or 'bpy_prop_collection'}"


RULE = Rule("unknown-attribute", "error", "An attribute that the class does not have", _check)
