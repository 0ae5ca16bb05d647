"""What crashes Blender: neither an error nor a `try` comes of it, the process ends.

All of it was tried on new things: with None for what an argument or a property takes, without arguments that may be
left out, without a scene for the sequencer, without an undo step, without a window.

```python
ob.vertex_groups.active = None  # reported: ob.vertex_groups.active_index = -1
collection.objects.unlink(None)  # reported
collection.objects.unlink(bpy.data.objects.get("Cube"))  # reported: it may give None
ob.animation_data.fix_paths_rename_all()  # reported: without `prefix`
strip.modifiers.new("Curves", "CURVES")  # reported: while bpy.context.workspace.sequencer_scene is None
bpy.ops.sculpt.face_sets_create(
    mode="ALL"
)  # reported without bpy.ops.ed.undo_push(), in a Blender without a window
drawing.add_strokes([])  # reported
image.gl_load()  # reported: in a Blender without a window
bmesh.ops.bmesh_to_mesh(bm)  # reported: bm.to_mesh(mesh)
bpy.app.help_text()  # reported: where Blender is a module of Python
```

Only None, what crashes whatever is given, and what the script made so itself (``read_factory_settings``) are errors;
what crashes some Blenders, or on some things, is a warning: without a window, in a new file, where `get` finds nothing.
Not reported: what a script asks for (`if ob:`), and calls without a window in scripts that register what people call.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.values.types import NONE
from kb_build.symbols.flag_names import (
    ENDS_BEFORE,
    ENDS_EVERY_TIME,
    ENDS_IN_MODULE,
    ENDS_LEFT_OUT,
    ENDS_ON_NONE,
    ENDS_WINDOWLESS,
    ENDS_WITHOUT,
    UNSET_BY,
)
from kb_build.symbols.lines import IN_MODULE
from kb_build.symbols.paths import last_name
from kb_check.calls.resolved import called_operators, callee_path
from kb_check.calls.sites import CallSite, calls
from kb_check.findings import Edit, Finding, Fix
from kb_check.rule import Rule
from kb_check.running.asked_for_none import tested_names
from kb_check.running.out_of_sight import knows_all
from kb_check.scene.emptied import EMPTYING, is_emptied_before
from kb_check.scene.made_here import makers
from kb_check.scene.opening import OPENING
from kb_check.script import once_per_script
from kb_check.syntax.bindings import assignments, bindings
from kb_check.syntax.named_before import is_named_before
from kb_check.values.given import Given, given_values

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

# What crashes Blender where the sizes of what is added are none.
_SIZED = frozenset({"bpy.types.GreasePencilDrawing.add_strokes", "bpy.types.Curves.add_curves"})
_ENTERING = frozenset({"bpy.ops.object.mode_set", "bpy.ops.sculpt.sculptmode_toggle"})
_RESETTING = "bpy.ops.wm.read_factory_settings"
_GETTING = "bpy.types.bpy_prop_collection.get"


def _check(script: Script) -> Iterator[Finding]:
    for given in given_values(script):
        yield from _given_none(script, given)
    for call in calls(script):
        yield from _left_out(script, call)
        yield from _without_sizes(script, call)
        yield from _everywhere(script, call)
        yield from _in_some_blenders(script, call)
        yield from _unset(script, call)
        yield from _without_step(script, call)


def _given_none(script: Script, given: Given) -> Iterator[Finding]:
    """None, or what may be None, for what crashes Blender then."""
    taker = given.takers[0]
    name = taker.path.rpartition("(")[2].removesuffix(")") if taker.is_parameter else taker.symbol.name
    if any(ENDS_ON_NONE + name not in other.symbol.flags for other in given.takers):
        return
    path = taker.symbol.path
    what = (
        f"`{path}` crashes Blender where {f'`{name}` is None' if taker.is_parameter else 'it is set to None'}"
    )
    if script.type_of(given.node) == NONE:
        index = next(iter(taker.symbol.flagged(UNSET_BY)), "")
        hint = f": `{index} = -1` unsets it." if index else "."
        yield Finding(
            RULE.id,
            "error",
            script.span(given.node),
            what + hint,
            path,
            (),
            _by_index(script, given.node, index),
        )
    elif taker.is_parameter and (getting := _got(script, given.node)):
        yield Finding(
            RULE.id, "warning", script.span(given.node),
            f"{what}, as `{ast.unparse(getting)}` is where there is no such item: ask before.", path,
        )  # fmt: skip


def _by_index(script: Script, value: ast.expr, index: str) -> Fix | None:
    """``groups.active = None`` → ``groups.active_index = -1``."""
    match assignments(script).get(value) if index else None:
        case ast.Assign(targets=[ast.Attribute(value=owner)]) as node:
            edit = Edit(script.span(node), f"{ast.unparse(owner)}.{index} = -1")
            return Fix(f"Write {index} = -1", (edit,), sure=True)
        case _:
            return None


def _got(script: Script, node: ast.expr) -> ast.Call | None:
    """The ``get`` of a collection, without a default, that an expression is; None where the script asks for it."""
    if isinstance(node, ast.Name):
        values = bindings(script).get(node.id, []) if node.id not in tested_names(script) else []
        node = values[0] if len(values) == 1 and values[0] else node
    is_got = isinstance(node, ast.Call) and len(node.args) == 1 and callee_path(script, node) == _GETTING
    return node if is_got and isinstance(node, ast.Call) else None


def _left_out(script: Script, call: CallSite) -> Iterator[Finding]:
    """A call without an argument that may be left out."""
    path = call.callee.symbol.path
    names = call.callee.symbol.flagged(ENDS_LEFT_OUT)
    if names and not call.has_unpacking and not call.given & set(names):
        wanted = " and ".join(f"`{name}`" for name in names)
        yield Finding(
            RULE.id, "warning", script.span(call.node), f"`{path}` crashes Blender without {wanted}.", path
        )


def _without_sizes(script: Script, call: CallSite) -> Iterator[Finding]:
    """A call that adds as many things as there are sizes, and is given none."""
    path = call.callee.symbol.path
    sizes = call.argument("sizes") if path in _SIZED else None
    if isinstance(sizes, (ast.List, ast.Tuple)) and not sizes.elts:
        yield Finding(
            RULE.id, "error", script.span(sizes), f"`{path}` crashes Blender where `sizes` is empty.", path
        )


def _everywhere(script: Script, call: CallSite) -> Iterator[Finding]:
    """A call that no argument helps."""
    path = call.callee.symbol.path
    if ENDS_EVERY_TIME in call.callee.symbol.flags:
        yield Finding(RULE.id, "error", script.span(call.node), f"`{path}` crashes Blender.", path)


def _in_some_blenders(script: Script, call: CallSite) -> Iterator[Finding]:
    """A call of what wants a window, or an application, in a script that may run without one."""
    path, flags = call.callee.symbol.path, call.callee.symbol.flags
    where = {ENDS_WINDOWLESS: "a Blender without a window", ENDS_IN_MODULE: f"Blender where {IN_MODULE}"}
    for blender in [where[flag] for flag in where if flag in flags and not _waits_for_people(script)]:
        yield Finding(RULE.id, "warning", script.span(call.node), f"`{path}` crashes {blender}.", path)


def _unset(script: Script, call: CallSite) -> Iterator[Finding]:
    """A call on what the script made while something is None that the script never sets."""
    path, function = call.callee.symbol.path, call.node.func
    for needed in call.callee.symbol.flagged(ENDS_WITHOUT):
        owner = function.value if isinstance(function, ast.Attribute) else None
        if (
            isinstance(owner, ast.Attribute)
            and knows_all(script)
            and _is_made(script, owner.value)
            and not is_named_before(script, last_name(needed), call.node)
        ):
            yield Finding(
                RULE.id, "error" if _is_in_new_file(script, call) else "warning", script.span(call.node),
                f"`{path}` crashes Blender while `{needed}` is None, as it is in a new file: set it before.", path,
            )  # fmt: skip


def _is_in_new_file(script: Script, call: CallSite) -> bool:
    """Whether a call surely stands behind what makes the file that of a new Blender, and reads no other one."""
    readers = [node for node in script.all(ast.Call) if callee_path(script, node) in OPENING | EMPTYING]
    are_resetting = all(
        callee_path(script, node) == _RESETTING and all(one.arg == "use_empty" for one in node.keywords)
        for node in readers
    )
    row = script.analysis.resolutions.get(call.node)
    return (
        are_resetting
        and row is not None
        and row.statement is not None
        and is_emptied_before(script, row.statement)
    )


def _without_step(script: Script, call: CallSite) -> Iterator[Finding]:
    """An operator that crashes a Blender without a window, where the script enters its mode and makes no undo step."""
    path = call.callee.symbol.path
    for before in call.callee.symbol.flagged(ENDS_BEFORE):
        if (
            not _ENTERING.isdisjoint(called_operators(script))
            and knows_all(script)
            and not _waits_for_people(script)
            and not is_named_before(script, last_name(before.partition("(")[0]), call.node)
        ):
            yield Finding(
                RULE.id, "warning", script.span(call.node),
                f"`{path}` crashes a Blender without a window while there is no undo step: call `{before}` before "
                "the mode is entered.", path,
            )  # fmt: skip


@once_per_script
def _waits_for_people(script: Script) -> bool:
    """Whether a script registers what people call, who have a window."""
    return any(node.name == "register" for node in script.all(ast.FunctionDef)) or bool(
        script.package.identifiers
    )


def _is_made(script: Script, owner: ast.expr) -> bool:
    """Whether all that a name stands for was made by the script: ``strips.new_effect(…)``."""
    made_by = makers(script, owner.id) if isinstance(owner, ast.Name) else frozenset[str]()
    return bool(made_by) and all(last_name(path)[:3] == "new" for path in made_by)


RULE = Rule("crash", "error", "What crashes Blender", _check)
