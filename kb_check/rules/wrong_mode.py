"""An operator that Blender refuses in the mode that the active object is in.

```python
bpy.ops.object.select_all(action="DESELECT")  # runs in Object Mode only
bpy.ops.mesh.primitive_cube_add()
bpy.ops.mesh.subdivide()  # reported: bpy.ops.object.mode_set(mode="EDIT") comes before
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.object.shade_smooth()  # reported: still in Edit Mode
```

So is a mode that the active object's type does not have: `mode_set(mode="POSE")` of a cube. It is an error where the
mode is certain: something before, on every way, enters it or runs in it alone. Where only nothing in the script enters
a mode that an operator needs, it is a note: Blender may be in that mode when the script starts.

Not reported: what stands inside `temp_override`, or in a `try` that catches the error; and what follows calls that may
change the mode out of sight. Blender is taken to have its own settings: new objects do not enter Edit Mode.

In which modes operators run was found by asking each, with objects of all types in all modes
(``kb_build/blender/inside/operator_needs.py``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.background import is_called_by_others, lines_of_others
from kb_check.calls import calls
from kb_check.findings import Finding
from kb_check.mode_run import enters_modes, states
from kb_check.modes import entering, modes_text, modes_wanted, refusal
from kb_check.rule import Rule

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    known = states(script)
    quiet = lines_of_others(script) if known else []
    never = bool(known) and not is_called_by_others(script) and not enters_modes(script)
    for call in calls(script):
        state = known.get(call.node)
        if state is None or state.muted:
            continue
        path = call.callee.symbol.path
        if said := refusal(script, call, state):
            yield Finding(RULE.id, "error", script.span(call.node), f"`{path}` {said}.", path)
        elif never and not state.mode and not any(a <= call.node.lineno <= b for a, b in quiet):
            modes = modes_wanted(call.callee.symbol)
            if modes and not modes.is_others and not modes.takes("OBJECT"):
                yield Finding(
                    RULE.id, "note", script.span(call.node),
                    f"`{path}` runs only in {modes_text(modes.names)}, which this script never enters: "
                    f"{entering(modes)}.",
                    path,
                )  # fmt: skip


RULE = Rule("wrong-mode", "error", "An operator in a mode in which Blender refuses it", _check)
