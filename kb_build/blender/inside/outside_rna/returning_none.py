# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds methods of ``mathutils`` that change their value in place and return None: each is called.

References tell what functions return, and of those that return nothing only that they do not tell.
"""

import types

import mathutils

VALUES = (
    lambda: mathutils.Vector((1, 2, 3)),
    lambda: mathutils.Matrix.Identity(4),
    lambda: mathutils.Euler((1, 2, 3)),
    lambda: mathutils.Quaternion((1, 0, 0, 0)),
    lambda: mathutils.Color((1, 0, 0)),
)
# What is given: the first of these that a method takes.
ARGUMENTS = ((), (mathutils.Euler(),), (3,), ("X", 1.0), (mathutils.Quaternion(),))


def is_none(make, name):
    """Whether a method of a new value returns None; False where it takes none of the arguments."""
    for arguments in ARGUMENTS:
        try:
            return getattr(make(), name)(*arguments) is None
        except (TypeError, ValueError):
            continue
    return False


def find_all(write):
    """One ``returns_none`` record for each such method."""
    for make in VALUES:
        cls = type(make())
        for name, member in sorted(vars(cls).items()):
            is_method = isinstance(member, types.MethodDescriptorType) and not name.startswith("_")
            if is_method and is_none(make, name):
                write("returns_none", path=f"mathutils.{cls.__name__}.{name}")
