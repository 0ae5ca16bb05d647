"""What a call of ``bpy.props`` declares."""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from kb_build.flow.values.types import ClassObject
from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.records import Symbol
from kb_check.calls.resolved import callee_path
from kb_check.registered.classes import own_classes
from kb_check.script import once_per_script
from kb_check.syntax.literals import lists_left_alone, number, times_bound, written
from kb_check.values.given import Taker

if TYPE_CHECKING:
    from kb_check.script import Script

_PROPS = "bpy.props."
_KINDS = {
    "BoolProperty": "boolean", "IntProperty": "int", "FloatProperty": "float", "StringProperty": "string",
    "EnumProperty": "enum", "BoolVectorProperty": "boolean", "IntVectorProperty": "int",
    "FloatVectorProperty": "float", "PointerProperty": "pointer", "CollectionProperty": "collection",
}  # fmt: skip
_USUAL_SIZE = 3
_GROUP = f"{T}PropertyGroup"
_FLAG = "ENUM_FLAG"


@dataclass(frozen=True, slots=True)
class OwnProperty:
    """A property that a script declares: a boolean, a pointer, a collection … (``kind``), empty for none, or not known.

    ``taker`` is what it takes, None where that is not known. ``items`` are the values of an enumeration whose items are
    written out. ``is_fixed``: nothing is assigned to it.
    """

    path: str
    kind: str = ""
    taker: Taker | None = None
    items: tuple[str, ...] | None = None
    is_fixed: bool = False


def declared(script: Script, node: ast.expr, path: str) -> OwnProperty:
    """What an expression declares; ``path`` names it for people."""
    callee = callee_path(script, node) if isinstance(node, ast.Call) else ""
    kind = _KINDS.get(callee.removeprefix(_PROPS), "") if callee.startswith(_PROPS) else ""
    if not isinstance(node, ast.Call) or not kind or any(keyword.arg is None for keyword in node.keywords):
        return OwnProperty(path)
    given = {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
    found = OwnProperty(path, kind)
    if "set" in given or "set_transform" in given:
        return found  # its own function may take anything
    if "get" in given or kind == "collection":
        return replace(found, is_fixed=True)
    taker = Taker(path, kind, Symbol(path, "property", path.rpartition(".")[0], type=kind), takes_none=False)
    if kind == "pointer":
        return _pointer(script, found, taker, given.get("type"))
    if kind == "enum":
        return _enumeration(script, found, taker, given)
    return _scalar(script, found, taker, given, is_vector="Vector" in callee)


def _scalar(
    script: Script, found: OwnProperty, taker: Taker, given: dict[str, ast.expr], *, is_vector: bool
) -> OwnProperty:
    sizes = _sizes(script, given.get("size")) if is_vector else ()
    subtype = given.get("subtype")
    named = subtype.value if isinstance(subtype, ast.Constant) else None
    if sizes is None or (subtype is not None and not isinstance(named, str)):
        return found
    return replace(found, taker=replace(taker, sizes=sizes, subtype=str(named or "")))


def _pointer(script: Script, found: OwnProperty, taker: Taker, target: ast.expr | None) -> OwnProperty:
    kind = script.type_of(target) if target is not None else None
    if isinstance(kind, ClassObject) and script.api.descends(kind.cls, ID):
        return replace(found, taker=replace(taker, target=kind.cls, takes_none=True))
    return replace(found, is_fixed=isinstance(target, ast.Name) and target.id in _groups(script))


@once_per_script
def _groups(script: Script) -> frozenset[str]:
    """The names of the script's groups of properties."""
    names = (own.node.name for own in own_classes(script) if own.path == _GROUP)
    return frozenset(name for name in names if times_bound(script)[name] == 1)


def _enumeration(script: Script, found: OwnProperty, taker: Taker, given: dict[str, ast.expr]) -> OwnProperty:
    options = given.get("options")
    names = (
        [part.value for part in options.elts if isinstance(part, ast.Constant)]
        if isinstance(options, ast.Set)
        else []
    )
    if options is not None and (not isinstance(options, ast.Set) or len(names) < len(options.elts)):
        return found
    taker = replace(taker, kind="set" if _FLAG in names else "enum")
    return replace(found, taker=taker, items=_items(script, given.get("items")))


def _items(script: Script, node: ast.expr | None) -> tuple[str, ...] | None:
    """The identifiers of an enumeration whose items are written out; None for others."""
    if isinstance(node, ast.Name):
        node = lists_left_alone(script).get(node.id, node)
    shown = written(script, node) if node is not None else None
    if not isinstance(shown, (ast.Tuple, ast.List)):
        return None
    found: list[str] = []
    for item in shown.elts:
        first = item.elts[0] if isinstance(item, ast.Tuple) and item.elts else item
        if not isinstance(first, ast.Constant) or not (first.value is None or isinstance(first.value, str)):
            return None
        if first.value:
            found.append(first.value)
    return tuple(found)


def _sizes(script: Script, node: ast.expr | None) -> tuple[int, ...] | None:
    if node is None:
        return (_USUAL_SIZE,)
    value = written(script, node)
    parts = value.elts if isinstance(value, ast.Tuple) else [node]
    found = [number(script, part) for part in parts]
    sizes = tuple(size for size in found if isinstance(size, int))
    return sizes if len(sizes) == len(parts) else None
