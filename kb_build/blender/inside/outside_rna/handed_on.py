# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds which texts functions written in Python take, where they hand an argument on to a function that RNA lists:
``popup_menu(icon=…)`` takes the icons of what it calls.
"""

import ast
import inspect
import textwrap
import types

import bpy

OWN_MODULES = frozenset(
    {"_bpy_types", "bpy_types"}
)  # in which Blender defines what its classes have in Python


def functions(structs):
    """(path, function, RNA of its class) of the functions that Blender adds to its classes in Python."""
    for identifier, rna in structs.items():
        cls = getattr(bpy.types, identifier, None)
        if getattr(cls, "__module__", "") in OWN_MODULES:
            for name, value in vars(cls).items():
                if isinstance(value, types.FunctionType) and not name.startswith("_"):
                    yield f"bpy.types.{identifier}.{name}", value, rna


def handed(function):
    """(argument, method of the same thing, parameter of that) of what a function hands on under a name."""
    own, *arguments = inspect.signature(function).parameters
    for node in ast.walk(ast.parse(textwrap.dedent(inspect.getsource(function)))):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id=thing), attr=method)) if thing == own:
                for keyword in node.keywords:
                    if isinstance(keyword.value, ast.Name) and keyword.value.id in arguments:
                        yield keyword.value.id, method, keyword.arg


def find_all(write, structs):
    """One ``texts_taken`` record for each argument, with its ``items``."""
    for path, function, rna in functions(structs):
        for argument, method, name in handed(function):
            called = rna.functions.get(method)
            parameter = called.parameters.get(name) if called is not None else None
            if parameter is not None and parameter.type == "ENUM" and not parameter.is_enum_flag:
                items = [item.identifier for item in parameter.enum_items]
                write("texts_taken", path=path, argument=argument, items=items)
