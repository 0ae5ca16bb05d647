# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds which texts functions written in C take, where neither RNA nor their documentation lists them: each is called
with a text that cannot be one of them, which it refuses before it does anything.
"""

import os
import re

import bpy

from ..classes.rna import ancestry
from .bmesh_operators import NO_VALUE
from .keywords import instances

LISTED = re.compile(r" in \((.*?)\)")
QUOTED = re.compile(r"'([^']+)'")


def nothing():
    """A callback that is never called."""


# Class, function, argument, and what it is called with: the text is the first fault of the call.
CALLS = (
    ("Space", "draw_handler_add", "region_type", (nothing, (), NO_VALUE, NO_VALUE), {}),
    ("Space", "draw_handler_add", "draw_type", (nothing, (), "WINDOW", NO_VALUE), {}),
    ("WindowManager", "draw_cursor_add", "space_type", (nothing, (), NO_VALUE, NO_VALUE), {}),
    ("WindowManager", "draw_cursor_add", "region_type", (nothing, (), "VIEW_3D", NO_VALUE), {}),
    ("BlendData", "user_map", "key_types", (), {"key_types": {NO_VALUE}}),
    ("BlendData", "user_map", "value_types", (), {"value_types": {NO_VALUE}}),
    ("BlendData", "file_path_map", "key_types", (), {"key_types": {NO_VALUE}}),
    ("BlendDataLibraries", "write", "path_remap", (os.devnull, set()), {"path_remap": NO_VALUE}),
)


def listed(cls, function, given, named):
    """The texts that the refusal of a call lists."""
    owner = getattr(bpy.types, cls)
    try:
        getattr(instances().get(owner, owner), function)(*given, **named)
    except ValueError as error:
        match = LISTED.search(str(error))
        return QUOTED.findall(match[1]) if match else []
    except (AttributeError, RuntimeError, TypeError):  # this Blender has another call
        pass
    return []


def find_all(write, structs):
    """One ``texts_taken`` record for each argument, with its ``items``, of each class that has it: of those below one
    the reference lists the functions again.
    """
    for cls, function, argument, given, named in CALLS:
        items = listed(cls, function, given, named)
        for own, rna in structs.items() if items else ():
            if cls in ancestry(rna):
                write("texts_taken", path=f"bpy.types.{own}.{function}", argument=argument, items=items)
