# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves the open scene as one file that needs as few others as possible."""

import contextlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .playback import fluid_domains, point_caches


def save(path):
    """Packs images, sounds and fonts, and saves a copy as ``path``.

    Returns what stays outside of it, in words: files that cannot be packed, and baked caches on the disk.
    """
    for image in _local(bpy.data.images):
        has_file = image.source in {"FILE", "TILED"} and image.filepath
        if has_file or (image.is_dirty and image.source != "VIEWER"):
            _pack(image)
    for block in (*_local(bpy.data.sounds), *_local(bpy.data.fonts)):
        if block.filepath not in {"", "<builtin>"}:
            _pack(block)
    with contextlib.suppress(RuntimeError):
        bpy.ops.file.make_paths_absolute()
    paths = set(bpy.utils.blend_paths(absolute=True, packed=False, local=True))
    for scene in bpy.data.scenes:
        paths |= {each.cache_directory for each in fluid_domains(scene) if each.has_cache_baked_data}
    outside = [f"file {path}" for path in sorted(paths) if path]
    outside += [
        f"point cache of {cache.id_data.name!r}"
        for scene in bpy.data.scenes
        for cache in point_caches(scene)
        if cache.is_baked and (cache.use_disk_cache or cache.use_external)
    ]
    try:
        bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, check_existing=False, relative_remap=False)
    except RuntimeError as error:
        raise Refused(f"it cannot be saved: {error}") from None
    return outside


def _local(blocks):
    return [block for block in blocks if block.library is None]


def _pack(block):
    """Leaves a block as it is whose file cannot be read: it is then among what stays outside."""
    if block.packed_file is None or getattr(block, "is_dirty", False):
        with contextlib.suppress(RuntimeError):
            block.pack()
