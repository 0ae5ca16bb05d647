"""What a script surely makes itself, and what it may do to that out of sight."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from bisect import bisect_right
from typing import TYPE_CHECKING

from kb_build.flow.facts import READ_ACTIVE, made_by
from kb_build.flow.trees import walk
from kb_build.symbols.api_names import ID, OBJECT, OPERATORS
from kb_build.symbols.flags import fillers
from kb_check.running.computing import RUNNING, STORING, computing
from kb_check.script import once_for_each, once_per_script

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from kb_check.script import Script

_DEEPEST = 8
_WORD = re.compile(r"\w+")
_BODIES: tuple[type[ast.AST], ...] = (
    ast.Module, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef, ast.If, ast.For, ast.AsyncFor, ast.While, ast.With,
    ast.AsyncWith, ast.Try, ast.TryStar, ast.ExceptHandler, ast.match_case,
)  # fmt: skip
# Modules that change nothing in Blender's data but what is given to them.
_HARMLESS = (sys.stdlib_module_names - {"runpy", "importlib"}) | {
    "bpy", "bmesh", "mathutils", "gpu", "gpu_extras", "idprop", "bl_math", "blf", "aud", "imbuf", "numpy", "scipy",
    "pandas", "PIL", "cv2", "requests", "yaml", "tqdm", "matplotlib",
}  # fmt: skip
# Of Blender's own helpers, the modules and functions of which the same is true.
_HARMLESS_HELPERS = frozenset(
    {
        "bpy_extras.anim_utils", "bpy_extras.io_utils", "bpy_extras.mesh_utils", "bpy_extras.view3d_utils",
        "bpy_extras.object_utils.world_to_camera_view", "rna_prop_ui",
    }
)  # fmt: skip
_DOTS = 3  # of the path of an operator; that of a module has fewer
# Operators that change nothing but the active object, which they leave as new as it is.
_PLAIN = re.compile(r"bpy\.ops\.(mesh\.primitive_\w+_add|object\.(select_all|shade_\w+|delete)|wm\.read_\w+)")
OBJECTS_NEW, LINKS_NEW = "bpy.types.BlendDataObjects.new", "bpy.types.NodeLinks.new"


@once_per_script
def named_words(script: Script) -> frozenset[str]:
    """Every word of the script that may name a setting."""
    return frozenset(attributes(script)) | keywords_and_texts(script)


@once_per_script
def keywords_and_texts(script: Script) -> frozenset[str]:
    """The words of the script that may name a setting without being an attribute."""
    return words_of(script.all(ast.keyword, ast.Constant))


@once_per_script
def attributes(script: Script) -> dict[str, list[ast.Attribute]]:
    """Name → the attributes of that name."""
    found: dict[str, list[ast.Attribute]] = {}
    for node in script.all(ast.Attribute):
        found.setdefault(node.attr, []).append(node)
    return found


def is_named_before(script: Script, word: str, place: ast.expr) -> bool:
    """Whether a word may have had an effect when the script comes to a place: any of it, within a function."""
    first = first_named(script).get(word)
    return first is not None and first <= stage(script, place)


def is_named_only_behind(script: Script, word: str, statement: ast.stmt) -> bool:
    """Whether nothing but later statements of the same body name a setting, which has no effect then the first time."""
    if statement not in places(script):
        return False
    body, _ = places(script)[statement]
    start = statement.end_lineno or 0, statement.end_col_offset or 0
    end = body[-1].end_lineno or 0, body[-1].end_col_offset or 0
    naming = [
        node for node in script.all(ast.Attribute, ast.keyword, ast.Constant) if word in words_of([node])
    ]
    return all(start <= (node.lineno, node.col_offset) < end for node in naming)


def stage(script: Script, place: ast.expr) -> int:
    """The number of the statement of the module that a place is in; within a function, the last one."""
    body = script.tree.body
    number = statement_of(body, place)
    is_apart = number < 0 or isinstance(body[number], (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef))
    return len(body) if is_apart else number


@once_per_script
def first_named(script: Script) -> dict[str, int]:
    """Each word of the script that may name a setting → the number of the statement of the module that has it first."""
    return first_named_but(script, frozenset())


def first_named_but(script: Script, nodes: Collection[ast.AST]) -> dict[str, int]:
    """The same without what some nodes name themselves."""
    found: dict[str, int] = {}
    for number, statement in enumerate(script.tree.body):
        for word in words_of(node for node in walk(statement) if node not in nodes):
            found.setdefault(word, number)
    return found


def statement_of(body: Sequence[ast.stmt], node: ast.expr) -> int:
    """The place of the statement of a body that a node is in; -1 for none."""
    at = node.lineno, node.col_offset
    place = bisect_right(body, at, key=_start) - 1
    if place < 0:
        return -1
    end = body[place].end_lineno or 0, body[place].end_col_offset or 0
    return place if at < end else -1


def _start(statement: ast.stmt) -> tuple[int, int]:
    return statement.lineno, statement.col_offset


def words_of(nodes: Iterable[ast.AST]) -> frozenset[str]:
    """The words of nodes, by themselves, that may name a setting: attributes, keywords, texts."""
    found: set[str] = set()
    for node in nodes:
        match node:
            case ast.Attribute(attr=name) | ast.keyword(arg=str(name)):
                found.add(name)
            case ast.Constant(value=str(text)):
                found.update(_WORD.findall(text))
            case _:
                pass
    return frozenset(found)


@once_per_script
def words_in_texts(script: Script) -> frozenset[str]:
    """The words of the script's texts: it may ask for an attribute by one."""
    return words_of(script.all(ast.Constant))


@once_per_script
def computes_names(script: Script) -> bool:
    """Whether something out of sight may set settings: computed names, or the files beside the script."""
    is_computed = not computing(script).isdisjoint(RUNNING | STORING)
    return is_computed or any(node.level > 0 for node in script.all(ast.ImportFrom))


@once_per_script
def knows_all(script: Script) -> bool:
    """Whether all that a script does stands in it: it computes no names, and imports nothing that changes scenes."""
    if computes_names(script):
        return False
    imported = {alias.name for node in script.all(ast.Import) for alias in node.names}
    imported |= {f"{node.module}.{alias.name}" for node in script.all(ast.ImportFrom) for alias in node.names}
    return all(name.partition(".")[0] in _HARMLESS or _is_helper(name) for name in imported)


def is_untouched(script: Script, node: ast.expr, place: ast.expr) -> bool:
    """Whether nothing out of sight runs between the making of a new thing and a place further down in the same body.

    ``node`` is the thing, or what belongs to it.
    """
    if not computing(script).isdisjoint(RUNNING | STORING):
        return False
    while isinstance(node, ast.Attribute):
        node = node.value
    made = once_bound(script, node)
    if not isinstance(made, ast.Call) or not callee_path(script, made).endswith(".new"):
        return False
    found = [(body, at) for body in bodies(script) if (at := statement_of(body, made)) >= 0]
    body, first = max(found, key=lambda row: _start(row[0][row[1]]), default=([], 0))
    last = statement_of(body, place)
    between = [part for statement in body[first : last + 1] for part in walk(statement)]
    return first <= last and not any(_is_foreign(script, part) for part in between)


def _is_foreign(script: Script, node: ast.AST) -> bool:
    """Whether what a part of a script runs may stand elsewhere."""
    if isinstance(node, ast.Call) and not callee_path(script, node):
        return not isinstance(node.func, ast.Name) or not hasattr(builtins, node.func.id)
    return isinstance(node, (ast.Import, ast.ImportFrom))


def _is_helper(name: str) -> bool:
    """Whether a dotted name is one of the harmless helpers, or in one."""
    return name in _HARMLESS_HELPERS or name.rpartition(".")[0] in _HARMLESS_HELPERS


@once_per_script
def members_taken(script: Script) -> dict[ast.expr, str]:
    """Expression → the name of the attribute that is taken of it."""
    return {node.value: node.attr for node in script.all(ast.Attribute)}


def is_new(script: Script, node: ast.expr, depth: int = _DEEPEST) -> bool:
    """Whether the script has surely made what an expression is, or what it belongs to."""
    if not depth:
        return False
    match node:
        case ast.Name():
            return _is_new_name(script, (node.id, depth))
        case ast.Call():
            return callee_path(script, node).endswith(".new")
        case ast.Attribute():
            return _is_new_member(script, node, depth)
        case _:
            return False


@once_for_each
def _is_new_name(script: Script, name_and_depth: tuple[str, int]) -> bool:
    name, depth = name_and_depth
    values = bindings(script).get(name, [None])
    handed_on = name in _handed_on(script)
    return not handed_on and all(value and is_new(script, value, depth - 1) for value in values)


def _is_new_member(script: Script, node: ast.Attribute, depth: int) -> bool:
    row = script.analysis.resolutions.get(node)
    symbol = script.api.symbols.symbol(row.symbols[0]) if row and len(row.symbols) == 1 else None
    if symbol is None or symbol.type != "pointer":
        return False
    if calls := fillers(symbol):
        return any(call.partition("(")[0] in called_operators(script) for call in calls)
    if symbol.name == "data" and symbol.owner == OBJECT:
        return is_new(script, node.value, depth - 1) and has_new_data(script, node.value, depth - 1)
    points_elsewhere = script.names.reader.descends(f"bpy.types.{symbol.target}", ID)
    return not points_elsewhere and is_new(script, node.value, depth - 1)


def has_new_data(script: Script, node: ast.expr, depth: int = _DEEPEST) -> bool:
    """Whether an object was made with new data, which have nothing that they would give it."""
    if isinstance(node, ast.Name):
        return _has_new_data(script, (node.id, depth))
    return _is_made_with_new_data(script, node, depth)


@once_for_each
def _has_new_data(script: Script, name_and_depth: tuple[str, int]) -> bool:
    name, depth = name_and_depth
    values = bindings(script).get(name, [])
    return bool(values) and all(_is_made_with_new_data(script, value, depth) for value in values)


def _is_made_with_new_data(script: Script, node: ast.expr | None, depth: int) -> bool:
    return (
        isinstance(node, ast.Call)
        and callee_path(script, node) == OBJECTS_NEW
        and len(node.args) > 1
        and is_new(script, node.args[1], depth)
    )


def member_path(script: Script, attribute: ast.Attribute) -> str:
    """The path of the one symbol that an attribute surely is; empty for none."""
    row = script.analysis.resolutions.get(attribute)
    if row is None or not row.sure or row.guarded or row.missing or len(row.symbols) != 1:
        return ""
    return row.symbols[0]


def callee_path(script: Script, call: ast.Call) -> str:
    """The path of the one thing of the API that a call surely calls; empty for none."""
    row = script.analysis.resolutions.get(call)
    return row.symbols[0] if row and row.kind == "call" and len(row.symbols) == 1 and row.sure else ""


@once_per_script
def called_operators(script: Script) -> frozenset[str]:
    """The operators that the script calls."""
    rows = script.resolutions("call", "attribute")
    return frozenset(path for row in rows for path in row.symbols if path.startswith(OPERATORS))


def has_plain_operators_only(script: Script) -> bool:
    """Whether all operators that the script calls leave things that it made as they are."""
    return calls_only(script, _PLAIN)


def calls_only(script: Script, operators: re.Pattern[str]) -> bool:
    """Whether the paths of all operators that the script calls match."""
    return all(operators.fullmatch(path) for path in called_operators(script) if path.count(".") == _DOTS)


@once_per_script
def stored_names(script: Script) -> frozenset[str]:
    """The attributes that the script sets or deletes."""
    return frozenset(node.attr for node in script.all(ast.Attribute) if not isinstance(node.ctx, ast.Load))


@once_per_script
def bindings(script: Script) -> dict[str, list[ast.expr | None]]:
    """Name → everything that it is bound to, None for what is no expression."""
    found: dict[str, list[ast.expr | None]] = {}
    assigned: set[ast.Name] = set()
    for node in script.all(ast.Assign, ast.AnnAssign, ast.arg):
        match node:
            case ast.Assign(targets=[ast.Name() as name]) | ast.AnnAssign(target=ast.Name() as name):
                found.setdefault(name.id, []).append(node.value)
                assigned.add(name)
            case ast.arg(arg=name):
                found.setdefault(name, []).append(None)
            case _:
                pass
    for node in script.all(ast.Name):
        if isinstance(node.ctx, ast.Store) and node not in assigned:
            found.setdefault(node.id, []).append(None)
    return found


def reads_active(script: Script, node: ast.expr | None) -> bool:
    """Whether an expression surely is the active object, read from the context."""
    row = script.analysis.resolutions.get(node) if node is not None else None
    return row is not None and bool(row.symbols) and READ_ACTIVE.issuperset(row.symbols)


def making_operator(script: Script, statement: ast.stmt) -> str:
    """The operator that a statement calls, if it makes an object and leaves it the active one; empty for others."""
    match statement:
        case ast.Expr(value=ast.Call() as call) if made_by(path := callee_path(script, call)):
            return path
        case _:
            return ""


def once_bound(script: Script, node: ast.expr) -> ast.expr:
    """The one value that a name has, or else the expression itself."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    return values[0] if len(values) == 1 and values[0] else node


@once_per_script
def assignments(script: Script) -> dict[ast.expr, ast.Assign]:
    """Value → the statement that assigns it."""
    return {node.value: node for node in script.all(ast.Assign)}


@once_per_script
def places(script: Script) -> dict[ast.stmt, tuple[list[ast.stmt], int]]:
    """Statement → the body that it is in, and its place there."""
    return {statement: (body, place) for _, body in _blocks(script) for place, statement in enumerate(body)}


@once_per_script
def texts_but_keys(script: Script) -> frozenset[str]:
    """The texts of a script that are no keys of items."""
    keys = {node.slice for node in script.all(ast.Subscript)}
    return frozenset(
        node.value for node in script.all(ast.Constant) if isinstance(node.value, str) and node not in keys
    )


@once_per_script
def bodies(script: Script) -> list[list[ast.stmt]]:
    """The bodies of statements that a script has."""
    return [body for _, body in _blocks(script) if body]


@once_per_script
def owners(script: Script) -> dict[ast.stmt, ast.AST]:
    """Statement → what has the body that it is in."""
    return {statement: owner for owner, body in _blocks(script) for statement in body}


def _blocks(script: Script) -> Iterator[tuple[ast.AST, list[ast.stmt]]]:
    for node in script.all(*_BODIES):
        for field in ("body", "orelse", "finalbody"):
            body = getattr(node, field, None)
            if isinstance(body, list):
                yield node, body


def alias(script: Script, node: ast.expr) -> ast.expr:
    """What a name is another name of: the member that it is bound to, and to nothing else; else the node itself."""
    values = bindings(script).get(node.id, []) if isinstance(node, ast.Name) else []
    return values[0] if len(values) == 1 and isinstance(values[0], ast.Attribute) else node


@once_per_script
def asked_names(script: Script) -> frozenset[str]:
    """The names and attributes that are used for more than to read from them, or to hold them."""
    read = {node.value for node in script.all(ast.Attribute)}
    held = {node.value for node in script.all(ast.Assign)}
    found: set[str] = set()
    for node in script.all(ast.Attribute, ast.Name):
        if isinstance(node.ctx, ast.Load):
            if node in read or (node in held and isinstance(node, ast.Attribute)):
                continue
            found.add(node.attr if isinstance(node, ast.Attribute) else node.id)
    return frozenset(found)


@once_for_each
def makers(script: Script, name: str) -> frozenset[str]:
    """What is called for all that a name stands for; nothing where it stands for other values as well."""
    values = bindings(script).get(name, [])
    calls_only = all(isinstance(value, ast.Call) for value in values)
    paths = {callee_path(script, value) for value in values if isinstance(value, ast.Call)}
    return frozenset(paths) if calls_only else frozenset()


@once_per_script
def _handed_on(script: Script) -> frozenset[str]:
    """The names whose values are passed to functions that are neither the API's nor the script's own."""
    own = {node.name for node in script.all(ast.FunctionDef, ast.ClassDef)}
    found: set[str] = set()
    for node in script.all(ast.Call):
        if not callee_path(script, node):
            function = node.func
            name = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
            if name not in own:
                arguments = (*node.args, *(keyword.value for keyword in node.keywords))
                found.update(value.id for value in arguments if isinstance(value, ast.Name))
    return frozenset(found)
