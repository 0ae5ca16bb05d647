"""An assignment to what cannot be assigned.

Blender refuses it with an AttributeError. What a read-only property leads to can often be changed all the same:
``ob.location[0] = 1``, ``mesh.vertices[0].co = (0, 0, 1)``.

```python
ob.type = "MESH"  # reported
ob.data.vertices = []  # reported: mesh.from_pydata(...)
bpy.context.object = ob  # reported: bpy.context.view_layer.objects.active = ob
cross = strips.new_effect("Cross", "CROSS", 3, 1, input1=first, input2=second)
cross.left_handle = 10  # reported: its inputs decide
mesh.vertices[0].normal.x = 1  # reported: parts of what is read-only are, too
mesh.texspace_size = (1, 1, 1)  # reported, unless the script names `use_auto_texspace`, which is on at first
```

Not reported: ``self.cancel = True`` in a class of the script's. Its instances take values in the place of functions.
"""

from __future__ import annotations

import ast
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.values.types import UNKNOWN, Instance, LocalInstance, members
from kb_build.symbols.api_names import HANDLERS, TYPES
from kb_build.symbols.flag_names import FREE_ON, READ_ONLY
from kb_build.symbols.flags import freed_by, is_locked
from kb_check.findings import Edit, Finding, Fix
from kb_check.names.lacking import data_class_that_had, lacking_finding
from kb_check.rule import Rule
from kb_check.running.raised import LACKS
from kb_check.scene.settings_before import set_before
from kb_check.syntax.bindings import alias
from kb_check.syntax.words import named_words
from kb_check.values.given import is_of_instance
from kb_serve.recognise.changed_by import changed_by

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_build.symbols.records import Symbol
    from kb_check.script import Script

# Members that cannot be assigned to, of classes whose reference does not say so: tried one by one on instances.
_REFUSED = {
    "mathutils.": frozenset({
        "col", "is_frozen", "is_identity", "is_negative", "is_orthogonal", "is_orthogonal_axis_vectors", "is_valid",
        "is_wrapped", "length_squared", "median_scale", "owner", "row",
    }),
    "bmesh.types.": frozenset({
        "edges", "faces", "is_boundary", "is_contiguous", "is_convex", "is_manifold", "is_singleton", "is_valid",
        "is_wire", "is_wrapped", "layers", "link_edges", "link_faces", "link_loop_next", "link_loop_prev",
        "link_loop_radial_next", "link_loop_radial_prev", "link_loops", "loops", "verts",
    }),
}  # fmt: skip
_LAYERS = "bmesh.types.BMLayerAccess"
_SWIZZLE = re.compile(r"[xyzw]{2,4}")


def _check(script: Script) -> Iterator[Finding]:
    for row in script.resolutions("store", "attribute"):
        if row.kind == "attribute" and not _is_deleted(row):
            continue
        paths = row.symbols or row.possible
        if not paths or not row.sure or row.is_ready_for(*LACKS) or (row.missing and not row.possible):
            continue
        symbols = [script.api.symbols.symbol(path) for path in paths]
        if row.kind == "store" and len(paths) == 1 and paths[0].startswith(HANDLERS):
            name = paths[0]
            told = f"`{name}` is read-only. Change the list itself: `append`, `remove`, `clear`."
            yield Finding(RULE.id, "error", script.name_span(row.node), told, name)
            continue
        if not is_of_instance(script, row.node):
            continue
        if row.kind == "store" and script.package.has(_owners(symbols), row.value):
            continue
        if row.kind == "store" and _is_hidden(script, row, symbols):
            continue
        if all(symbol is not None and _is_refused(row, symbol) for symbol in symbols):
            first = symbols[0]
            assert first is not None
            if not row.symbols and (lost := data_class_that_had(script, row)):
                lacking = script.names.member(lost, row.value)
                told = f"{lacking.message} `{first.path}` is read-only."
                yield lacking_finding(script, RULE.id, row, replace(lacking, message=told))
                continue
            yield _finding(script, row, first)
        elif row.kind == "store" and (kind := _locked_kind(script, row, symbols)):
            path = row.symbols[0]
            told = f"`{path}` of a `{kind}` is read-only: what it is made of decides."
            yield Finding(RULE.id, "error", script.name_span(row.node), told, path)
        elif row.kind == "store":
            yield from _locked(script, row, symbols)
    yield from _of_parts(script)


def _of_parts(script: Script) -> Iterator[Finding]:
    """Assignments to the items and the members of vectors and arrays that are read-only."""
    for node in script.all(ast.Attribute, ast.Subscript):
        if not isinstance(node.ctx, ast.Store):
            continue
        row = script.analysis.resolutions.get(alias(script, node.value))
        if row is None or row.kind != "attribute" or not row.sure or row.missing or not row.symbols:
            continue
        own = script.analysis.resolutions.get(node)
        if row.is_ready_for(*LACKS) or (own is not None and own.is_ready_for(*LACKS)):
            continue
        symbols = [script.api.symbols.symbol(path) for path in row.symbols]
        if all(symbol is not None and _is_fixed_array(symbol) for symbol in symbols):
            path = row.symbols[0]
            told = f"`{path}` is read-only, and so are its parts. Change a copy of it, or what it is made of."
            yield Finding(RULE.id, "error", script.span(node), told, path)


def _is_fixed_array(symbol: Symbol) -> bool:
    """Whether Blender writes what is assigned to a part into a property that cannot be assigned. A whole row of a
    matrix it lets be assigned, and forgets.
    """
    return symbol.kind == "property" and READ_ONLY in symbol.flags and len(symbol.array) == 1


def _locked(script: Script, row: Resolution, symbols: list[Symbol | None]) -> Iterator[Finding]:
    """What can be assigned only after another setting, of which the script has no word, or which it has just set
    otherwise.
    """
    settings = {freed_by(symbol) if symbol else "" for symbol in symbols}
    setting = settings.pop() if len(settings) == 1 else ""
    names = _names_of(script, symbols[0], setting.partition(" ")[0])
    if setting and not names & named_words(script):
        path = next(symbol.path for symbol in symbols if symbol)
        told = f"`{path}` cannot be assigned before `{setting}`: a new one has it otherwise."
        yield Finding(RULE.id, "warning", script.name_span(row.node), told, path)
    elif setting and (kept := _kept_locked(script, row, symbols[0], setting)):
        path = next(symbol.path for symbol in symbols if symbol)
        told = f"`{path}` cannot be assigned here, after `{kept}`: write `{setting}` before."
        yield Finding(RULE.id, "error", script.name_span(row.node), told, path)


def _names_of(script: Script, locked: Symbol | None, setting: str) -> set[str]:
    """The names by which a setting of the same class is reached: some have two, ``auto_texspace``."""
    members = list(script.api.symbols.members(locked.owner)) if locked else []
    told = {one.description for one in members if one.name == setting and one.type == "boolean"}
    return {setting} | {one.name for one in members if one.type == "boolean" and one.description in told}


def _kept_locked(script: Script, row: Resolution, locked: Symbol | None, setting: str) -> str:
    """What is set before an assignment and keeps its property locked; empty where nothing surely is."""
    name, _, free = setting.partition(" = ")
    symbol = script.api.symbols.symbol(f"{locked.owner}.{name}") if locked else None
    if symbol is None or row.statement is None or not isinstance(row.node, ast.Attribute):
        return ""
    before = set_before(script, row.statement, row.node.value, symbol)
    is_told = (
        isinstance(before, ast.Constant) and isinstance(before.value, bool) and repr(before.value) != free
    )
    return f"{name} = {ast.unparse(before)}" if before and is_told else ""


def _locked_kind(script: Script, row: Resolution, symbols: list[Symbol | None]) -> str:
    """The class of what has a property locked that only some of its kinds have free; empty where it may be free."""
    symbol = symbols[0] if len(symbols) == 1 and not row.missing else None
    free = set(symbol.flagged(FREE_ON)) if symbol else set[str]()
    kind = script.type_of(row.node.value) if isinstance(row.node, ast.Attribute) else None
    if symbol is None or not free or not isinstance(kind, Instance) or not kind.sure:
        return ""
    below = (script.api.symbols.symbol(path) for path in script.api.descendants(symbol.owner))
    labels = {one.path: one.label.lower() for one in below if one}
    is_leaf = not script.api.descendants(kind.cls)
    return (
        kind.cls
        if is_leaf and free <= set(labels.values()) and labels.get(kind.cls, "") not in {"", *free}
        else ""
    )


def _owners(symbols: list[Symbol | None]) -> list[str]:
    return [symbol.owner for symbol in symbols if symbol]


def _is_hidden(script: Script, row: Resolution, symbols: list[Symbol | None]) -> bool:
    """Whether a value is put before functions that an instance of a class of the script's inherits: Python lets it."""
    owner = script.type_of(row.node.value) if isinstance(row.node, ast.Attribute) else None
    is_own = any(isinstance(kind, LocalInstance) for kind in members(owner or UNKNOWN))
    return is_own and all(symbol is not None and symbol.kind == "function" for symbol in symbols)


def _is_deleted(row: Resolution) -> bool:
    return isinstance(row.statement, ast.Delete) and row.node in row.statement.targets


def _is_refused(row: Resolution, symbol: Symbol) -> bool:
    """Whether an instance refuses another value for a member."""
    if symbol.owner.startswith(TYPES):
        return symbol.kind == "function" or is_locked(symbol) or row.kind == "attribute"
    refused = next(
        (names for module, names in _REFUSED.items() if symbol.owner.startswith(module)), frozenset()
    )
    repeated = _SWIZZLE.fullmatch(symbol.name) and len(set(symbol.name)) < len(symbol.name)
    return symbol.name in refused or bool(repeated) or symbol.owner.startswith(_LAYERS)


def _finding(script: Script, row: Resolution, symbol: Symbol) -> Finding:
    span = script.name_span(row.node)
    if row.kind == "attribute" and symbol.kind != "function":
        return Finding(RULE.id, "error", span, f"`{symbol.path}` cannot be deleted.", symbol.path)
    if symbol.kind == "function":
        return Finding(
            RULE.id, "error", span,
            f"`{symbol.path}` is a function: it is called, not assigned to.", symbol.path,
            (symbol.path,), _calling(script, row, symbol),
        )  # fmt: skip
    changer, advice = changed_by(symbol.path)
    instead = (changer,) if changer and script.api.symbols.symbol(changer) else ()
    told = f"`{symbol.path}` is read-only. {advice if instead else ''}".rstrip()
    if not instead and symbol.type == "collection" and symbol.collection:
        functions = [name for name in ("new", "add", "link", "remove", "clear")
                     if script.api.member(f"bpy.types.{symbol.collection}", name)]  # fmt: skip
        if functions:
            told += f" It has {', '.join(f'`{name}()`' for name in functions)}."
    return Finding(RULE.id, "error", span, told, symbol.path, instead)


def _calling(script: Script, row: Resolution, symbol: Symbol) -> Fix | None:
    """``ob.select_set = True`` → ``ob.select_set(True)``."""
    statement = row.statement
    if (
        not isinstance(statement, ast.Assign)
        or len(statement.targets) != 1
        or row.node is not statement.targets[0]
    ):
        return None
    required = [parameter for parameter in symbol.parameters if parameter.required]
    if len(required) != 1 or not symbol.name.endswith("_set") or isinstance(statement.value, ast.Tuple):
        return None
    target, value = script.text(script.span(row.node)), script.text(script.span(statement.value))
    return Fix("Call it", (Edit(script.span(statement), f"{target}({value})"),), sure=True)


RULE = Rule("read-only", "error", "An assignment to what cannot be assigned", _check)
