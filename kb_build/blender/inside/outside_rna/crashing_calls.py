# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds functions outside RNA that crash Blender: operators of ``bmesh.ops``, functions of ``bpy.app``, and what pops
up a menu where there is no window.

The operators get all elements of a cube for what takes several, and nothing else: what Python cannot give them is
missing. What crashes is called again, with an element for a keyword that takes one. The functions are called with none.
"""

import inspect
import types
from contextlib import suppress
from functools import partial

import bmesh
import bpy

from ..apart import crashes, ended_at
from .bmesh_operators import UNUSABLE, parameters

ELEMENTS = ("BMVert", "BMEdge", "BMFace")
# What a function that pops something up calls to draw it, and what an operator finds it by.
DRAWING, NAMED = "draw_func", "name"


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


def show_all(operator):
    """Shows each menu and panel there is by an operator; those that do not belong here are refused."""
    for kind in (bpy.types.Menu, bpy.types.Panel):
        for shown in kind.__subclasses__():
            with suppress(Exception):
                operator(**{NAMED: shown.__name__})


def popping_up():
    """(path, call) of what pops something up: methods, given how it is drawn, and operators, given its name."""
    manager = bpy.context.window_manager
    for name, value in vars(bpy.types.WindowManager).items():
        if inspect.isfunction(value) and DRAWING in inspect.signature(value).parameters:
            yield f"bpy.types.WindowManager.{name}", partial(getattr(manager, name), lambda *_: None)
    for name in dir(bpy.ops.wm):
        operator = getattr(bpy.ops.wm, name)
        if name.startswith("call_") and NAMED in operator.get_rna_type().properties:
            yield f"bpy.ops.wm.{name}", partial(show_all, operator)


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
    for path, pop_up in popping_up() if bpy.app.background else ():
        if crashes(partial(call_alone, pop_up)):
            write("crashes", path=path, always=True)
