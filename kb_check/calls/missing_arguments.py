"""Calls that lack an argument which they need."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.api_names import GROUPS
from kb_check.calls.sites import calls, calls_of_several
from kb_check.script import once_per_script
from kb_check.syntax.literals import number

if TYPE_CHECKING:
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

# Modules whose reference shows one of several signatures, and what bpy.props fills in when a class is registered.
_SEVERAL_SIGNATURES = ("aud.", "freestyle.", "bpy.props.")
# What a signature has that tells apart which of its parameters are needed; references of older versions do not.
_MARKS = ("/", "*", "=")
# Modules written in Python, whose signatures are Python's own.
IN_PYTHON = (
    "addon_utils.", "bl_keymap_utils.", "bpy.path.", "bpy_extras.", "gpu_extras.", "nodeitems_utils.",
    "rna_keymap_ui.", "rna_prop_ui.",
)  # fmt: skip
# Functions that need all that they take, which their signatures have no mark to say.
_NEED_ALL = frozenset(
    {
        "mathutils.kdtree.KDTree", "mathutils.kdtree.KDTree.find_n", "mathutils.kdtree.KDTree.find_range",
        "mathutils.kdtree.KDTree.insert", f"{GROUPS}.move", f"{GROUPS}.remove",
    }
)  # fmt: skip
# Parameters that may be left out though the reference shows no default: a turn or a scale of a 2 × 2 matrix has no
# axis, and Vector.Range counts as Python's range does. The references before 5.1 give a function an argument that it
# does not take.
_MAY_BE_LEFT_OUT = {
    "gpu.state.active_framebuffer_get": {"enable"},
    "mathutils.Matrix.Rotation": {"axis"}, "mathutils.Matrix.Scale": {"axis"}, "mathutils.Vector.Range": {"stop"},
}  # fmt: skip
# Functions that take only all of their arguments or the first: those that are needed with any other.
_ALL_OR_FIRST = frozenset({"bl_math.clamp"})
# Those that may be left out but for some values of another argument: (parameter, other, values).
_NEEDED_WITH = {"mathutils.Matrix.Rotation": ("axis", "size", {3, 4})}


@once_per_script
def calls_with_too_little(script: Script) -> list[tuple[CallSite, list[str]]]:
    """The calls that lack arguments which they need, each with the names of these."""
    found = ((call, _missing(script, call)) for call in (*calls(script), *calls_of_several(script)))
    return [(call, missing) for call, missing in found if missing]


def _missing(script: Script, call: CallSite) -> list[str]:
    callee = call.callee
    path = callee.symbol.path
    needs_all = path in _NEED_ALL
    told = (
        needs_all
        or callee.is_rna
        or path.startswith(IN_PYTHON)
        or any(mark in callee.symbol.signature for mark in _MARKS)
    )
    unreliable = path.startswith(_SEVERAL_SIGNATURES) or callee.is_open or not told
    if (callee.symbol.kind != "function" and not needs_all) or call.has_unpacking or unreliable:
        return []
    needed = _needed(script, call)
    left_out = _MAY_BE_LEFT_OUT.get(path, set()) - needed
    return [
        parameter.name
        for parameter in callee.parameters
        if (parameter.required or parameter.name in needed)
        and parameter.name not in call.given
        and parameter.name not in left_out
    ]


def _needed(script: Script, call: CallSite) -> set[str]:
    """The arguments that a call needs for another one, or its value, though others of its function's do not."""
    if call.callee.symbol.path in _ALL_OR_FIRST and len(call.given) > 1:
        return {parameter.name for parameter in call.callee.parameters}
    name, other, values = _NEEDED_WITH.get(call.callee.symbol.path, ("", "", set[int]()))
    node = call.argument(other) if other else None
    return {name} if node is not None and number(script, node) in values else set()
