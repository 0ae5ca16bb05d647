"""What Blender has at times, and what it takes, without listing it: no base can tell."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

# Names that are there at times, which no base can tell: owner → patterns. An official build has the 3D mouse, the bpy
# package has not; only Windows has a console to toggle; a layout gives its buttons pointers by context_pointer_set, in
# Blender's own scripts and in C.
SOMETIMES = {
    "bpy.types.PreferencesInput": ("ndof_*",),
    "bpy.ops.wm": ("console_toggle",),
    "bpy.types.Context": (
        "animated_id", "asset_shelf", "button_operator", "button_pointer", "button_prop", "collection", "constraint",
        "exporter", "extension_repo", "freestyle_module", "gpencil_modifier", "grease_pencil", "id", "keyconfig",
        "keymap", "material_slot", "modifier", "nla_strip", "point_cache", "pointcloud", "shaderfx", "socket", "state",
        "tool", "viewer_path",
    ),
}  # fmt: skip

# Values that work and are not listed: batch_for_shader hands its type on to gpu.types.GPUBatch, which has two more; the
# display without a colour configuration is called NONE; a liquid's domain makes particles of types of their own.
MORE_VALUES = {
    "bpy.types.ParticleSettings.type": (
        "FLIP", "SPRAY", "FOAM", "BUBBLE", "TRACER", "SPRAYFOAM", "SPRAYBUBBLE", "FOAMBUBBLE", "SPRAYFOAMBUBBLE",
    ),
    "gpu_extras.batch.batch_for_shader(type)": ("LINE_LOOP", "TRI_FAN"),
    "bpy.types.ColorManagedDisplaySettings.display_device": ("NONE",),
}  # fmt: skip

# Enumerations with values that are called as something in the file: a pass of one's own, a layer's Cryptomatte.
NAMED_IN_FILES = frozenset(
    {"bpy.types.View3DShading.render_pass", "bpy.types.CompositorNodeCryptomatteV2.layer_name"}
)

# Values that stand in for those which Blender makes while it runs.
STAND_INS = frozenset({"NONE", "DEFAULT", "PLACEHOLDER", "UNSUPPORTED"})
FEWEST_VALUES = 2  # of an enumeration that can be judged: of fewer, Blender tells but a stand-in

# What a Blender may be built without, and which operators it then lacks, by their names.
OPTIONS = "bpy.app.build_options."
_OPERATOR = re.compile(r"bpy\.ops\.\w+\.([a-z0-9_]+)")
# Words of operators for libraries that are called otherwise.
_LIBRARIES = {"pdf": "haru"}


def option_of(operator: str, options: Collection[str]) -> str:
    """The path of the option that an operator needs, of the names of all options; empty for none that its name tells.

    An option is told by its first word, if no other begins so: ``xr_openxr`` of ``xr_navigation_grab``.
    """
    found = _OPERATOR.fullmatch(operator)
    if found is None:
        return ""
    words = found[1].split("_")
    if (library := _LIBRARIES.get(words[-1])) in options:
        return f"{OPTIONS}{library}"
    beginning = Counter(option.partition("_")[0] for option in options)
    wanted = (option for option in options if option.partition("_")[0] == words[0])
    return next((OPTIONS + option for option in wanted if beginning[words[0]] == 1), "")
