"""What scripts import of modules: the names that hardly anything else is called by, and the lines for them."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from kb_check.script import Script

# Module → what scripts take from it by name.
_TAKEN: dict[str, tuple[str, ...]] = {
    "mathutils": ("Color", "Euler", "Matrix", "Quaternion", "Vector"),
    "mathutils.bvhtree": ("BVHTree",),
    "mathutils.kdtree": ("KDTree",),
    "bpy.props": (
        "BoolProperty", "BoolVectorProperty", "CollectionProperty", "EnumProperty", "FloatProperty",
        "FloatVectorProperty", "IntProperty", "IntVectorProperty", "PointerProperty", "StringProperty",
    ),
    "bpy.utils": ("register_class", "register_classes_factory", "unregister_class"),
    "bpy.app.handlers": ("persistent",),
    "bpy_extras.io_utils": ("ExportHelper", "ImportHelper", "axis_conversion"),
    "bpy_extras.object_utils": ("AddObjectHelper", "object_data_add", "world_to_camera_view"),
    "gpu_extras.batch": ("batch_for_shader",),
    "math": ("acos", "asin", "atan", "atan2", "cos", "degrees", "pi", "radians", "sin", "sqrt", "tan"),
    "pathlib": ("Path",),
}  # fmt: skip
# Classes that scripts derive theirs from.
_BASES = frozenset(
    {
        "AddonPreferences", "Gizmo", "GizmoGroup", "Header", "KeyingSetInfo", "Menu", "NodeTree", "Operator", "Panel",
        "PropertyGroup", "RenderEngine", "UIList", "WorkSpaceTool",
    }
)  # fmt: skip
# Modules of Blender's, and of Python's, that scripts name as a whole.
_OF_BLENDER = frozenset({"addon_utils", "bgl", "bl_math", "blf", "bmesh", "bpy_extras", "gpu", "mathutils"})
_OF_PYTHON = frozenset(
    {
        "datetime",
        "functools",
        "itertools",
        "json",
        "math",
        "os",
        "random",
        "re",
        "shutil",
        "subprocess",
        "sys",
        "time",
    }
)
_AMBIGUOUS = frozenset({"math", "pathlib"})  # numpy has such functions, other packages such classes
_FOREIGN = {"np": "numpy"}
_TYPES = "bpy.types"


@dataclass(frozen=True, slots=True)
class Import:
    """What a name stands for: a module, under that name, or what one has that is called so."""

    module: str
    alias: str = ""

    def line(self, names: Sequence[str]) -> str:
        """The line that imports it, with other names of its module."""
        if not self.alias:
            return f"from {self.module} import {', '.join(names)}"
        return f"import {self.module}" + (f" as {self.alias}" if self.alias != self.module else "")

    @property
    def is_sure(self) -> bool:
        """Whether nothing else is likely to be meant."""
        return bool(self.alias) or self.module not in _AMBIGUOUS


def import_of(script: Script, name: str, attributes: Collection[str]) -> Import | None:
    """What a name usually stands for; None where that is not known, or this Blender lacks it.

    ``attributes`` are those that the script reads from it: a module has all of them.
    """
    known = script.api.symbols.symbol
    for module, names in _TAKEN.items():
        if name in names and (module in sys.stdlib_module_names or known(f"{module}.{name}")):
            return Import(module)
    if name in _BASES and known(f"{_TYPES}.{name}"):
        return Import(_TYPES)
    is_module = name in _OF_BLENDER and all(known(f"{name}.{attribute}") for attribute in attributes)
    if name in _OF_PYTHON:
        is_module = {*attributes} <= {*dir(import_module(name))}
    if not attributes or not (is_module or name in _FOREIGN):
        return None
    return Import(_FOREIGN.get(name, name), name)
