# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what the add-ons that Blender brings, and that are not on from the start, register once they are enabled.

Some put the names of their operators together: only Blender with the add-on in it can tell them.
"""

import contextlib
import io

import addon_utils
import bpy

TYPES, OPERATORS = "bpy.types", "bpy.ops"


def types():
    """The paths of all classes."""
    return {f"{TYPES}.{name}" for name in dir(bpy.types)}


def operators():
    """The paths of all operators and of their modules."""
    modules = dir(bpy.ops)
    own = {f"{OPERATORS}.{module}.{name}" for module in modules for name in dir(getattr(bpy.ops, module))}
    return own | {f"{OPERATORS}.{module}" for module in modules}


def properties(classes):
    """The paths of the properties of classes, each of the class that has it first."""
    found = set()
    for path in classes:
        rna = getattr(getattr(bpy.types, path.rpartition(".")[2]), "bl_rna", None)
        if rna is not None:
            inherited = rna.base.properties if rna.base else ()
            names = {prop.identifier for prop in rna.properties} - {prop.identifier for prop in inherited}
            found |= {f"{path}.{name}" for name in names}
    return found


def write_all(write):
    """Writes what each add-on adds, where it adds something. Blender has them all from then on."""
    for name in sorted(module.__name__ for module in addon_utils.modules()):
        if addon_utils.check(name)[1]:
            continue
        classes = types()
        before = classes | operators() | properties(classes)
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            addon_utils.enable(name, default_set=True)
        added = (types() | operators() | properties(classes)) - before
        if added:
            write("addon", name=name, paths=sorted(added))
