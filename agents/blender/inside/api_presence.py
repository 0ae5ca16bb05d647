# SPDX-License-Identifier: GPL-3.0-or-later
"""Which paths of the API the running Blender has: add-ons and earlier code may have registered more than a knowledge
base knows.

A path is ``bpy.types.Object.name``, ``bpy.ops.object.name``, ``mathutils.name``; ``(parameter)`` names a parameter of a
function or operator, ``:VALUE`` a value of an enumeration. Looking reads no property of any data.
"""

import importlib.util
import sys

import bpy


def present(arguments, report):
    """For each of ``paths``, whether it exists. What cannot be told does not."""
    del report
    return [_exists(path) for path in arguments["paths"]]


def _exists(path):
    path, _, value = path.partition(":")
    path, _, parameter = path.removesuffix(")").partition("(")
    try:
        if value and any(cls.__dict__.get("bl_idname") == value for cls in _family(bpy.types.bpy_struct)):
            return True  # registered classes are values of enumerations: RenderSettings.engine
        if path.startswith("bpy.ops."):
            return _operator_exists(path.split(".")[2:], parameter, value)
        if path.startswith("bpy.types."):
            return _class_has(path.split(".")[2:], parameter, value)
        return not (parameter or value) and _module_has(path)
    except Exception:
        return False


def _operator_exists(names, parameter, value):
    group, *names = names
    if group not in dir(bpy.ops):
        return False
    if not names:
        return True
    group = getattr(bpy.ops, group)
    if names[0] not in dir(group):
        return False
    return not parameter or _takes(getattr(group, names[0]).get_rna_type().properties, parameter, value)


def _class_has(names, parameter, value):
    cls = getattr(bpy.types, names[0], None)
    if cls is None or len(names) == 1:
        return cls is not None
    if names[0] == "Context" and names[1] in dir(bpy.context):
        return True
    return any(_has(related, names[1], parameter, value) for related in _family(cls))


def _family(cls):
    """A class, what it derives from, and what derives from it: a value may be of any of them."""
    found = [*cls.__mro__]
    waiting = [cls]
    while waiting:
        below = type.__subclasses__(waiting.pop())
        found += below
        waiting += below
    return found


def _has(cls, name, parameter, value):
    rna = cls.__dict__.get("bl_rna")
    if parameter:
        return (
            rna is not None
            and name in rna.functions
            and _takes(rna.functions[name].parameters, parameter, value)
        )
    if value:
        return rna is not None and _takes(rna.properties, name, value)
    return name in cls.__dict__ or (rna is not None and (name in rna.properties or name in rna.functions))


def _takes(properties, name, value):
    """Whether a property or parameter is there, and takes a value if one is given."""
    if name not in properties:
        return False
    return not value or any(value == item.identifier for item in properties[name].enum_items)


def _module_has(path):
    first, *names = path.split(".")
    owner = sys.modules[first]
    for name in names[:-1]:
        owner = getattr(owner, name)
    return names[-1] in dir(owner) or importlib.util.find_spec(path) is not None
