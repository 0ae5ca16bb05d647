"""Something that needs an active object where there is none.

```python
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
bpy.context.object.name  # reported: None has no name
bpy.ops.object.mode_set(mode="OBJECT")  # reported: Blender refuses it without an active object
ob = bpy.data.objects.new("Ball", mesh)
bpy.context.collection.objects.link(ob)
bpy.context.object.name  # reported: bpy.context.view_layer.objects.active = ob comes before
```

None is active in an empty file (``read_factory_settings(use_empty=True)``), behind
``view_layer.objects.active = None``, and behind loops that remove all objects; these findings are errors. Where all
objects that can be selected were deleted, one that is hidden may stay the active one: a warning.

Not reported: what follows statements that may make an object active, or may run what is not known; what stands in
conditions and loops that go by objects, in a ``try`` and inside ``temp_override``.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.calls.resolved import member_path
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.modes.absence import active_reads
from kb_check.modes.keeping import run_in
from kb_check.modes.run import states
from kb_check.modes.state import Absence, lacks_active, refusal
from kb_check.rule import Rule
from kb_check.running.asked_for_none import tested_names
from kb_check.running.tried import is_tried
from kb_check.syntax.bindings import bindings
from kb_check.syntax.bodies import bodies

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.modes.state import State
    from kb_check.script import Script

_MAKING_ACTIVE = "`bpy.context.view_layer.objects.active = obj` comes before"
_WHY = {Absence.SURE: "no object is active here", Absence.DELETED: "all objects were deleted before"}


def _check(script: Script) -> Iterator[Finding]:
    known = states(script)
    for call in calls(script):
        state = known.get(call.node)
        if state and not state.muted and lacks_active(call, state) and not refusal(script, call, state):
            path = call.callee.symbol.path
            yield _finding(script, call.node, state, f"`{path}` is refused", path)
    absent = {
        node: state
        for node in active_reads(script)
        if (state := known.get(node)) and state.absence and not state.muted
    }
    if not absent:
        return
    for node, pointer in _used(script, absent):
        if not is_tried(script, node):
            path = member_path(script, pointer) if isinstance(pointer, ast.Attribute) else ""
            yield _finding(script, node, absent[pointer], f"`{ast.unparse(pointer)}` is None", path)


def _used(script: Script, absent: dict[ast.expr, State]) -> Iterator[tuple[ast.expr, ast.expr]]:
    """What is read from places that read no active object, with these: at once, or by the name that is given to it."""
    users = script.all(ast.Attribute, ast.Subscript)
    for node in users:
        if node.value in absent:
            yield node, node.value
    for body in bodies(script):
        for place, statement in enumerate(body):
            match statement:
                case ast.Assign(targets=[ast.Name(id=name)], value=value) if (
                    value in absent
                    and len(bindings(script).get(name, ())) == 1
                    and name not in tested_names(script)
                ):
                    later = (node for following in body[place + 1 :] for node in run_in(following))
                    user = next((node for node in later if _reads_name(node, name)), None)
                    if isinstance(user, ast.expr):
                        yield user, value
                case _:
                    pass


def _reads_name(node: ast.AST, name: str) -> bool:
    match node:
        case ast.Attribute(value=ast.Name(id=read)) | ast.Subscript(value=ast.Name(id=read)):
            return read == name
        case _:
            return False


def _finding(script: Script, node: ast.expr, state: State, what: str, path: str) -> Finding:
    return Finding(
        RULE.id, "error" if state.absence is Absence.SURE else "warning", script.span(node),
        f"{what}: {_WHY[state.absence]}. {_MAKING_ACTIVE}.", path,
    )  # fmt: skip


RULE = Rule("no-active-object", "error", "Something that needs an active object where there is none", _check)
