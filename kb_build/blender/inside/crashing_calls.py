# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds functions outside RNA that crash Blender: operators of ``bmesh.ops``, and functions of ``bpy.app``.

The operators get all elements of a cube for what takes several, and nothing else: what Python cannot give them is
missing. What crashes is called again, with an element for a keyword that takes one. The functions are called with none.
"""

import types
from contextlib import suppress
from functools import partial

import bmesh
import bpy

from .apart import crashes, ended_at
from .bmesh_operators import UNUSABLE, parameters

ELEMENTS = ("BMVert", "BMEdge", "BMFace")


def call(operator, name=""):
    """Calls an operator for a cube; an element is given for the keyword of that name, if any."""
    mesh = bmesh.new()
    bmesh.ops.create_cube(mesh, size=1)
    elements = [*mesh.verts, *mesh.edges, *mesh.faces]
    given = {}
    for row in parameters(operator):
        fitting = [element for element in elements if type(element).__name__ in row["type"]]
        if row["type"].startswith("Sequence["):
            given[row["name"]] = fitting
        elif row["name"] == name:
            given[name] = fitting[0]
    with suppress(Exception):
        operator(mesh, **given)


def cause(operator):
    """What is to be said of the crash; nothing where it is not known what it is of.

    ``left_out``: what prevents it; ``every``: that nothing can, as Python cannot give what is missing.
    """
    if not crashes(partial(call, operator)):
        return {}
    rows = parameters(operator)
    names = [row["name"] for row in rows if row["type"] in ELEMENTS]
    if preventing := [name for name in names if not crashes(partial(call, operator, name))]:
        return {"left_out": preventing}
    return {"every": True} if any(row.get("description") == UNUSABLE for row in rows) else {}


def call_alone(function):
    """Calls a function with nothing."""
    with suppress(Exception):
        function()


def find_all(write):
    """One ``crashes`` record for each. Wants a system that can work apart."""
    # An operator has no name of its own, but the very text by which it was asked for: the keys keep it.
    members = {name: getattr(bmesh.ops, name) for name in sorted(dir(bmesh.ops))}
    operators = {name: value for name, value in members.items() if type(value).__name__ == "BMeshOpFunc"}
    for name in ended_at(operators, lambda name: call(operators[name])):
        if causes := cause(operators[name]):
            write("crashes", path=f"bmesh.ops.{name}", **causes)
    for name in sorted(dir(bpy.app)) if getattr(bpy.app, "module", False) else ():
        function = getattr(bpy.app, name)
        if isinstance(function, types.BuiltinFunctionType) and crashes(partial(call_alone, function)):
            write("crashes", path=f"bpy.app.{name}", in_module=True)
