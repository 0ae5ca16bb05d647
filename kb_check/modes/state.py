"""The mode and the type of the active object: what operators need of them, and what they leave behind."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import TYPE_CHECKING

from kb_build.symbols.flags import operator_active
from kb_build.symbols.lines import with_article
from kb_build.symbols.needs import Wanted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kb_build.symbols.records import Symbol
    from kb_check.calls.sites import CallSite
    from kb_check.script import Script

MODE_SET = frozenset({"bpy.ops.object.mode_set", "bpy.ops.object.mode_set_with_submode"})
EDIT_TOGGLE = "bpy.ops.object.editmode_toggle"
_FACTORY, _HOME = "bpy.ops.wm.read_factory_settings", "bpy.ops.wm.read_homefile"
_ADDED = (
    (re.compile(r"bpy\.ops\.mesh\.primitive_\w+_add"), "MESH"),
    (re.compile(r"bpy\.ops\.curve\.primitive_\w+_add"), "CURVE"),
    (re.compile(r"bpy\.ops\.surface\.primitive_\w+_add"), "SURFACE"),
    (re.compile(r"bpy\.ops\.object\.armature_add"), "ARMATURE"),
    (re.compile(r"bpy\.ops\.object\.text_add"), "FONT"),
    (re.compile(r"bpy\.ops\.object\.metaball_add"), "META"),
    (re.compile(r"bpy\.ops\.object\.camera_add"), "CAMERA"),
    (re.compile(r"bpy\.ops\.object\.light_add"), "LIGHT"),
    (re.compile(r"bpy\.ops\.object\.(empty|effector)_add"), "EMPTY"),
)
# Modules whose operators leave the object that they edit active and in its mode.
_EDITING = re.compile(r"bpy\.ops\.(mesh|curve|surface|armature|uv|lattice|mball|font)\.\w+")
# Modules whose operators leave Object Mode to those of these names.
_OF_SCENES = re.compile(
    r"bpy\.ops\.(object|mesh|curve|surface|rigidbody|ptcache|fluid|cloth|boid|dpaint|constraint|collection|anim|nla|graph|"
    r"action|transform|render|material|texture|image|node|world|export_\w+|import_\w+)\.\w+|bpy\.ops\.wm\.save\w+"
)
_SWITCHING = re.compile(r"mode|toggle|paint|sculpt|undo|redo|history|transfer|new_scene")
# Operators that leave the same object active in its mode, whichever that is.
_KEEPING = re.compile(
    r"bpy\.ops\.(object\.(modifier_(add|remove|move\w*|apply|copy)|vertex_group_\w+|material_slot_\w+|constraint_add|"
    r"shade_\w+|shape_key_\w+|particle_system_\w+|origin_set|transform_apply|select_all)|rigidbody\.object_\w+|"
    r"transform\.(translate|rotate|resize)|anim\.keyframe_\w+|ed\.undo_push|wm\.save\w+)"
)
# Operators behind which no object is active where none was before.
_MAKING_NONE_ACTIVE = re.compile(
    r"bpy\.ops\.(object\.(select_all|delete|shade_\w+|transform_apply|origin_set|(location|rotation|scale|parent)_clear)|"
    r"transform\.(translate|rotate|resize)|outliner\.orphans_purge|ed\.undo_push|render\.render|export_\w+\.\w+|"
    r"ptcache\.\w+|wm\.(save\w*|\w+_export)|preferences\.\w+|screen\.\w+|(material|world|texture|image)\.new)"
)
_NEEDING_ACTIVE = frozenset({"active", "selected"})
# What enters a mode, or runs in it alone, and so tells which types of objects have it.
_HAVING = {
    "EDIT": EDIT_TOGGLE, "POSE": "bpy.ops.pose.transforms_clear",
    "SCULPT": "bpy.ops.sculpt.sculptmode_toggle", "VERTEX_PAINT": "bpy.ops.paint.vertex_paint_toggle",
    "WEIGHT_PAINT": "bpy.ops.paint.weight_paint_toggle", "TEXTURE_PAINT": "bpy.ops.paint.texture_paint_toggle",
}  # fmt: skip

# The modes of a type of objects that some versions lack, which may list them all the same.
_FORMER = re.compile(r"_(GPENCIL)$")

# Functions that need the mesh that they are given in Edit Mode.
_OF_EDITED = frozenset({"bmesh.from_edit_mesh", "bmesh.update_edit_mesh"})

# The modes in which operators are known to be refused: in those of paint and sculpture, masks let more run.
_FOLLOWED = frozenset({"OBJECT", "EDIT", "POSE"})


class Absence(IntEnum):
    """How surely no object is active. ``DELETED``: all that can be selected were, which leaves hidden ones."""

    UNKNOWN = 0
    DELETED = 1
    SURE = 2


@dataclass(frozen=True, slots=True)
class State:
    """The active object: its ``mode`` and its type, ``kind``; empty where they are not known; or its ``absence``.

    ``muted``: the call may not be come to, or the script is ready for its error.
    """

    mode: str = ""
    kind: str = ""
    muted: bool = False
    absence: Absence = Absence.UNKNOWN

    def joined(self, other: State) -> State:
        """What is known where two ways meet."""
        return State(
            self.mode if self.mode == other.mode else "",
            self.kind if self.kind == other.kind else "",
            self.muted or other.muted,
            min(self.absence, other.absence),
        )


UNKNOWN = State()


def modes_wanted(symbol: Symbol) -> Wanted | None:
    """The modes in which an operator or a function runs; None where any will do, or not all are known."""
    return Wanted(("EDIT",)) if symbol.path in _OF_EDITED else operator_active(symbol)[1]


def has_to_do_with_modes(call: CallSite) -> bool:
    """Whether a call is of an operator or a function that wants a mode, or enters one."""
    return call.callee.symbol.path in MODE_SET or modes_wanted(call.callee.symbol) is not None


def literal_argument(call: CallSite, name: str) -> object:
    """The literal that is given for a parameter, or its default; None where it is computed."""
    if (node := call.argument(name)) is not None:
        return node.value if isinstance(node, ast.Constant) else None
    return next((known.default for known in call.callee.parameters if known.name == name), None)


def refusal(script: Script, call: CallSite, state: State) -> str:
    """Why an operator is surely refused; empty if it is not."""
    symbol = call.callee.symbol
    if symbol.path in MODE_SET:
        return _no_such_mode(script, literal_argument(call, "mode"), state.kind)
    if symbol.path == EDIT_TOGGLE:
        return _no_such_mode(script, "EDIT", state.kind)
    modes = modes_wanted(symbol)
    if state.mode not in _FOLLOWED or modes is None or not _is_of_active(symbol, state):
        return ""
    if not modes.takes(state.mode):
        how = (
            f"does not run in {modes_text(modes.names)}"
            if modes.is_others
            else f"runs only in {modes_text(modes.names)}"
        )
        here = "" if modes.is_others else f" and the active object is in {modes_text([state.mode])} here"
        return f"{how},{here or ' which the active object is in here'}: {entering(modes)}"
    types, _ = operator_active(symbol)
    if types and state.kind and not modes.is_others and not types.takes(state.kind):
        return f"does not run with {with_article(state.kind)} object, which is the active one here"
    return ""


def keeps_active(path: str, *, is_edited: bool) -> bool:
    """Whether an operator leaves the same object active in its mode, which may be Edit Mode, and what is selected."""
    return bool(_KEEPING.fullmatch(path) or (is_edited and _EDITING.fullmatch(path)))


def lacks_active(call: CallSite, state: State) -> bool:
    """Whether an operator is refused because no object is active."""
    needs = call.callee.symbol.needs
    return state.absence > Absence.UNKNOWN and needs is not None and needs.active in _NEEDING_ACTIVE


def _is_of_active(operator: Symbol, state: State) -> bool:
    """Whether an operator works on the active object: those of poses take the armature that deforms it, too."""
    return state.kind == "ARMATURE" or not operator.path.startswith("bpy.ops.pose.")


def entering(modes: Wanted) -> str:
    """The call that enters a mode in which an operator runs."""
    return f"`bpy.ops.object.mode_set(mode={'OBJECT' if modes.is_others else modes.names[0]!r})` comes before"


def former_mode(script: Script, mode: object) -> str:
    """Why a mode is refused that only objects of a former type had; empty for others."""
    former = _FORMER.search(mode) if isinstance(mode, str) else None
    if not isinstance(mode, str) or former is None or _has_type(script, former[1]):
        return ""
    instead = mode.removesuffix(former[0])
    advice = f": write {instead!r}" if instead in _HAVING else ""
    return f"is refused: no object has mode {mode!r}, which was one of type {former[1]!r}{advice}"


def _no_such_mode(script: Script, mode: object, kind: str) -> str:
    if said := former_mode(script, mode):
        return said
    having = script.api.symbols.symbol(_HAVING[mode]) if isinstance(mode, str) and mode in _HAVING else None
    types, _ = operator_active(having) if having else (None, None)
    if types and kind and not types.takes(kind):
        return f"is refused: {with_article(kind)} object, which is the active one here, has no mode {mode!r}"
    return ""


def _has_type(script: Script, kind: str) -> bool:
    """Whether objects can be of a type."""
    symbol = script.api.symbols.symbol("bpy.types.Object.type")
    return symbol is None or any(item.identifier == kind for item in symbol.enum_items)


def modes_text(modes: Sequence[str]) -> str:
    """``Edit Mode or Weight Paint Mode``."""
    return " or ".join(f"{mode.replace('_', ' ').title()} Mode" for mode in modes)


def after_operator(call: CallSite, state: State) -> State:
    """What is known after an operator that was not refused."""
    path = call.callee.symbol.path
    after = _after_operator(call, path, state)
    if _MAKING_NONE_ACTIVE.fullmatch(path):
        return replace(after, absence=state.absence)
    is_emptying = path in (_FACTORY, _HOME) and literal_argument(call, "use_empty") is True
    if is_emptying and "app_template" not in call.given and not call.has_unpacking:
        return State("OBJECT", absence=Absence.SURE)
    return after


def _after_operator(call: CallSite, path: str, state: State) -> State:
    if path in MODE_SET:
        mode = literal_argument(call, "mode")
        return State(mode if isinstance(mode, str) and "toggle" not in call.given else "", state.kind)
    if path == EDIT_TOGGLE:
        return State({"OBJECT": "EDIT", "EDIT": "OBJECT"}.get(state.mode, ""), state.kind)
    if kind := next((kind for pattern, kind in _ADDED if pattern.fullmatch(path)), ""):
        return _after_adding(call, kind, state)
    if path == _FACTORY:
        return UNKNOWN if "app_template" in call.given or call.has_unpacking else State("OBJECT")
    return _after_working(call.callee.symbol, state)


def _after_working(operator: Symbol, state: State) -> State:
    """What an operator tells, which would have been refused in other modes; whether it leaves things as they are."""
    path, modes = operator.path, modes_wanted(operator)
    keeps = _KEEPING.fullmatch(path) is not None or (
        state.mode == "POSE" and path.startswith("bpy.ops.pose.")
    )
    if modes and not modes.is_others and len(modes.names) == 1:
        if modes.names[0] == "OBJECT":
            return State("OBJECT", state.kind if keeps else "")
        if _EDITING.fullmatch(path):
            types, _ = operator_active(operator)
            single = types.names[0] if types and not types.is_others and len(types.names) == 1 else state.kind
            return State(modes.names[0], single)
    stays = state.mode == "OBJECT" and _OF_SCENES.fullmatch(path) and not _SWITCHING.search(path)
    return state if keeps else State("OBJECT") if stays else UNKNOWN


def _after_adding(call: CallSite, kind: str, state: State) -> State:
    """Something that is added becomes the active object, or a part of the edited one of its type."""
    enters = literal_argument(call, "enter_editmode")
    if call.has_unpacking or (enters is None and "enter_editmode" in call.given):
        return State("", kind)
    if enters:
        return State("EDIT", kind)
    modes = modes_wanted(call.callee.symbol)
    if state.mode == "OBJECT" or (modes is not None and modes == Wanted(("OBJECT",))):
        return State("OBJECT", kind)
    if state.mode == "EDIT" and state.kind:
        return State("EDIT" if state.kind == kind else "OBJECT", kind)
    return State("", kind)
