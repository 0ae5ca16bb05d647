"""What a body of statements does to the bones of armatures, statement by statement, as their mode changes.

Only what surely runs, in this order, is followed: the statements of the body themselves, not what is in their blocks.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children, walk
from kb_build.flow.values.types import Instance
from kb_build.symbols.api_names import TYPES as T
from kb_check.calls.resolved import callee_path
from kb_check.calls.sites import calls_by_node
from kb_check.modes.keeping import keeps_mode, run_in, sets_active
from kb_check.modes.state import MODE_SET, literal_argument
from kb_check.running.out_of_sight import computes_names
from kb_check.script import once_per_script
from kb_check.syntax.bodies import bodies
from kb_check.syntax.literals import bound_names
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

EDIT_BONE = f"{T}EditBone"
_NEW = {f"{T}BlendDataArmatures.new": "armature", f"{T}ArmatureEditBones.new": "edit_bone"}
# What changes the edit bones of an armature.
CHANGING = frozenset({f"{T}ArmatureEditBones.new", f"{T}ArmatureEditBones.remove"})
_NEW_OBJECT = f"{T}BlendDataObjects.new"
_UPDATING = "update_from_editmode"  # makes bones of edit bones before Edit Mode is left
_ADD = "bpy.ops.object.armature_add"
_ADDED = "Bone"  # how an armature's one bone is called that the operator adds
_SELECT = "bpy.ops.object.select_all"
_TOGGLE = "bpy.ops.object.editmode_toggle"
# The members that lead from an object with an armature to its bones: (kind, member) → kind.
_STEPS = {
    ("object", "data"): "armature", ("object", "pose"): "pose", ("armature", "edit_bones"): "edit_bones",
    ("armature", "bones"): "bones", ("pose", "bones"): "bones",
}  # fmt: skip
_ACTIVE = frozenset(
    {"bpy.context.object", "bpy.context.active_object", "bpy.context.view_layer.objects.active"}
)
# What is run only by chance, later, or for other values of the names.
_NOT_SURELY = (
    ast.Lambda, ast.IfExp, ast.BoolOp, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp,
)  # fmt: skip


# Statements with others within them.
BLOCKS = (
    ast.If, ast.For, ast.AsyncFor, ast.While, ast.With, ast.AsyncWith, ast.Try, ast.TryStar, ast.Match,
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Thing:
    """Something of an armature, which is known by the call that made it."""

    kind: str
    made_by: ast.Call


@dataclass(slots=True)
class Bones:
    """What is known of bones before a statement.

    ``gone``: the names that hold edit bones of before Edit Mode was left.
    """

    script: Script
    gone: set[str] = field(default_factory=set[str])
    _held: set[str] = field(default_factory=set[str])
    _is_edited: bool = False
    _is_split: bool = False  # an object may still be in Edit Mode, and not be the one that leaves it
    _things: dict[str, Thing] = field(default_factory=dict[str, Thing])
    _active: ast.Call | None = None
    _without_bones: set[ast.Call] = field(default_factory=set[ast.Call])
    _unmade: set[tuple[ast.Call, str]] = field(default_factory=set[tuple[ast.Call, str]])
    _known: set[ast.Call] = field(default_factory=set[ast.Call])
    _outside: set[ast.Call] = field(default_factory=set[ast.Call])

    def edited_outside(self, statement: ast.stmt) -> Iterator[ast.Call | ast.Subscript]:
        """What a statement asks of the edit bones of an armature that surely is not in Edit Mode."""
        if not self._outside or not keeps_mode(self.script, statement):
            return
        bound = set(bound_in(statement)) if isinstance(statement, BLOCKS) else set[str]()
        for node in run_in(statement):
            match node:
                case ast.Call(func=ast.Attribute(value=bones)) if callee_path(self.script, node) in CHANGING:
                    pass
                case ast.Subscript(value=bones, slice=ast.Constant()):
                    pass
                case _:
                    continue
            thing = self._thing(bones)
            is_outside = thing and thing.kind == "edit_bones" and thing.made_by in self._outside
            if is_outside and bound.isdisjoint(names_in(bones)):
                yield node

    def is_unmade(self, node: ast.Subscript) -> bool:
        """Whether a bone is asked for by the name of one that is, until Edit Mode is left, an edit bone only."""
        match node:
            case ast.Subscript(slice=ast.Constant(value=str(name)), ctx=ast.Load()):
                thing = self._thing(node.value)
                known = thing is not None and thing.kind == "bones" and (thing.made_by, name) in self._unmade
                return known and _UPDATING not in named_words(self.script)
            case _:
                return False

    def pass_by(self, statement: ast.stmt) -> None:
        """Goes on to what is known behind a statement."""
        if self.gone or self._held or self._things:
            for name in bound_in(statement):
                self.gone.discard(name)
                self._held.discard(name)
                self._things.pop(name, None)
        if (mode := self._entered(statement)) is not None:
            self._change_mode(mode)
        elif not self._adds(statement) and not self._selects(statement) and not self._activates(statement):
            self._keep(statement)
        self._hold(statement)

    def _entered(self, statement: ast.stmt) -> str | None:
        """The mode that a statement enters: ``EDIT``, or another one; None for none that is known."""
        call = _operator(self.script, statement)
        if call is None or not isinstance(statement, ast.Expr):
            return None
        site = calls_by_node(self.script)[call]
        if site.callee.symbol.path == _TOGGLE:
            return "OBJECT" if self._is_edited else "EDIT"
        mode = literal_argument(site, "mode") if site.callee.symbol.path in MODE_SET else None
        return mode if isinstance(mode, str) and "toggle" not in site.given else None

    def _change_mode(self, mode: str) -> None:
        if mode == "EDIT":
            self._is_edited = True
            self._outside.clear()
            return
        if self._is_edited and not self._is_split:
            self._outside |= self._known
        self.gone |= self._held
        self._without_bones.clear()
        self._forget_edit()

    def _forget_edit(self) -> None:
        self._held.clear()
        self._unmade.clear()
        self._is_edited = False

    def _adds(self, statement: ast.stmt) -> bool:
        """Whether a statement adds an armature, which becomes the active object."""
        call = _operator(self.script, statement)
        if call is None or calls_by_node(self.script)[call].callee.symbol.path != _ADD:
            return False
        self._forget_edit()
        self._active = call
        self._without_bones = {call}
        enters = calls_by_node(self.script)[call].argument("enter_editmode")
        self._is_edited = isinstance(enters, ast.Constant) and enters.value is True
        self._known.add(call)
        if enters is None or (isinstance(enters, ast.Constant) and enters.value is False):
            self._outside.add(call)
        return True

    def _selects(self, statement: ast.stmt) -> bool:
        call = _operator(self.script, statement)
        return call is not None and calls_by_node(self.script)[call].callee.symbol.path == _SELECT

    def _activates(self, statement: ast.stmt) -> bool:
        """Whether a statement makes an object active: it may be another one than that in Edit Mode."""
        match statement:
            case ast.Assign(targets=[ast.Attribute() as target]) if sets_active(self.script, target):
                thing = self._thing(statement.value)
                self._active = thing.made_by if thing and thing.kind == "object" else None
                self._is_split |= self._is_edited
                self._held.clear()
                self._is_edited = False
                return True
            case _:
                return False

    def _keep(self, statement: ast.stmt) -> None:
        if not keeps_mode(self.script, statement):
            self._forget_edit()
            self._outside.clear()
            self._active = None
            self._without_bones.clear()
        if not (self._things or self._active):
            return
        stores = (
            node
            for node in walk(statement)
            if isinstance(node, ast.Attribute) and not isinstance(node.ctx, ast.Load)
        )
        if any(node.attr == "data" for node in stores):  # an object may get another armature
            self._things.clear()
            self._active = None

    def _hold(self, statement: ast.stmt) -> None:
        """Takes down what a statement makes, and the names that it gives things."""
        for node in surely_run(statement):
            match node:
                case ast.Call(func=ast.Attribute(value=bones)) if self._made(node) == "edit_bone":
                    self._add_bone(self._thing(bones), self._argument(node, "name"))
                case ast.Call() if self._made(node) == "armature":
                    self._without_bones.add(node)
                    self._known.add(node)
                    self._outside.add(node)
                case _:
                    pass
        match statement:
            case ast.Assign(targets=[ast.Name(id=name)]) if name not in names_of_others(self.script):
                if self._is_edited and not self._is_split and _is_edit_bone(self.script, statement.value):
                    self._held.add(name)
                if thing := self._thing(statement.value):
                    self._things[name] = thing
            case _:
                pass

    def _add_bone(self, armature: Thing | None, name: ast.expr | None) -> None:
        match name:
            case ast.Constant(value=str(text)) if armature and armature.made_by in self._without_bones:
                if text != _ADDED or self._made(armature.made_by) == "armature":
                    self._unmade.add((armature.made_by, text))
            case _:
                pass

    def _thing(self, node: ast.expr | None) -> Thing | None:
        """What an expression is, if it belongs to an armature that this body makes."""
        match node:
            case ast.Name(id=name):
                return self._things.get(name)
            case ast.Attribute(value=value, attr="data" | "pose" | "bones" | "edit_bones" as name):
                owner = self._thing(value)
                kind = _STEPS.get((owner.kind, name)) if owner else None
                return Thing(kind, owner.made_by) if owner and kind else None
            case ast.Attribute(attr="object" | "active_object" | "active") if self._active:
                return Thing("object", self._active) if ast.unparse(node) in _ACTIVE else None
            case ast.Call() if self._made(node) == "armature":
                return Thing("armature", node)
            case ast.Call() if callee_path(self.script, node) == _NEW_OBJECT:
                data = self._thing(self._argument(node, "object_data"))
                return Thing("object", data.made_by) if data and data.kind == "armature" else None
            case _:
                return None

    def _argument(self, call: ast.Call, name: str) -> ast.expr | None:
        site = calls_by_node(self.script).get(call)
        return site.argument(name) if site else None

    def _made(self, call: ast.Call) -> str:
        return _NEW.get(callee_path(self.script, call), "")


def surely_run(statement: ast.stmt) -> Iterator[ast.AST]:
    """The parts of a statement that run wherever it does, its blocks left out."""
    if isinstance(statement, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
        return
    waiting: list[ast.AST] = [
        node for node in children(statement) if isinstance(node, (ast.expr, ast.withitem))
    ]
    if isinstance(statement, ast.Assert):
        waiting = [statement.test]
    while waiting:
        node = waiting.pop()
        if not isinstance(node, _NOT_SURELY):
            yield node
            waiting += children(node)


def names_in(node: ast.AST) -> set[str]:
    """The names that an expression reads."""
    return {part.id for part in walk(node) if isinstance(part, ast.Name)}


def _operator(script: Script, statement: ast.stmt) -> ast.Call | None:
    """The operator that a statement calls, if it is a plain call."""
    match statement:
        case ast.Expr(value=ast.Call() as call) | ast.Assign(value=ast.Call() as call):
            site = calls_by_node(script).get(call)
            plain = not call.args and all(keeps_mode(script, word.value) for word in call.keywords)
            known = site and plain and not site.has_unpacking and site.callee.symbol.kind == "operator"
            return call if known else None
        case _:
            return None


def _is_edit_bone(script: Script, node: ast.expr) -> bool:
    kind = script.type_of(node)
    return isinstance(kind, Instance) and kind.sure and kind.cls == EDIT_BONE


def bound_in(statement: ast.stmt) -> Iterator[str]:
    """The names that a statement may bind or unbind, blocks and all."""
    for node in walk(statement):
        if not isinstance(node, (ast.arg, ast.Global, ast.Nonlocal)):
            yield from bound_names(node)


@once_per_script
def names_of_others(script: Script) -> frozenset[str]:
    """The names that a function binds for others."""
    return frozenset(name for node in script.all(ast.Global, ast.Nonlocal) for name in node.names)


@once_per_script
def names_edit_bones(script: Script) -> bool:
    """Whether a script that shows what it does has anything to do with edit bones."""
    return not computes_names(script) and any(node.attr == "edit_bones" for node in script.all(ast.Attribute))


@once_per_script
def edited_outside(script: Script) -> dict[ast.Call | ast.Subscript, None]:
    """What a script asks of the edit bones of armatures that surely are not in Edit Mode, in order."""
    found: dict[ast.Call | ast.Subscript, None] = {}
    if names_edit_bones(script):
        for body in bodies(script):
            bones = Bones(script)
            for statement in body:
                found |= dict.fromkeys(bones.edited_outside(statement))
                bones.pass_by(statement)
    return found
