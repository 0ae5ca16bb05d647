# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds functions written in C that take no argument by its name, though their documentation names them.

They refuse a call with any keyword before they look at what is given.
"""

import functools
import types

import bmesh
import mathutils

NO_KEYWORDS = "no-keywords"
REFUSED = "takes no keyword arguments"
NO_NAME = {"no argument's name": None}


@functools.cache
def instances():
    """Class → an instance, of the classes whose methods can only be asked on one."""
    mesh = bmesh.new()
    corners = [mesh.verts.new(place) for place in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    face = mesh.faces.new(corners)
    loop = face.loops[0]
    made = [mesh, corners[0], mesh.edges[:][0], face, loop, mesh.verts, mesh.edges, mesh.faces, face.loops]
    made += [
        mesh.select_history,
        mesh.verts.layers,
        mesh.verts.layers.float,
        mathutils.Vector(),
        mathutils.Euler(),
    ]
    made += [mathutils.Matrix(), mathutils.Quaternion(), mathutils.Color()]
    return {type(one): one for one in made}


def flags_of(function):
    """The flag of a function that takes no keywords; none for others, and for what cannot be asked."""
    if not isinstance(function, types.BuiltinFunctionType):
        return []
    try:
        function(**NO_NAME)
    except TypeError as refusal:
        return [NO_KEYWORDS] if REFUSED in str(refusal) else []
    except Exception:
        return []
    return []


def flags_of_method(cls, name):
    """The same of a class's method."""
    instance = instances().get(cls)
    return flags_of(getattr(instance, name, None)) if instance is not None else []
