"""Which objects the names of a body of statements hold, and which one is active, selected or edited, statement by
statement.

Only what surely runs, in this order, is followed: the statements of the body themselves, not what is in their blocks.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import SET_ACTIVE, made_by
from kb_build.symbols.api_names import ID, OBJECT
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path, member_path
from kb_check.calls.sites import calls_by_node
from kb_check.modes.edit_bones import bound_in, names_of_others
from kb_check.modes.keeping import is_harmless, keeps_mode, run_in
from kb_check.modes.state import EDIT_TOGGLE, MODE_SET, keeps_active, literal_argument
from kb_check.scene.active_object import reads_active
from kb_check.scene.made_here import MESH, OBJECTS_NEW
from kb_check.syntax.words import stored_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

_OBJECTS = f"{T}BlendData.objects"
_EDIT_OBJECT = f"{T}Context.edit_object"
_SELECT_SET = f"{OBJECT}.select_set"
_SELECT, JOIN = "bpy.ops.object.select_all", "bpy.ops.object.join"
COPY = f"{ID}.copy"
_MESH = "MESH"
_JOINED = frozenset({_MESH, "CURVE", "SURFACE", "ARMATURE"})


@dataclass(frozen=True, slots=True)
class Held:
    """An object: the number of the statement at which it became known, and what it is looked up by.

    ``is_new`` says that it was made there, ``is_copy`` of another object. ``key`` is its name in ``bpy.data``, ``kind``
    its type; empty for unknown.
    """

    number: int
    is_new: bool = False
    key: str = ""
    kind: str = ""
    is_copy: bool = False

    def is_another(self, other: Held) -> bool:
        """Whether two surely are two."""
        if self.key and other.key:
            return self.key != other.key
        later = max(self, other, key=lambda held: held.number)
        return self.number != other.number and later.is_new


@dataclass(slots=True)
class HeldObjects:
    """What is known before a statement.

    ``joined`` are the objects that the statement before has joined into another one. ``selected`` has those that surely
    are; others may be as well.
    """

    script: Script
    active: Held | None = None
    selected: set[Held] = field(default_factory=set[Held])
    joined: set[Held] = field(default_factory=set[Held])
    _names: dict[str, Held] = field(default_factory=dict[str, Held])
    _data: dict[str, Held] = field(default_factory=dict[str, Held])
    _by_key: dict[str, Held] = field(default_factory=dict[str, Held])
    _number: int = 0
    _is_edited: bool = False

    @property
    def edited(self) -> Held | None:
        """The active object, if it is known and surely in Edit Mode."""
        return self.active if self._is_edited else None

    def thing(self, node: ast.expr | None) -> Held | None:
        """What object an expression is; None where that is not known."""
        match node:
            case ast.Name(id=name):
                return self._names.get(name)
            case ast.Attribute() if self._reads_active(node):
                return self.active
            case ast.Subscript(value=ast.Attribute() as objects, slice=ast.Constant(value=str(key))):
                is_all = member_path(self.script, objects) == _OBJECTS
                return self._by_key.setdefault(key, self._found(key)) if is_all else None
            case _:
                return None

    def owner(self, data: ast.expr | None) -> Held | None:
        """The object whose data an expression is."""
        match data:
            case ast.Name(id=name):
                return self._data.get(name)
            case ast.Attribute(value=value, attr="data"):
                return self.thing(value)
            case _:
                return None

    def _found(self, key: str) -> Held:
        """What is looked up; a script that gives names may have given this one to what it knows otherwise."""
        return Held(self._number, key="" if "name" in stored_names(self.script) else key)

    def names(self, held: Held) -> Iterator[str]:
        """The names that hold an object."""
        return (name for name, one in self._names.items() if one == held)

    def pass_by(self, statement: ast.stmt) -> None:
        """Goes on to what is known behind a statement."""
        self._number += 1
        self.joined = set()
        for name in bound_in(statement):
            self._names.pop(name, None)
            self._data.pop(name, None)
        match statement:
            case ast.Expr(value=ast.Call() as call) if self._selects(call):
                pass
            case ast.Expr(value=ast.Call() as call) if site := self._operator(call):
                self._operate(site)
            case ast.Assign(targets=[ast.Attribute() as target], value=value) if (
                member_path(self.script, target) == SET_ACTIVE
            ):
                self._keep(value)
                self.active, self._is_edited = self.thing(value), False
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                self._keep(statement)
                if name not in names_of_others(self.script):
                    self._hold(name, value)
            case _:
                self._keep(statement)

    def _hold(self, name: str, value: ast.expr) -> None:
        """Takes down what a name holds: an object, or the data of one."""
        if held := self._assigned(value):
            self._names[name] = held
        if owner := self.owner(value):
            self._data[name] = owner

    def _assigned(self, value: ast.expr) -> Held | None:
        """What object a name is to hold."""
        match value:
            case ast.Call() if callee_path(self.script, value) == OBJECTS_NEW:
                return self._made(value)
            case ast.Call(func=ast.Attribute(value=owner)) if callee_path(self.script, value) == COPY and (
                original := self.thing(owner)
            ):
                return Held(self._number, is_new=True, kind=original.kind, is_copy=True)
            case ast.Attribute() if self._reads_active(value) and self.active is None:
                self.active = Held(self._number)
                return self.active
            case _:
                return self.thing(value)

    def _reads_active(self, node: ast.Attribute) -> bool:
        path = member_path(self.script, node)
        return (
            reads_active(self.script, node)
            or path == SET_ACTIVE
            or (self._is_edited and path == _EDIT_OBJECT)
        )

    def _made(self, call: ast.Call) -> Held:
        site = calls_by_node(self.script).get(call)
        data = site.argument("object_data") if site else None
        is_mesh = data is not None and self.script.class_of(data) == MESH
        held = Held(self._number, is_new=True, kind=_MESH if is_mesh else "")
        if isinstance(data, ast.Name):
            self._data[data.id] = held
        return held

    def _selects(self, call: ast.Call) -> bool:
        """Whether a call selects an object, or no longer does."""
        if callee_path(self.script, call) != _SELECT_SET or not isinstance(call.func, ast.Attribute):
            return False
        held, site = self.thing(call.func.value), calls_by_node(self.script).get(call)
        given = site.argument("state") if site else None
        if not isinstance(given, ast.Constant):
            return False
        if given.value:
            self.selected |= {held} if held else set()
        else:
            self.selected = {one for one in self.selected if held and one.is_another(held)}
        return True

    def _operator(self, call: ast.Call) -> CallSite | None:
        site = calls_by_node(self.script).get(call)
        plain = not call.args and all(keeps_mode(self.script, word.value) for word in call.keywords)
        known = site and plain and not site.has_unpacking and site.callee.symbol.kind == "operator"
        return site if known else None

    def _operate(self, site: CallSite) -> None:
        path = site.callee.symbol.path
        if path in MODE_SET:
            mode = literal_argument(site, "mode") if "toggle" not in site.given else None
            self._is_edited = mode == "EDIT"
        elif path == EDIT_TOGGLE:
            self._is_edited = False
        elif (kind := made_by(path)) and not self._is_edited:
            self._forget()
            if literal_argument(site, "enter_editmode") is False:
                self.active = Held(self._number, is_new=True, kind=kind)
                self.selected = {self.active}
        elif path == _SELECT:
            self.selected = set()
        elif path == JOIN:
            self._join()
        elif not keeps_active(path, is_edited=self._is_edited):
            self._forget()

    def _join(self) -> None:
        """The selected objects of the active one's type go, if that is selected itself."""
        active = self.active
        if active is None or active not in self.selected:
            self.selected = set()
            return
        kinds = {active.kind} if active.kind else _JOINED
        self.joined = {held for held in self.selected if held.kind in kinds and held.is_another(active)}
        self.selected = {active}

    def _keep(self, part: ast.stmt | ast.expr) -> None:
        """Forgets what a statement or an expression may change."""
        if not keeps_mode(self.script, part):
            self._forget()
        for node in run_in(part):
            match node:
                case ast.Call() if not is_harmless(self.script, node):
                    self._forget()
                case ast.Call(func=ast.Attribute(attr="select_set")):
                    self.selected = set()
                case ast.Attribute(attr="data", ctx=ast.Store()):
                    self._data.clear()
                case _:
                    pass

    def _forget(self) -> None:
        self.active, self._is_edited = None, False
        self.selected = set()
