# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens and writes .blend files for the supervisor: checkpoints, saves, the run's own file."""

import errno
import os
import shutil
import sys
import time

try:
    import resource
except ImportError:  # Windows, where an open Blender uses this module, too
    resource = None

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .cache_folders import keep_fluids, write_paths
from .temporary import temporary_settings, without_handlers

SCENE_FILE = "scene.blend"
_ON_SAVING = ("save_pre", "save_post", "save_post_fail")


def ping(arguments, report):
    """Returns Blender's version; changes nothing."""
    del arguments, report
    return {"version": bpy.app.version_string, "background": bpy.app.background}


def open_file(arguments, report):
    """Opens ``path`` (None: an empty scene), and makes it the run's own file in ``folder`` if it is not yet.

    Scripts in the file do not run.
    """
    del report
    path, folder = arguments["path"], arguments["folder"]
    if path is None:
        bpy.ops.wm.read_factory_settings(use_empty=True)
    else:
        read_file(path)
    if path != os.path.join(folder, SCENE_FILE):
        make_own(folder)
    bpy.context.preferences.filepaths.save_version = 0
    return {"objects": len(bpy.data.objects)}


def read_file(path):
    """Opens ``path``; scripts in it do not run. Raises Refused."""
    try:
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    except RuntimeError as error:
        raise Refused(f"{os.path.basename(path)} cannot be opened: {reason(error)}") from None


def make_own(folder):
    """Saves the open file as the run's own in ``folder``, which relative paths and caches on disk then start from."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(folder, SCENE_FILE), check_existing=False)
    except RuntimeError as error:
        raise Refused(f"The folder {folder} cannot be written: {reason(error)}") from None
    bpy.context.preferences.filepaths.save_version = 0


def write_file(arguments, report):
    """Writes a copy of the whole state to ``path``, to be opened later as the run's own file in ``folder``.

    Frames of fluids that would end with this Blender are moved to where the next one finds them. Returns ``seconds``
    and ``bytes``.
    """
    del report
    path = arguments["path"]
    renamed = keep_fluids(arguments["folder"])
    # Relative paths are already as the run's own file wants them, unless code has made another file its own.
    elsewhere = os.path.dirname(bpy.data.filepath or path) not in {arguments["folder"], os.path.dirname(path)}
    started = time.perf_counter()
    # No thumbnail, which takes as long as writing, and no handlers, which may never return: a checkpoint is not a save.
    no_thumbnail = [(bpy.context.preferences.filepaths, "file_preview_type", "NONE")]
    try:
        with without_handlers(_ON_SAVING), temporary_settings(no_thumbnail):
            bpy.ops.wm.save_as_mainfile(
                filepath=path, copy=True, check_existing=False, relative_remap=elsewhere, compress=False
            )
    except RuntimeError as error:
        raise Refused(f"{path} cannot be written: {writing_failed(path, error)}") from None
    write_paths(path, renamed)
    sys.stdout.flush()
    return {"seconds": time.perf_counter() - started, "bytes": os.path.getsize(path)}


def writing_failed(path, error):
    """Why Blender could not write a file. It may say that the file is missing when it was cut off at a limit."""
    told, folder = reason(error), os.path.dirname(path)
    if os.strerror(errno.ENOENT) not in told or not os.path.isdir(folder):
        return told
    most = ""
    if resource is not None:
        limit, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
        if limit != resource.RLIM_INFINITY:
            most = f"A file may have {limit / 1e6:.0f} MB at most. "
    free = shutil.disk_usage(folder).free / 1e6
    return f"Blender stopped writing before the end. {most}{free:.0f} MB are free on the disk."


def reason(error):
    """Blender's message for an operator that failed, without the leading ``Error:``."""
    return str(error).strip().removeprefix("Error: ")
