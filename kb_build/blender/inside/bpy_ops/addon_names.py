# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what the add-ons that Blender brings, and that are not on from the start, register once they are enabled.

Some put the names of their operators together: only Blender with the add-on in it can tell them.
"""

import contextlib
import functools
import io

import addon_utils
import bpy

from .operators import operator_names

TYPES, OPERATORS = "bpy.types", "bpy.ops"


def types():
    """The paths of all classes."""
    return {f"{TYPES}.{name}" for name in dir(bpy.types)}


def operators():
    """The paths of all operators and of their modules."""
    names = operator_names()
    own = {f"{OPERATORS}.{module}.{name}" for module in names for name in names[module]}
    return own | {f"{OPERATORS}.{module}" for module in names}


def properties(classes):
    """The paths of the properties of classes, each of the class that has it first."""

    @functools.cache
    def names(rna):
        return {*rna.properties.keys()}

    found = set()
    for path in classes:
        rna = getattr(getattr(bpy.types, path.rpartition(".")[2]), "bl_rna", None)
        if rna is not None:
            inherited = names(rna.base) if rna.base else set()
            found |= {f"{path}.{name}" for name in names(rna) - inherited}
    return found


def write_all(write):
    """Writes what each add-on adds, where it adds something. Blender has them all from then on."""
    classes = types()
    before = classes | operators() | properties(classes)
    for name in sorted(module.__name__ for module in addon_utils.modules()):
        if addon_utils.check(name)[1]:
            continue
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            addon_utils.enable(name, default_set=True)
        classes_now = types()
        now = classes_now | operators() | properties(classes)
        if now - before:
            write("addon", name=name, paths=sorted(now - before))
        # What the new classes have is told with their names.
        before, classes = now | properties(classes_now - classes), classes_now
