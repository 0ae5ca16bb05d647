"""Names of Blender's API that much else is spelled with."""

from __future__ import annotations

import re

TYPES = "bpy.types."
OPERATORS = "bpy.ops."
HANDLERS = "bpy.app.handlers."

STRUCT = f"{TYPES}bpy_struct"
COLLECTION = f"{TYPES}bpy_prop_collection"
GROUPS = f"{TYPES}bpy_prop_collection_idprop"
ID = f"{TYPES}ID"
NODE = f"{TYPES}Node"
OBJECT = f"{TYPES}Object"
CONTEXT = f"{TYPES}Context"
BLEND_DATA = f"{TYPES}BlendData"
# What lets a Blender without a window draw, since 5.2.
BEGIN_DRAWING = "gpu.init"

# The verbs by which functions and operators are called that take something away.
REMOVING_VERBS = frozenset({"clear", "delete", "discard", "free", "remove", "unassign", "unlink"})

# What every operator of ``bpy.ops`` has as an attribute.
OPERATOR_METHODS = frozenset({"poll", "idname", "idname_py", "get_rna_type", "bl_options"})
# What makes a socket of a group, and an input of the modifier that runs it.
NEW_SOCKET = f"{TYPES}NodeTreeInterface.new_socket"

# Where a node has its sockets.
SIDES = ("inputs", "outputs")

# Panels, menus, headers, operators, lists, asset shelves, gizmos and their groups, file handlers, keying sets, engines.
_OF_INTERFACE = re.compile(r"(?:bpy\.types\.)?[A-Z0-9_]+_(PT|MT|HT|OT|UL|AST|GGT|GT|FH|KSI|RE)_")


def interface_part(path: str) -> str:
    """What a class, given by its name or path, is of the interface: ``PT`` of ``VIEW3D_PT_tools``; empty for others.

    A member is of what its class is.
    """
    found = _OF_INTERFACE.match(path)
    return found[1] if found else ""


# Operators that take the active object and the selected ones from the view layer, whichever the context is given.
# Those that change the mode take the active object alone.
CHANGING_MODE = frozenset(
    {
        "bpy.ops.object.editmode_toggle",
        "bpy.ops.object.mode_set",
        "bpy.ops.object.mode_set_with_submode",
        "bpy.ops.sculpt.sculptmode_toggle",
    }
)
OF_SELECTED = frozenset(
    {
        "bpy.ops.object.location_clear",
        "bpy.ops.object.material_slot_remove_all",
        "bpy.ops.object.material_slot_remove_unused",
        "bpy.ops.object.rotation_clear",
        "bpy.ops.object.scale_clear",
    }
)
