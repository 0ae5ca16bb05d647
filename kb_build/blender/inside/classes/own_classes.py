# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what a class of a script's own must have, by registering one that lacks it.

RNA tells which members Blender looks for on such a class, not which of them it insists on.
"""

import re

import bpy

from ..apart import sent_apart

MISSING = re.compile(r'class to have an "(\w+)" attribute')
# How the names of such classes are written; those of the others are free.
INFIXES = {
    "Panel": "PT", "Menu": "MT", "Header": "HT", "UIList": "UL", "AssetShelf": "AST", "FileHandler": "FH",
    "Gizmo": "GT", "GizmoGroup": "GGT", "Operator": "OT", "Macro": "OT",
}  # fmt: skip
MOST = 12
USUAL = ("VIEW_3D", "UI")  # of the items of enumerations, whose defaults are refused


def looks(rna):
    """Whether Blender looks for members on classes derived from one."""
    return rna is not None and any(
        item.is_registered for kind in (rna.properties, rna.functions) for item in kind
    )


def function_for(function):
    """A function that takes what Blender gives to one of that name; ``poll`` is one of the class."""
    given = ["own", *(item.identifier for item in function.parameters if not item.is_output)]
    made = eval(f"lambda {', '.join(given)}: None")  # noqa: S307 - of RNA's own names
    return made if function.use_self else classmethod(made)


def member_for(rna, name):
    """What a class can have as a member that it lacks."""
    if name in rna.functions:
        return function_for(rna.functions[name])
    prop = rna.properties[name]
    if prop.type != "ENUM":
        return "Own" if prop.type == "STRING" else prop.default
    return next((item for item in USUAL if item in prop.enum_items), prop.default)


def needed(rna):
    """The members without which Blender does not register a class; None where it refuses it for another reason."""
    infix = INFIXES.get(rna.identifier)
    name = f"OWN_{infix}_class" if infix else "OwnClass"
    members = {"bl_idname": "object.own_class"} if infix == "OT" else {}
    found = []
    while len(found) < MOST:
        try:
            bpy.utils.register_class(type(name, (getattr(bpy.types, rna.identifier),), dict(members)))
        except Exception as error:
            missing = MISSING.search(str(error))
            if missing is None or missing[1] in members:
                return None
            found.append(missing[1])
            members[missing[1]] = member_for(rna, missing[1])
        else:
            return found
    return None


def look(send, structs):
    """Sends a row for each class that scripts derive their own from."""
    for identifier, rna in sorted(structs.items()):
        is_first = hasattr(bpy.types, identifier) and looks(rna) and not looks(rna.base)
        found = needed(rna) if is_first else None
        if found:
            send({"path": f"bpy.types.{identifier}", "names": found})


def find_all(write, structs):
    """Writes what classes of a script's own must have."""
    for row in sent_apart(lambda send: look(send, structs))[1]:
        write("own_class", **row)
