# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what a script can set on its own property groups, whatever RNA says of the class that they derive from.

Since 5.3 RNA calls ``PropertyGroup.name`` read-only, and gives each class that a script registers a ``name`` of its
own, which is not. No instance is of the bare class.
"""

import functools

import bpy

from ..apart import can_work_apart, sent_apart

GROUP = "PropertyGroup"


def register_and_look(send):
    """Registers a group without properties, and sends the names of those that it has beside what it inherits."""
    own = type("OwnGroup", (bpy.types.PropertyGroup,), {})
    bpy.utils.register_class(own)
    inherited = {prop.as_pointer() for prop in bpy.types.PropertyGroup.bl_rna.properties}
    for prop in own.bl_rna.properties:
        if prop.as_pointer() not in inherited and not prop.is_readonly:
            send(prop.identifier)


@functools.cache
def settable():
    """The names of these properties. Wants a system that can work apart: a class that was registered leaves traces."""
    return frozenset(sent_apart(register_and_look)[1]) if can_work_apart() else frozenset()
