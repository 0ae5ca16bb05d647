"""What makes no object the active one, and what reads the active one."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import READ_ACTIVE, SET_ACTIVE
from kb_check.calls.resolved import member_path
from kb_check.calls.sites import calls
from kb_check.modes.state import Absence, State
from kb_check.scene.deleted import deleting_all, deleting_selected
from kb_check.scene.emptied import EMPTYING
from kb_check.script import once_per_script
from kb_check.syntax.words import attributes

if TYPE_CHECKING:
    from kb_check.script import Script

_OF_VIEW_LAYER = frozenset({"bpy.context.view_layer.objects.active", "context.view_layer.objects.active"})


@once_per_script
def lines_without_active(script: Script) -> frozenset[int]:
    """The lines behind which no object may be active."""
    lines = {node.lineno for node in deleting_all(script) | deleting_selected(script)}
    lines |= {call.node.lineno for call in calls(script) if call.callee.symbol.path in EMPTYING}
    return frozenset(lines | {node.lineno for node in script.all(ast.Assign) if _deactivates(script, node)})


def without_active(script: Script, statement: ast.stmt, state: State) -> State:
    """What is known behind a statement that may have deleted all objects, or made none active."""
    if statement in deleting_all(script) or _deactivates(script, statement):
        return replace(state, kind="", absence=Absence.SURE)
    if statement in deleting_selected(script):
        return replace(state, kind="", absence=max(state.absence, Absence.DELETED))
    return state


@once_per_script
def active_reads(script: Script) -> frozenset[ast.expr]:
    """The places that surely read the active object."""
    named = [
        node for name in ("object", "active_object", "active") for node in attributes(script).get(name, ())
    ]
    return frozenset(node for node in named if isinstance(node.ctx, ast.Load) and _is_active(script, node))


def _deactivates(script: Script, statement: ast.stmt) -> bool:
    match statement:
        case ast.Assign(targets=[ast.Attribute(attr="active") as target], value=ast.Constant(value=None)):
            return _is_active(script, target)
        case _:
            return False


def _is_active(script: Script, node: ast.Attribute) -> bool:
    """Whether an attribute is the active object of the context, or of its view layer."""
    path = member_path(script, node)
    return path in READ_ACTIVE or (path == SET_ACTIVE and ast.unparse(node) in _OF_VIEW_LAYER)
