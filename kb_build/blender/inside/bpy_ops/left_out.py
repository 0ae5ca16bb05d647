# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what operators that add an object take for its place and size where these are left out.

RNA has zeros as defaults, which the operators tell from zeros that are given. Found on the way: which of them add an
object whose data RNA has no class for, as a version has of a kind of data that it does not use yet.
"""

import bpy

from ..apart import sent_apart
from ..instances.making import scratch_scene

MODULES = ("curve", "mesh", "object", "surface")
CURSOR = (1.0, 2.0, 3.0)
AT_CURSOR = "the 3D cursor's"
AS_ONE = "(1, 1, 1)"


def added(operator, given):
    """The object that an operator adds to a new scene with the cursor elsewhere; None where it adds none."""
    scratch_scene()
    bpy.context.scene.cursor.location = CURSOR
    before = set(bpy.context.scene.objects)
    operator(**given)
    new = [obj for obj in bpy.context.scene.objects if obj not in before]
    bpy.context.view_layer.update()
    return new[0] if new else None


def shape(obj):
    """What an object's size shows in."""
    return [*(round(size, 4) for size in obj.dimensions), *(round(size, 4) for size in obj.scale)]


def look(operator):
    """Whether the data of what an operator adds have no class; argument → what it is where it is left out, of those of
    which RNA tells another value.
    """
    names = operator.get_rna_type().properties.keys()
    if "location" not in names:
        return False, {}
    obj = added(operator, {})
    if obj is None:
        return False, {}
    is_bare = type(obj.data) is bpy.types.ID
    found = {"location": AT_CURSOR} if tuple(obj.location) == CURSOR else {}
    if "scale" in names:
        own = shape(obj)
        if shape(added(operator, {"scale": (1, 1, 1)})) == own and any(obj.scale):
            found["scale"] = AS_ONE
    return is_bare, found


def look_at_all(send):
    """Looks at the operators of all modules that have some which add objects."""
    for module in MODULES:
        for name in sorted(dir(getattr(bpy.ops, module))):
            try:
                is_bare, found = look(getattr(getattr(bpy.ops, module), name))
            except Exception:
                continue
            if is_bare:
                send({"path": f"bpy.ops.{module}.{name}"})
            for argument, value in found.items():
                send({"path": f"bpy.ops.{module}.{name}", "argument": argument, "value": value})


def find_all(write):
    """One ``left_out`` record for each such argument, one ``bare_data`` for each operator that makes such data.

    Wants a system that can work apart.
    """
    for row in sent_apart(look_at_all)[1]:
        write("left_out" if "argument" in row else "bare_data", **row)
