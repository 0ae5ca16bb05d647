# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the operators that end Blender while there is no undo step, as there is none in a Blender without a window.

Those that run only in a mode of a mesh object are called there, one after the other in a process of its own, and the
rest in another one where that ends. What ended it is called alone, and once more behind an undo step that was made
before the mode was entered.
"""

from contextlib import suppress

import bpy

from ..apart import apart, ended_at
from ..instances.making import activate, mesh_object, remove
from .active_objects import can_run, modes
from .operator_needs import operators

CALL = "bpy.ops.ed.undo_push()"


def is_survived(operator):
    """Whether Blender goes on after an operator was called here and now, whatever comes of it."""

    def work():
        with suppress(Exception):
            operator()
        return True

    return apart(work)


def is_survived_with_step(operator, mode):
    """The same behind an undo step from before the mode."""

    def work():
        bpy.ops.object.mode_set(mode="OBJECT")
        bpy.ops.ed.undo_push()
        bpy.ops.object.mode_set(mode=mode)
        with suppress(Exception):
            operator()
        return True

    return apart(work)


def ending(left, paths, mode):
    """Those of these operators at which a process that calls all of them ends."""
    obj = bpy.context.object

    def run(path):
        with suppress(Exception):
            if obj.mode != mode:
                bpy.ops.object.mode_set(mode=mode)
            left[path]()

    return ended_at(paths, run)


def find_all(write):
    """One ``undo_step`` record for each such operator. Wants a system that can work apart."""
    left = operators()
    obj = mesh_object()
    activate(obj)
    obj.select_set(True)
    for mode in modes(obj):
        here = can_run(left)
        # Some change what the next ones find: each comes after and before each other.
        orders = (here, here[::-1]) if mode != "OBJECT" else ()
        for path in sorted({path for paths in orders for path in ending(left, paths, mode)}):
            if not is_survived(left[path]) and is_survived_with_step(left[path], mode):
                write("undo_step", path=path, before=CALL)
        for path in here:
            del left[path]
    remove(obj)
