"""An operator that is to change an object, and runs while another one is active.

```python
bpy.ops.mesh.primitive_cube_add()
cube = bpy.context.object
bpy.ops.mesh.primitive_uv_sphere_add()
hole = cube.modifiers.new("Hole", "BOOLEAN")
bpy.ops.object.modifier_apply(modifier="Hole")  # reported: the sphere is the active object
bpy.context.view_layer.objects.active = cube
bpy.ops.object.modifier_apply(modifier="Hole")
ball = bpy.data.objects.new("Ball", mesh)
bpy.context.collection.objects.link(ball)
bpy.ops.rigidbody.object_add()  # of the cube, which is active
ball.rigid_body.mass = 2  # reported: ball.rigid_body is None
with bpy.context.temp_override(object=ball, active_object=ball, selected_objects=[ball]):
    bpy.ops.object.location_clear()  # reported: of what is selected in the view layer
```

Operators that look for a modifier do nothing where the active object has none of the name: no error tells so. Not
reported: what stands in a condition, a loop or a function and is made outside of it; an active object that the
statements around do not make; and modifiers whose name is computed.
"""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import OF_SELECTED
from kb_check.calls.resolved import called_operators, callee_path
from kb_check.calls.sites import calls_by_node
from kb_check.findings import Finding
from kb_check.modes.edit_bones import bound_in
from kb_check.modes.keeping import run_in
from kb_check.rule import Rule
from kb_check.running.out_of_sight import computes_names
from kb_check.running.tried import is_tried
from kb_check.scene.filled_pointers import FILLING, FilledPointers
from kb_check.scene.held_objects import COPY, Held, HeldObjects
from kb_check.scene.overridden import overridden
from kb_check.syntax.bodies import bodies
from kb_check.syntax.words import asked_names

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_WORKING = re.compile(r"bpy\.ops\.object\.modifier_(apply|apply_as_shapekey|copy|remove|move_\w+)")
_NEW = "bpy.types.ObjectModifiers.new"
_ADD = "bpy.ops.object.modifier_add"


def _check(script: Script) -> Iterator[Finding]:
    yield from _overridden_in_vain(script)
    if computes_names(script):
        return
    operators = called_operators(script)
    for body in bodies(script):
        if any(map(_WORKING.fullmatch, operators)):
            yield from _missed(script, body)
        if any(map(FILLING.fullmatch, operators)):
            yield from _left_empty(script, body)


def _overridden_in_vain(script: Script) -> Iterator[Finding]:
    """Operators on the selected objects that are given others by the context, which the script does not select."""
    selected = {
        ast.dump(node.func.value)
        for node in script.all(ast.Call)
        if isinstance(node.func, ast.Attribute) and node.func.attr == "select_set"
    }
    for call, given in overridden(script, OF_SELECTED):
        if ast.dump(given) not in selected:
            obj, path = ast.unparse(given), call.callee.symbol.path
            yield Finding(
                RULE.id, "warning", script.span(call.node),
                f"`{path}` works on the objects that are selected in the view layer, and not on `{obj}`, which "
                f"`temp_override` gives: `bpy.ops.object.select_all(action='DESELECT')`, `{obj}.select_set(True)` and "
                f"`bpy.context.view_layer.objects.active = {obj}` come before.",
                path,
            )  # fmt: skip


def _left_empty(script: Script, body: list[ast.stmt]) -> Iterator[Finding]:
    """What is read from a pointer of one object that an operator has filled on another one."""
    pointers = FilledPointers(script, HeldObjects(script))
    reported: set[str] = set()
    for statement in body:
        for node, pointer, filling in pointers.empty(statement):
            text, owner = ast.unparse(pointer), ast.unparse(pointer.value)
            if text in reported or pointer.attr in asked_names(script) or is_tried(script, node):
                continue
            reported.add(text)
            yield Finding(
                RULE.id, "warning", script.span(node),
                f"`{text}` is None: `{filling}` works on the active object, which `{owner}` has not been when it ran: "
                f"`bpy.context.view_layer.objects.active = {owner}` comes before.",
                filling,
            )  # fmt: skip
        pointers.pass_by(statement)


@dataclass(slots=True)
class _Modifiers:
    """Which objects have got modifiers in a body, statement by statement.

    ``by_text`` has the objects by what says which modifier is meant: its name as it is written, or ``hole.name``.
    """

    script: Script
    objects: HeldObjects
    by_text: dict[str, Held] = field(default_factory=dict[str, Held])
    having: set[Held] = field(default_factory=set[Held])
    is_open: bool = False  # some object has got one, and which is not known

    def pass_by(self, statement: ast.stmt) -> None:
        """Goes on to what is known behind a statement, and behind what it makes the objects."""
        for name in bound_in(statement):
            self.by_text.pop(f"{name}.name", None)
        active = self.objects.active
        for node in run_in(statement):
            match node:
                case ast.Attribute(value=owner, attr="modifiers"):
                    self._give(self.objects.thing(owner))
                case ast.Call() if callee_path(self.script, node) == _ADD:
                    self._give(active)
                case _:
                    pass
        self.objects.pass_by(statement)
        match statement:
            case ast.Assign(targets=[ast.Name(id=name) as target], value=ast.Call() as call):
                self._name(name, call)
                if callee_path(self.script, call) == COPY:
                    self._give(self.objects.thing(target))
            case ast.Expr(value=ast.Call() as call):
                self._name("", call)
            case _:
                pass

    def holder(self, call: ast.Call) -> Held | None:
        """The object whose modifier an operator is to work on."""
        site = calls_by_node(self.script).get(call)
        given = site.argument("modifier") if site else None
        return self.by_text.get(ast.unparse(given)) if given is not None else None

    def may_have(self, held: Held) -> bool:
        """Whether an object may have modifiers."""
        return self.is_open or not held.is_new or held in self.having

    def _give(self, held: Held | None) -> None:
        if held is None:
            self.is_open = True
        else:
            self.having.add(held)

    def _name(self, name: str, call: ast.Call) -> None:
        """Takes down a new modifier, which a name may hold."""
        match call:
            case ast.Call(func=ast.Attribute(value=ast.Attribute(value=owner))) if callee_path(
                self.script, call
            ) == _NEW and (held := self.objects.thing(owner)):
                site = calls_by_node(self.script).get(call)
                text = site.argument("name") if site else None
                if isinstance(text, ast.Constant):
                    self.by_text[ast.unparse(text)] = held
                if name:
                    self.by_text[f"{name}.name"] = held
            case _:
                pass


def _missed(script: Script, body: list[ast.stmt]) -> Iterator[Finding]:
    objects = HeldObjects(script)
    modifiers = _Modifiers(script, objects)
    for statement in body:
        active = objects.active
        match statement:
            case ast.Expr(value=ast.Call() as call) if _WORKING.fullmatch(path := callee_path(script, call)):
                holder = modifiers.holder(call)
                name = next(objects.names(holder), "") if holder else ""
                if active and name and holder != active and not modifiers.may_have(active):
                    yield Finding(
                        RULE.id, "warning", script.span(call),
                        f"`{path}` works on the active object, which has no modifier here, and does nothing: "
                        f"`bpy.context.view_layer.objects.active = {name}` comes before.",
                        path,
                    )  # fmt: skip
            case _:
                pass
        modifiers.pass_by(statement)


RULE = Rule("other-object", "warning", "An operator that works on another object than is meant", _check)
