"""What add-ons write in several places, none of which names the others: classes in order, preferences, modal calls."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES
from kb_serve.answer.known.told_of import Advice, of, stems

_PROPS = "bpy.props."
_MANAGER = f"{TYPES}WindowManager"

_READS = stems("access get inside own package read")

_IN_ORDER = (
    "A group is registered before what has it: `bpy.utils.register_class(Item)`, then "
    "`bpy.utils.register_class(Group)` of a `Group` with `items: bpy.props.CollectionProperty(type=Item)`, then "
    "`bpy.types.Scene.group = bpy.props.PointerProperty(type=Group)`."
)
_OWN_PREFERENCES = (
    "`bpy.context.preferences.addons[__package__].preferences`, with `bl_idname = __package__` in the class: the "
    "package of an extension is called `bl_ext.user_default.name`, so that its name alone is not found. Of an add-on "
    "that is a single file, write `__name__` for `__package__`."
)
_MODAL = (
    "`invoke()` ends with `context.window_manager.modal_handler_add(self)` and `return {'RUNNING_MODAL'}`; Blender "
    "calls `modal(self, context, event)` from then on, until that returns `{'FINISHED'}` or `{'CANCELLED'}`."
)
_TIMED = (
    " With `self.timer = context.window_manager.event_timer_add(0.1, window=context.window)` before, it also gets an "
    "`event.type` of 'TIMER'; at its end, `context.window_manager.event_timer_remove(self.timer)`."
)
_CHOOSES_FILE = (
    "`invoke()` ends with `context.window_manager.fileselect_add(self)` and `return {'RUNNING_MODAL'}`; `execute()` "
    "runs when a file was chosen, which is in the operator's own "
    "`filepath: bpy.props.StringProperty(subtype='FILE_PATH')`."
)

ADDON_SENTENCES: tuple[Advice, ...] = (
    Advice(
        _IN_ORDER,
        frozenset({f"{_PROPS}CollectionProperty", f"{_PROPS}PointerProperty"}) | of("PropertyGroup"),
        asked=stems("before first inside nested order register registration"),
    ),
    Advice(
        _OWN_PREFERENCES,
        of("Addon.preferences", "AddonPreferences", "AddonPreferences.bl_idname", "Preferences.addons"),
        about=_READS,
        wherever=(stems("addon addons extension"), stems("preferences"), _READS),
    ),
    Advice(_MODAL + _TIMED, frozenset({f"{_MANAGER}.event_timer_add"}), asked=stems("modal operator timer")),
    Advice(_MODAL, frozenset({f"{_MANAGER}.modal_handler_add"}) | of("Operator.modal")),
    Advice(_CHOOSES_FILE, frozenset({f"{_MANAGER}.fileselect_add"})),
)
