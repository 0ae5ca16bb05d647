# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what operators that add an object take for its place and size where these are left out.

RNA has zeros as defaults, which the operators tell from zeros that are given.
"""

import json
import tempfile

import bpy

from .apart import apart
from .new_things import scratch_scene

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
    """Argument → what it is where it is left out, of those of which RNA tells another value."""
    names = operator.get_rna_type().properties.keys()
    if "location" not in names:
        return {}
    obj = added(operator, {})
    if obj is None:
        return {}
    found = {"location": AT_CURSOR} if tuple(obj.location) == CURSOR else {}
    if "scale" in names:
        own = shape(obj)
        if shape(added(operator, {"scale": (1, 1, 1)})) == own and any(obj.scale):
            found["scale"] = AS_ONE
    return found


def find_all(write):
    """One ``left_out`` record for each such argument. Wants a system that can work apart."""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as file:

        def work():
            for module in MODULES:
                for name in sorted(dir(getattr(bpy.ops, module))):
                    try:
                        found = look(getattr(getattr(bpy.ops, module), name))
                    except Exception:
                        continue
                    for argument, value in found.items():
                        row = {"path": f"bpy.ops.{module}.{name}", "argument": argument, "value": value}
                        file.write(json.dumps(row) + "\n")
                        file.flush()
            return True

        apart(work)
        file.seek(0)
        for line in file:
            write("left_out", **json.loads(line))
