"""Messages of modifiers and transforms that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_O = "bpy.ops.object."
MODIFIERS = (
    NamelessMessage(
        ("Modifier cannot be applied to a mesh with shape keys",),
        (f"{_O}modifier_apply", f"{T}Object.shape_key_clear"),
        "Remove the shape keys first (`obj.shape_key_clear()`), or make a mesh of the result: "
        "`bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph))`.",
    ),
    NamelessMessage(
        ("Modifier is disabled, skipping apply",),
        (f"{_O}modifier_apply", f"{T}Modifier.show_viewport"),
        "The modifier lacks what it works with (a Boolean without an object), or is not shown: "
        "`modifier.show_viewport = True`.",
    ),
    NamelessMessage(
        ("Modifiers cannot be applied to multi-user data",),
        (f"{_O}modifier_apply",),
        "Give the object data of its own first: `obj.data = obj.data.copy()`.",
    ),
    NamelessMessage(
        ("Cannot apply to a multi user",),
        (f"{_O}transform_apply",),
        "Give the object data of its own first: `obj.data = obj.data.copy()`.",
    ),
    NamelessMessage(
        ("value to the existing 'Socket_", "IDProperty"),
        (f"{T}NodesModifier",),
        "An input of a geometry nodes modifier keeps its type: give a value of that type.",
    ),
)
