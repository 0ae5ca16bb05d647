# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves the whole state as a copy that opens anywhere, and opens such a copy as the run's own file.

What the .blend refers to is packed into the copy, or is in one folder beside it, named like Blender's folder for point
caches: ``blendcache_NAME``. Frames of point caches are directly in it, those of each fluid and of each bake of geometry
nodes in a folder of their own. Saving does not change the open file.
"""

import contextlib
import os
import re
import shutil

import bpy

from simworlds.sandbox.inside.open_blend import open_blend
from simworlds.sandbox.inside.refusal import Refused

from .blend.cache_folders import (
    CACHES,
    absolute,
    cache_folders,
    is_temporary,
    keep_fluids,
    relative_to,
    unused_name,
    write_paths,
)
from .blend.file_io import SCENE_FILE, make_own, read_file, writing_failed
from .physics import bake_inputs
from .physics.caches import file_prefix, find_caches

_UNUSED = (
    "materials",
    "node_groups",
    "actions",
    "worlds",
)  # what is made by name, and missed when it is gone
_MOST_UNUSED = 200
_PACKED_SOURCES = {"FILE", "TILED"}
_FRAME = re.compile(r"_-?\d{5,}_\d\d\.bphys$")


def save(arguments, report):
    """Writes the state to ``path``, referring to ``beside`` (a folder's name) for what cannot be packed.

    ``workspace``: the folder that files may be taken from. ``pack``: pack images, sounds and fonts.
    Returns ``bytes``, ``objects``, ``packed`` and ``rescued`` (names; of the latter, no file had the pixels),
    ``files`` ([path in the workspace, path below ``beside``]), ``loose`` ones, which may be gone by now (Blender drops
    frames of simulations that are not baked), ``external``, ``caches``, and what is ``unused``, so not in the copy.
    """
    path, beside, workspace = arguments["path"], arguments["beside"], arguments["workspace"]
    renamed = keep_fluids(workspace)
    with contextlib.ExitStack() as undo:
        report(0, None, "packing")
        packed, rescued = _pack(undo, arguments["pack"])
        redirected = list(_redirect(undo, beside, workspace, renamed))
        external = _make_absolute(undo, beside, renamed)
        report(0, None, "writing")
        try:
            # Relative paths are already right for where the copy will be.
            bpy.ops.wm.save_as_mainfile(
                filepath=path, copy=True, check_existing=False, relative_remap=False, compress=False
            )
        except RuntimeError as error:
            raise Refused(writing_failed(path, error)) from None
    write_paths(path, renamed)
    caches = kept_caches()
    whole, loose = _folder_files(redirected, workspace)
    return {
        "bytes": os.path.getsize(path),
        "objects": len(bpy.data.objects),
        "packed": packed,
        "rescued": rescued,
        "files": [*_point_files(workspace), *whole],
        "loose": loose,
        "external": external,
        "caches": caches,
        "unused": _unused(),
    }


def inspect(arguments, report):
    """Opens ``path`` in a process that ends afterwards; returns ``objects`` and ``caches`` found in it."""
    del report
    read_file(arguments["path"])
    return {"objects": len(bpy.data.objects), "caches": kept_caches()}


def load(arguments, report):
    """Opens ``path`` with the caches beside it and makes it the run's own file in ``workspace``; no script runs.

    Files outside the workspace are copied. Returns ``objects``, ``version``, ``scripts``
    (whether it has scripts, which were not run), ``external`` and ``caches``. Raises Refused; the file that was open
    before may be lost then.
    """
    path, workspace = arguments["path"], arguments["workspace"]
    report(0, None, "reading and estimating it")
    open_blend(path)
    version = tuple(bpy.data.version)
    if version[:2] > bpy.app.version[:2]:
        raise Refused(
            f"{os.path.basename(path)} was saved by Blender {version[0]}.{version[1]}. This is Blender "
            f"{bpy.app.version_string}, which would lose what newer versions added."
        )
    scripts = bool(getattr(bpy.app, "autoexec_fail", False))
    folders = cache_folders()
    report(0, None, "taking over its caches")
    make_own(workspace)
    _bring_points(path, workspace)
    for folder in folders:
        _bring_folder(folder, workspace)
    for scene in bpy.data.scenes:
        bake_inputs.remember_opened(scene, find_caches(scene))
    return {
        "objects": len(bpy.data.objects),
        "version": ".".join(str(part) for part in version[:2]),
        "scripts": scripts,
        "external": _external_files(_folder_paths()),
        "caches": kept_caches(),
    }


def caches_of_file(arguments, report):
    """``objects`` and ``caches`` of the open file."""
    del arguments, report
    return {"objects": len(bpy.data.objects), "caches": kept_caches()}


def kept_caches():
    """Each physics cache: ``label``, ``baked``, ``outdated``, ``range``, ``where``, ``frames``, ``missing`` ones."""
    entries = {}
    for scene in bpy.data.scenes:
        for cache in find_caches(scene):
            label = cache.label if cache.label not in entries else f"{cache.label} ({cache.holder.name})"
            entries[label] = {
                "label": label,
                "baked": cache.baked,
                "outdated": cache.outdated,
                "range": list(cache.range),
                "where": "memory" if cache.folder is None else "disk",
                **_frame_counts(cache),
            }
    return list(entries.values())


def _frame_counts(cache):
    """``frames``: how many exist; ``missing``: how many more there should be."""
    frames, missing = cache.frames, cache.missing
    if cache.points is None or cache.folder is None:
        return {"frames": frames, "missing": missing}
    # For point caches on disk, Blender reports frames that may since have been deleted.
    count = len({name.rsplit("_", 2)[1] for name in _cache_files(cache.folder, cache)})
    return {"frames": count, "missing": max(0, frames + missing - count)}


def _unused():
    """What nothing uses: Blender writes no such data-block into a file."""
    found = [
        f"{block.bl_rna.name.lower()} {block.name!r}"
        for kind in _UNUSED
        for block in _local(getattr(bpy.data, kind))
        if not block.users
    ]
    return found[:_MOST_UNUSED]


# Packing


def _pack(undo, wanted):
    """(names packed, names of images whose pixels were in no file). The latter stay packed in the open file as well."""
    rescued = []
    for image in _local(bpy.data.images):
        if image.is_dirty and image.source != "VIEWER":
            with contextlib.suppress(RuntimeError):
                image.pack()
                rescued.append(image.name)
    packed = []
    for block in _packable() if wanted else ():
        try:
            block.pack()
        except RuntimeError:
            continue  # its file is missing: it is listed as external
        if block.packed_file is not None:
            packed.append(block.name)
            undo.callback(_unpack, block)
    return packed, rescued


def _packable():
    for image in _local(bpy.data.images):
        if image.source in _PACKED_SOURCES and image.filepath and image.packed_file is None:
            yield image
    for block in (*_local(bpy.data.sounds), *_local(bpy.data.fonts)):
        if block.packed_file is None and block.filepath not in {"", "<builtin>"}:
            yield block


def _local(blocks):
    return [block for block in blocks if block.library is None]


def _unpack(block):
    with contextlib.suppress(RuntimeError):
        block.unpack(method="REMOVE")


# Folders of caches


def _redirect(undo, beside, workspace, renamed):
    """Makes folders of the workspace, and temporary ones, point below ``beside``; yields (name there, path here).

    Those of fluids only in ``renamed``, for the file that is written: see ``keep_fluids``.
    """
    for folder in cache_folders():
        if relative_to(folder.real, workspace) is None and not is_temporary(folder.real):
            continue
        there = f"//{beside}/{folder.name}"
        if folder.is_fluid:
            renamed[folder.path] = there
        else:
            undo.callback(setattr, folder, "path", folder.path)
            folder.path = there
        yield folder.name, folder.real


def _folder_files(redirected, workspace):
    """([path in the workspace, path beside the copy] of each file that ``_redirect`` gave, the same of unbaked)."""
    unbaked = {
        os.path.realpath(cache.folder)
        for scene in bpy.data.scenes
        for cache in find_caches(scene)
        if cache.domain is not None and not cache.baked
    }
    whole, loose = [], []
    for name, real in redirected:
        files = loose if os.path.realpath(real) in unbaked else whole
        for place, _, names in os.walk(real):
            inside, below = relative_to(place, workspace), os.path.relpath(place, real)
            if inside is not None:
                files += [
                    [os.path.join(inside, file), os.path.normpath(os.path.join(name, below, file))]
                    for file in names
                ]
    return whole, loose


def _bring_folder(folder, workspace):
    """Brings a folder of caches into the workspace, where it can be baked again."""
    inside = relative_to(folder.real, workspace)
    if inside is not None:
        folder.path = f"//{inside}"
        return
    own = os.path.join(workspace, CACHES)
    name = unused_name(folder.name, lambda name: os.path.lexists(os.path.join(own, name)))
    if os.path.isdir(folder.real):
        os.makedirs(own, exist_ok=True)
        shutil.copytree(folder.real, os.path.join(own, name))
    folder.path = f"//{CACHES}/{name}"


def _point_files(workspace):
    for cache in _disk_caches():
        inside = relative_to(cache.folder, workspace)
        if inside is not None:
            for name in _cache_files(cache.folder, cache):
                yield [os.path.join(inside, name), name]


def _bring_points(path, workspace):
    stem = os.path.splitext(os.path.basename(path))[0]
    source = os.path.join(os.path.dirname(path), f"blendcache_{stem}")
    target = os.path.join(workspace, f"blendcache_{os.path.splitext(SCENE_FILE)[0]}")
    if source == target:
        return
    for cache in _disk_caches():
        for name in _cache_files(target, cache):
            os.remove(os.path.join(target, name))
        for name in _cache_files(source, cache):
            os.makedirs(target, exist_ok=True)
            shutil.copyfile(os.path.join(source, name), os.path.join(target, name))


def _disk_caches():
    """The point caches on disk, beside the .blend."""
    for scene in bpy.data.scenes:
        for cache in find_caches(scene):
            if cache.points is not None and cache.folder and not cache.points.use_external:
                yield cache


def _cache_files(folder, cache):
    """The names of a point cache's files in a folder."""
    start = file_prefix(cache.points, cache.owner)
    try:
        names = os.listdir(folder)
    except OSError:
        return []
    return sorted(name for name in names if name.startswith(start) and _FRAME.match(name, len(start) - 1))


# Files that stay outside


def _make_absolute(undo, beside, renamed):
    """Makes the paths of external files absolute; returns those files, as ``_external_files`` does."""
    before = {}

    def visit(owner, path):
        if not path.startswith("//"):
            return None
        before[owner, absolute(path)] = path
        return absolute(path)

    apart = {path for path in _folder_paths() if path.startswith(f"//{beside}/") or path in renamed}
    undo.callback(_external_files, apart, lambda owner, path: before.get((owner, path)))
    return _external_files(apart, visit)


def _external_files(apart=(), visit=None):
    """The used files that are neither packed nor ``apart``: ``what`` uses it, its ``path``, whether it is ``missing``.

    ``visit`` gets (owner, path) and returns another path for it, or None.
    """
    if not hasattr(bpy.data, "file_path_foreach"):  # before Blender 5.0
        paths = set(bpy.utils.blend_paths(absolute=True, packed=False, local=True))
        libraries = {
            absolute(library.filepath): f"library {library.name!r}" for library in bpy.data.libraries
        }
        return [
            {"what": libraries.get(path, "a file"), "path": path, "missing": not _is_readable(path)}
            for path in sorted(paths)
            if path and not _is_cache_folder(path)
        ]
    uses = []

    def at(owner, path, _meta):
        real = absolute(path)
        if owner.library is not None or path in {"", "<builtin>", *apart} or _is_cache_folder(real):
            return None
        what = f"{owner.bl_rna.name.lower()} {owner.name!r}"
        uses.append({"what": what, "path": real, "missing": not _is_readable(real)})
        return visit(owner, path) if visit is not None else None

    bpy.data.file_path_foreach(at, flags={"SKIP_PACKED"})
    return uses


def _is_readable(path):
    """Whether a file can be read, or a folder listed. To exist is not enough: some sandboxes only refuse to open it."""
    try:
        if os.path.isdir(path):
            os.scandir(path).close()
        else:
            os.close(os.open(path, os.O_RDONLY | os.O_NONBLOCK))
    except (OSError, ValueError):
        return False
    return True


def _is_cache_folder(path):
    """Whether it is the cache folder that Blender names after a .blend."""
    return os.path.basename(path).startswith("blendcache_")


def _folder_paths():
    return {folder.path for folder in cache_folders()}
