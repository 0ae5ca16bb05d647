# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets the bpy module simulate fluids.

The module loads Blender's ``manta`` module while bpy is imported. That is before mantaflow links its classes to their
bases, so they lack every inherited method, and the first fluid domain ends the process. ``manta`` loaded once more,
after mantaflow has set itself up, is whole. The moment to do so is when Blender compiles the first script that is to
import it, which an audit hook sees. A Blender that runs as a program of its own loads ``manta`` at the right time by
itself and is left alone; so is a bpy whose classes turn out to be whole.
"""

import ctypes
import sys

import bpy

_SCRIPT = b"from manta import"
_INHERITED = ("LevelsetGrid", "setConst")  # a class, and a method that it has only from its base
_LOADER = "PyInit_manta_main"

_state = {"hooked": False, "withheld": False}


def mend():
    """To be called before the first fluid domain exists. Once is enough; the hook stays for the process's life."""
    # The bpy of 4.2 does not say that it is one: a program has a path.
    if not _state["hooked"] and getattr(bpy.app, "module", not bpy.app.binary_path):
        sys.addaudithook(_at_event)
        _state["hooked"] = True


def is_hooked():
    """Whether this Blender is one that gets the repair."""
    return _state["hooked"]


def withhold(withheld):
    """Whether the hook is to do nothing from here on: a bpy that needs it then aborts at the first fluid."""
    _state["withheld"] = withheld


def _at_event(event, arguments):
    if event != "compile" or _state["withheld"]:
        return
    source = arguments[0]
    if isinstance(source, str):
        source = source.encode("utf-8", "replace")
    if not isinstance(source, bytes) or _SCRIPT not in source or _is_whole(sys.modules.get("manta")):
        return
    try:
        sys.modules["manta"] = _load_again()
    except Exception as error:
        sys.stderr.write(f"(fluids cannot be mended in this bpy: {type(error).__name__}: {error})\n")


def _is_whole(module):
    name, method = _INHERITED
    return hasattr(getattr(module, name, None), method)


def _load_again():
    load = getattr(ctypes.PyDLL(_library()), _LOADER)
    load.argtypes, load.restype = [], ctypes.py_object
    return load()


def _library():
    """The file that bpy itself was loaded from."""
    return bpy.__spec__.origin
