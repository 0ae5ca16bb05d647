"""What a body of statements removes, statement by statement, while names still hold it.

Only what surely runs, in this order, is followed: the statements of the body themselves, not what is in their blocks.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from kb_build.flow.blender.facts import ELEMENTS, LAYERS
from kb_build.flow.values.types import Collection, Instance
from kb_build.symbols.api_names import ID
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import calls_by_node
from kb_check.modes.edit_bones import bound_in, names_in, names_of_others
from kb_check.modes.state import EDIT_TOGGLE, MODE_SET, literal_argument

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import Symbol
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_ELEMENTS = frozenset({f"bmesh.types.BM{kind}Seq.remove" for kind in ("Vert", "Edge", "Face")})
# What frees the thing that it is called on.
_FREEING = frozenset({"bmesh.types.BMesh.free"})
# What makes data that belong to an object alone → what removes them.
OUTSIDE_MAIN = {
    f"{T}Object.to_mesh": f"{T}Object.to_mesh_clear",
    f"{T}Object.to_curve": f"{T}Object.to_curve_clear",
}
_CLEARING = frozenset(OUTSIDE_MAIN.values())
_NAMES = ("remove", "free", "clear", "from_edit_mesh", "layers")
# What lays all elements of its kind anew, so that what names hold of them is gone.
NEW_LAYER = f"{LAYERS}.new"
_TAKING = frozenset({"new", "get", "add"})
# What belongs to Edit Mode, and goes when that is left.
_OF_EDIT_MODE, _EDIT_MODE = "bmesh.from_edit_mesh", "Edit Mode"


class Removal(NamedTuple):
    """What removed a thing, and in which line."""

    path: str
    line: int


@dataclass(slots=True)
class Removed:
    """What is known before a statement. ``gone``: the names that hold what was removed.

    ``_held`` are names with the place that their thing belongs to, as it is written: ``nodes``, ``ev.to_mesh``;
    ``_holding`` is the same by place, and ``_places`` has the places by the names that they are written with.
    """

    script: Script
    gone: dict[str, Removal] = field(default_factory=dict[str, Removal])
    _held: dict[str, str] = field(default_factory=dict[str, str])
    _holding: dict[str, set[str]] = field(default_factory=dict[str, set[str]])
    _places: dict[str, set[str]] = field(default_factory=dict[str, set[str]])

    def pass_by(self, statement: ast.stmt) -> None:
        """Goes on to what is known behind a statement."""
        for name in bound_in(statement):
            self.gone.pop(name, None)
            self._held.pop(name, None)
            for place in self._places.pop(name, ()):
                self._forget(place)
        match statement:
            case ast.Expr(value=ast.Call() as call) | ast.Assign(value=ast.Call() as call):
                self._lay_anew(call)
            case _:
                pass
        match statement:
            case ast.Expr(value=ast.Call() as call):
                self._remove(call)
            case ast.Assign(targets=[ast.Attribute(attr="active")]):
                self._forget(_EDIT_MODE)  # another object may leave it
            case ast.Assign(targets=[ast.Name(id=name)], value=value) if place := self._place(value):
                self._hold(name, place, value)
            case _:
                pass

    def _remove(self, call: ast.Call) -> None:
        site = calls_by_node(self.script).get(call)
        if site is None or not isinstance(call.func, ast.Attribute):
            return
        symbol, owner = site.callee.symbol, call.func.value
        removal = Removal(symbol.path, call.lineno)
        if _leaves_edit_mode(site):
            self._lose_held(_EDIT_MODE, removal)
        elif symbol.path in _FREEING:
            self._lose(owner, removal)
        elif symbol.path in _CLEARING:
            maker = next(maker for maker, clear in OUTSIDE_MAIN.items() if clear == symbol.path)
            self._lose_held(f"{ast.unparse(owner)}.{maker.rpartition('.')[2]}", removal)
        elif symbol.name == "clear" and not symbol.parameters and self._owns_items(owner):
            self._lose_held(ast.unparse(owner), removal)
        elif removes_argument(symbol, is_rna=site.callee.is_rna) and not site.has_unpacking:
            given = next((node for parameter, node in site.arguments() if parameter.required), None)
            self._lose(given, removal)

    def _lay_anew(self, call: ast.Call) -> None:
        match call.func:
            case ast.Attribute(value=ast.Attribute(value=ast.Attribute(value=elements, attr="layers"))) if (
                callee_path(self.script, call) == NEW_LAYER
            ):
                self._lose_held(ast.unparse(elements), Removal(NEW_LAYER, call.lineno))
            case _:
                pass

    def lose(self, names: Iterable[str], removal: Removal) -> None:
        """Takes down that what names hold was removed."""
        for name in names:
            self.gone[name] = removal

    def _lose(self, thing: ast.expr | None, removal: Removal) -> None:
        if isinstance(thing, ast.Name) and thing.id not in names_of_others(self.script):
            self.gone[thing.id] = removal

    def _lose_held(self, place: str, removal: Removal) -> None:
        self.lose(set(self._forget(place)) - names_of_others(self.script), removal)

    def _hold(self, name: str, place: str, value: ast.expr) -> None:
        self._held[name] = place
        self._holding.setdefault(place, set()).add(name)
        for read in names_in(value):
            self._places.setdefault(read, set()).add(place)

    def _forget(self, place: str) -> list[str]:
        """Forgets what belongs to a place; the names that held it."""
        names = sorted(self._holding.pop(place, ()))
        return [name for name in names if self._held.get(name) == place and self._held.pop(name)]

    def _place(self, value: ast.expr) -> str:
        """What a thing belongs to that a name is to hold, as it is written; empty where that is not known."""
        match value:
            case ast.Call(func=ast.Attribute() as function) if (
                callee_path(self.script, value) in OUTSIDE_MAIN
            ):
                return ast.unparse(function)
            case ast.Call() if callee_path(self.script, value) == _OF_EDIT_MODE:
                return _EDIT_MODE
            case ast.Call(func=ast.Attribute(value=owner, attr=name)) if name in _TAKING:
                return ast.unparse(owner) if callee_path(self.script, value) else ""
            case ast.Subscript(value=owner, slice=ast.Constant()) if self._owns_items(owner):
                return ast.unparse(owner)
            case _:
                return ""

    def _owns_items(self, node: ast.expr) -> bool:
        """Whether something is a collection of parts, which go with it, and not of data-blocks, which stay."""
        kind = self.script.type_of(node)
        if isinstance(kind, Instance) and kind.cls in ELEMENTS:
            return True
        element = kind.element if isinstance(kind, Collection) else None
        if not isinstance(element, Instance) or not element.cls.startswith(T):
            return False
        return not self.script.api.descends(element.cls, ID)


def _leaves_edit_mode(site: CallSite) -> bool:
    """Whether a call takes the active object out of Edit Mode, if it is in that."""
    path = site.callee.symbol.path
    mode = literal_argument(site, "mode") if path in MODE_SET and "toggle" not in site.given else "EDIT"
    return path == EDIT_TOGGLE or mode not in ("EDIT", None)


def may_remove(script: Script) -> bool:
    """Whether a script names anything that removes."""
    return any(node.attr.endswith(_NAMES) for node in script.all(ast.Attribute))


def removes_argument(symbol: Symbol, *, is_rna: bool) -> bool:
    """Whether a function removes the one thing that it must be given."""
    if symbol.path in _ELEMENTS:
        return True
    required = [parameter for parameter in symbol.parameters if parameter.required]
    is_removing = is_rna and (symbol.name == "remove" or symbol.name.endswith("_remove"))
    return is_removing and len(required) == 1 and required[0].plain_type[:1].isupper()
