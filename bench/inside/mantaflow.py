# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets fluids be opened in the bpy module, whose ``manta`` is loaded before it is whole.

The module imports it while bpy starts, before mantaflow has given its classes their bases; the first fluid domain then
ends the process. Loaded again once mantaflow has set itself up, it is whole. That moment is when Blender compiles the
first script that imports it, which an audit hook sees. Blender as a program of its own needs none of this.
"""

import ctypes
import sys

import bpy

_done = []


def mend():
    """To be called before a file with a fluid is opened; a second call does nothing."""
    if getattr(bpy.app, "module", False) and not _done:
        _done.append(True)
        sys.addaudithook(_watch)


def _watch(event, arguments):
    if event != "compile":
        return
    source = arguments[0]
    if isinstance(source, str):
        source = source.encode("utf-8", "replace")
    if not isinstance(source, bytes) or b"from manta import" not in source:
        return
    if not hasattr(getattr(sys.modules.get("manta"), "LevelsetGrid", None), "setConst"):
        load = ctypes.PyDLL(bpy.__spec__.origin).PyInit_manta_main
        load.argtypes, load.restype = [], ctypes.py_object
        sys.modules["manta"] = load()
