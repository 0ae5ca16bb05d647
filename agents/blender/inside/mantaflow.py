# SPDX-License-Identifier: GPL-3.0-or-later
"""Lets the bpy module simulate fluids.

The module loads Blender's ``manta`` module while bpy is imported. That is before mantaflow links its classes to their
bases, so they lack every inherited method, and the first fluid domain ends the process. ``manta`` loaded once more,
after mantaflow has set itself up, is whole. The moment to do so is when Blender compiles the first script that is to
import it, which an audit hook sees. A Blender that runs as a program of its own loads ``manta`` at the right time by
itself and is left alone; so is a bpy whose classes turn out to be whole.
"""

import ctypes
import os
import shutil
import sys
import tempfile

import bpy

_SCRIPT = b"from manta import"
_INHERITED = ("LevelsetGrid", "setConst")  # a class, and a method that it has only from its base
_LOADER = "PyInit_manta_main"

_state = {"hooked": False, "withheld": False}


def mend():
    """To be called before the first fluid domain exists. Once is enough; the hook stays for the process's life."""
    if not _state["hooked"] and getattr(bpy.app, "module", False):
        sys.addaudithook(_at_event)
        _state["hooked"] = True


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


def self_test(arguments, report):
    """Bakes a drop of liquid in the open file, which is spoilt by it; for a process that has had no fluid yet.

    ``remedy``: whether the hook may do its work. Without it, a bpy that needs it aborts. Returns the ``version``,
    whether this Blender is one that gets the remedy (``hooked``), and whether liquid came of it (``works``).
    """
    _state["withheld"] = not arguments["remedy"]
    folder = tempfile.mkdtemp(prefix="fluid-")
    try:
        report(0, None, "baking a drop of liquid")
        return {"version": bpy.app.version_string, "hooked": _state["hooked"], "works": _bake_drop(folder)}
    finally:
        _state["withheld"] = False
        shutil.rmtree(folder, ignore_errors=True)


def _bake_drop(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.mesh.primitive_ico_sphere_add(radius=0.5)
    drop = bpy.context.object.modifiers.new("Fluid", "FLUID")
    drop.fluid_type = "FLOW"
    drop.flow_settings.flow_type = "LIQUID"
    bpy.ops.mesh.primitive_cube_add(size=2)
    owner = bpy.context.object
    modifier = owner.modifiers.new("Fluid", "FLUID")
    modifier.fluid_type = "DOMAIN"
    domain = modifier.domain_settings
    domain.domain_type, domain.resolution_max, domain.use_mesh = "LIQUID", 16, True
    domain.cache_type, domain.cache_frame_end = "ALL", 2
    domain.cache_directory = os.path.join(folder, "cache")
    bpy.ops.fluid.bake_all()
    bpy.context.scene.frame_set(2)
    graph = bpy.context.evaluated_depsgraph_get()
    # Without liquid Blender shows the domain's own mesh.
    return len(owner.evaluated_get(graph).data.vertices) > len(owner.data.vertices)
