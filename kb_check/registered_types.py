"""What Blender demands of the classes that scripts register.

RNA says which functions of a type it looks for in a class (``bpy.types.Function.is_registered``, and
``is_registered_optional`` for those that a class may lack); what else a class must have was found by registering one
without it, in each version from 4.2 to 5.2. How many arguments a function gets is in the base, as are the values of
attributes.
"""

from __future__ import annotations

from dataclasses import dataclass

from kb_build.flow.facts import T


@dataclass(frozen=True, slots=True)
class RegisteredType:
    """One of Blender's types that scripts derive classes from.

    ``needs`` are the attributes and functions without which a class is refused, ``callbacks`` all functions whose
    arguments are counted. ``makes_properties``: annotations become properties, which other types only drop.
    """

    needs: tuple[str, ...] = ()
    callbacks: tuple[str, ...] = ()
    makes_properties: bool = False


_OPERATOR = RegisteredType(
    ("bl_idname", "bl_label"),
    ("poll", "execute", "check", "invoke", "modal", "draw", "cancel", "description"),
    makes_properties=True,
)
_NODE = (
    "poll", "poll_instance", "update", "insert_link", "init", "copy", "free", "draw_buttons", "draw_buttons_ext",
    "draw_label",
)  # fmt: skip
_RENDER_ENGINE = (
    "update", "render", "render_frame_finish", "draw", "bake", "view_update", "view_draw", "update_script_node",
    "update_render_passes", "update_custom_camera",
)  # fmt: skip
_GIZMO = ("draw", "draw_select", "test_select", "modal", "setup", "invoke", "exit", "select_refresh")
_GIZMO_GROUP = ("poll", "setup_keymap", "setup", "refresh", "draw_prepare", "invoke_prepare")

TYPES = {
    f"{T}AddonPreferences": RegisteredType(makes_properties=True),
    f"{T}AssetShelf": RegisteredType(
        ("bl_space_type",), ("poll", "asset_poll", "get_active_asset", "draw_context_menu")
    ),
    f"{T}FileHandler": RegisteredType(("bl_label", "bl_file_extensions"), ("poll_drop",)),
    f"{T}Gizmo": RegisteredType(("draw",), _GIZMO, makes_properties=True),
    f"{T}GizmoGroup": RegisteredType(
        ("bl_label", "bl_space_type", "bl_region_type", "setup"), _GIZMO_GROUP, makes_properties=True
    ),
    f"{T}Header": RegisteredType(("bl_space_type", "draw"), ("draw",)),
    f"{T}KeyingSetInfo": RegisteredType(
        ("bl_label", "poll", "iterator", "generate"), ("poll", "iterator", "generate")
    ),
    f"{T}Macro": RegisteredType(("bl_idname", "bl_label"), ("poll", "draw"), makes_properties=True),
    f"{T}Menu": RegisteredType(("bl_label", "draw"), ("poll", "draw")),
    f"{T}Node": RegisteredType(("bl_label",), _NODE, makes_properties=True),
    f"{T}NodeSocket": RegisteredType(
        ("draw",), ("draw", "draw_color", "draw_color_simple"), makes_properties=True
    ),
    f"{T}NodeTree": RegisteredType(
        ("bl_label", "bl_icon"), ("poll", "update", "get_from_context", "valid_socket_type"), makes_properties=True
    ),
    f"{T}Operator": _OPERATOR,
    f"{T}Panel": RegisteredType(
        ("bl_label", "bl_space_type", "bl_region_type", "draw"),
        ("poll", "draw", "draw_header", "draw_header_preset"),
    ),
    f"{T}PropertyGroup": RegisteredType(makes_properties=True),
    f"{T}RenderEngine": RegisteredType(("bl_label",), _RENDER_ENGINE),
    f"{T}UIList": RegisteredType((), ("draw_item", "draw_filter", "filter_items"), makes_properties=True),
}  # fmt: skip

# Functions that may take fewer arguments than they get, and the fewest, with ``self``.
FEWEST_ARGUMENTS = {f"{T}UIList.draw_item": 7}
