# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes a copy of the open file; the file that the user has open, and its place, stay what they are."""

import contextlib
import ctypes
import os
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ...blend.cache_folders import cache_folders
from ...blend.temporary import temporary_settings, without_handlers
from ..user_state import in_window
from . import structures

_ON_SAVING = ("save_pre", "save_post", "save_post_fail")
_BYTES_A_SECOND = 150e6  # until a copy of this Blender was measured
_OF_VERTEX, _OF_EDGE, _OF_LOOP, _OF_FACE = 40, 12, 24, 12
_ANYTHING = 2e6  # bytes of what is in every file
_LEAST_MEASURED = 20e6
_measured = {"speed": _BYTES_A_SECOND}  # of the last large copy


_unsaved = {
    "changes": False
}  # whether a copy was written of a file with changes, until Blender knows of them again


class TooLarge(Refused):
    """It would take too long to copy the scene."""


def keep_unsaved():
    """Has Blender know again that the file has changes: soon after a copy was written, it takes them for saved.

    To be called before anything else is done.
    """
    if not _unsaved["changes"]:
        return
    _unsaved["changes"] = False
    if bpy.data.is_dirty:
        return
    offset = structures.offset_of("wmWindowManager", "file_saved")
    if offset is not None:
        ctypes.c_short.from_address(bpy.context.window_manager.as_pointer() + offset).value = 0
    if not bpy.data.is_dirty:
        with in_window():
            bpy.ops.ed.undo_push(message="SimWorlds: looked")


def forget_unsaved():
    """The user has saved, or opened another file."""
    _unsaved["changes"] = False


def write_copy(arguments, report):
    """Writes a copy to ``path`` if that takes at most ``seconds``, by an estimate. Raises Refused.

    ``objects`` and ``triangles``: how many the copy may have, for who wants to draw it soon.
    Returns ``bytes``, ``seconds``, ``file`` (the open one's path), ``folders`` of other files that it uses, and
    ``unsaved``: images that were painted and are in no file, which the copy has as they were before.
    """
    del report
    path, most = arguments["path"], arguments["seconds"]
    check_drawn(bpy.context.scene.objects, arguments)
    check_size(
        (*bpy.data.meshes, *bpy.data.images, *bpy.data.sounds, *bpy.data.volumes, *bpy.data.fonts), most
    )
    _unsaved["changes"] = _unsaved["changes"] or bpy.data.is_dirty
    started = time.perf_counter()
    preferences = bpy.context.preferences
    dirty = preferences.is_dirty
    try:
        # Neither a thumbnail, which takes as long as writing, nor handlers: nobody saves anything here.
        with (
            in_window(),
            without_handlers(_ON_SAVING),
            temporary_settings([(preferences.filepaths, "file_preview_type", "NONE")]),
        ):
            bpy.ops.wm.save_as_mainfile(
                filepath=path, copy=True, check_existing=False, relative_remap=True, compress=False
            )
    except RuntimeError as error:
        raise Refused(f"The copy cannot be written: {str(error).strip().removeprefix('Error: ')}") from None
    finally:
        with contextlib.suppress(AttributeError):
            preferences.is_dirty = dirty
    seconds = time.perf_counter() - started
    written = os.path.getsize(path)
    if written > _LEAST_MEASURED:
        _measured["speed"] = written / seconds
    return {
        "bytes": written,
        "seconds": seconds,
        "file": bpy.data.filepath,
        "folders": paths_used(),
        "unsaved": sorted(image.name for image in bpy.data.images if image.is_dirty)[:40],
    }


def paths_used():
    """The folders of other files that the open file uses, those of caches included."""
    used = [*bpy.utils.blend_paths(absolute=True, packed=False), *(folder.real for folder in cache_folders())]
    places = [os.path.realpath(path) for path in used]
    folders = {place if os.path.isdir(place) else os.path.dirname(place) for place in places}
    return sorted(folder for folder in folders if os.path.isdir(folder))[:40]


def check_drawn(objects, most):
    """Raises TooLarge if these are more ``objects`` or ``triangles`` than ``most`` says; it may say nothing of them."""
    meshes = [obj.data for obj in objects if obj.type == "MESH"]
    triangles = sum(len(mesh.loops) - 2 * len(mesh.polygons) for mesh in meshes)
    if len(objects) > most.get("objects", len(objects)) or triangles > most.get("triangles", triangles):
        raise TooLarge(
            f"{len(objects):,} objects with {triangles:,} triangles are too many to be drawn in a moment."
        )


def check_size(blocks, seconds):
    """Raises TooLarge if these data-blocks take longer than so many seconds to write, by an estimate."""
    size = _ANYTHING
    for block in blocks:
        if isinstance(block, bpy.types.Mesh):
            size += len(block.vertices) * _OF_VERTEX + len(block.edges) * _OF_EDGE
            size += len(block.loops) * _OF_LOOP + len(block.polygons) * _OF_FACE
        elif getattr(block, "packed_file", None):
            size += block.packed_file.size
    expected = size / _measured["speed"]
    if expected > seconds:
        raise TooLarge(
            f"The scene is too large to be copied in {seconds:g} s: about {size / 1e6:.0f} MB, {expected:.0f} s."
        )
