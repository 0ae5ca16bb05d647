"""An operator that Blender refuses in the mode that the active object is in.

```python
bpy.ops.object.select_all(action="DESELECT")  # runs in Object Mode only
bpy.ops.mesh.primitive_cube_add()
bpy.ops.mesh.subdivide()  # reported: bpy.ops.object.mode_set(mode="EDIT") comes before
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.object.shade_smooth()  # reported: still in Edit Mode
bpy.ops.object.mode_set(mode="OBJECT")
bmesh.from_edit_mesh(mesh)  # reported: the mesh must be in Edit Mode
```

`mode_set` and `editmode_toggle` move the view layer's active object, whichever one `temp_override` gives: that is a
warning.

```python
with bpy.context.temp_override(active_object=ob):
    bpy.ops.object.mode_set(mode="EDIT")  # reported: bpy.context.view_layer.objects.active = ob comes before
```

So is a mode that the active object's type does not have: `mode_set(mode="POSE")` of a cube. It is an error where the
mode is certain: something before, on every way, enters it or runs in it alone. Where only nothing in the script enters
a mode that an operator needs, it is a note: Blender may be in that mode when the script starts. Of meshes that the
script makes itself, that is certain.

Not reported otherwise: what stands inside `temp_override`, or in a `try` that catches the error; and what follows calls
that may change the mode out of sight. Blender is taken to have its own settings: new objects do not enter Edit Mode.

In which modes operators run was found by asking each, with objects of all types in all modes
(``kb_build/blender/inside/preconditions/operator_needs.py``).
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.given_values import constants
from kb_build.symbols.api_names import CHANGING_MODE
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.modes.run import enters_modes, states
from kb_check.modes.state import (
    MODE_SET,
    entering,
    former_mode,
    modes_text,
    modes_wanted,
    refusal,
)
from kb_check.rule import Rule
from kb_check.running.background import is_called_by_others, lines_of_others
from kb_check.scene.made_here import is_new, is_primitive_mesh
from kb_check.scene.overridden import overridden

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.calls.sites import CallSite
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    yield from _of_another(script)
    yield from _held_modes(script)
    known = states(script)
    quiet = lines_of_others(script)
    never = bool(known) and not is_called_by_others(script) and not enters_modes(script)
    for call in calls(script):
        state = known.get(call.node)
        if state is None or state.muted:
            continue
        path = call.callee.symbol.path
        if said := refusal(script, call, state):
            yield Finding(RULE.id, "error", script.span(call.node), f"`{path}` {said}.", path)
        elif never and not state.mode and call.node.lineno not in quiet:
            modes = modes_wanted(call.callee.symbol)
            is_function = call.callee.symbol.kind != "operator"
            if is_function and not _is_of_new_mesh(script, call):
                continue  # a mesh that is in Edit Mode when the script starts
            if modes and not modes.is_others and not modes.takes("OBJECT"):
                yield Finding(
                    RULE.id, "error" if is_function else "note", script.span(call.node),
                    f"`{path}` runs only in {modes_text(modes.names)}, which this script never enters: "
                    f"{entering(modes)}.",
                    path,
                )  # fmt: skip


def _is_of_new_mesh(script: Script, call: CallSite) -> bool:
    """Whether a function is given a mesh that the script has surely made."""
    given = next((node for _, node in call.arguments()), None)
    return given is not None and (is_new(script, given) or is_primitive_mesh(script, given))


def _held_modes(script: Script) -> Iterator[Finding]:
    """Former modes that are given to ``mode_set`` at times: by a name that holds one, or as a side of a choice."""
    modes = [call.argument("mode") for call in calls(script) if call.callee.symbol.path in MODE_SET]
    names = {node.id for node in modes if isinstance(node, ast.Name)}
    held: list[ast.expr] = [node for node in modes if isinstance(node, ast.IfExp)]
    for assigned in script.all(ast.Assign) if names else ():
        if any(isinstance(target, ast.Name) and target.id in names for target in assigned.targets):
            held.append(assigned.value)
    for value in (value for node in held for value in constants(node) if script.type_of(value) is not None):
        if said := former_mode(script, value.value):
            yield Finding(
                RULE.id, "warning", script.span(value), f"`bpy.ops.object.mode_set` {said}.", "bpy.ops.object.mode_set"
            )  # fmt: skip


def _of_another(script: Script) -> Iterator[Finding]:
    """Calls that change the mode of the active object, and not of the one that the context is given for them."""
    for call, given in overridden(script, CHANGING_MODE):
        obj, path = ast.unparse(given), call.callee.symbol.path
        yield Finding(
            RULE.id, "warning", script.span(call.node),
            f"`{path}` changes the mode of the view layer's active object, and not of `{obj}`, which `temp_override` "
            f"gives. Write `bpy.context.view_layer.objects.active = {obj}` before it.",
            path,
        )  # fmt: skip


RULE = Rule("wrong-mode", "error", "An operator in a mode in which Blender refuses it", _check)
