# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of the whole state that open elsewhere, and opening such a copy as the run's own file.

What a .blend refers to is packed into the copy, or lies in one folder beside it, called as Blender calls the folder of
point caches: ``blendcache_NAME``. Frames of point caches lie in it directly, those of each fluid and of each bake of
geometry nodes in a folder of their own. The open file is as before when a copy has been written.
"""

import contextlib
import os
import re
import shutil

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..physics.caches import find_caches
from .blend_files import SCENE_FILE, make_own, read_file, reason

_CACHES = "caches"  # in the workspace: where fluids are baked to
_PACKED_SOURCES = {"FILE", "TILED"}
_FRAME = re.compile(r"_-?\d{5,}_\d\d\.bphys$")


def save(arguments, report):
    """Writes the state to ``path``, referring to ``beside`` (a folder's name) for what cannot be in it.

    ``workspace``: the folder that files may be taken from. ``pack``: images, sounds and fonts go into the copy.
    Returns ``bytes``, ``objects``, ``packed`` and ``rescued`` (names; the latter were pixels that no file held),
    ``files`` ([path in the workspace, path below ``beside``]), ``external`` and ``caches``.
    """
    path, beside, workspace = arguments["path"], arguments["beside"], arguments["workspace"]
    with contextlib.ExitStack() as undo:
        report(0, None, "packing")
        packed, rescued = _pack(undo, arguments["pack"])
        caches = kept_caches()
        files = [*_point_files(workspace), *_redirect(undo, beside, workspace)]
        external = _make_absolute(undo, beside)
        report(0, None, "writing")
        try:
            # Relative paths are as they are to be where the copy will lie.
            bpy.ops.wm.save_as_mainfile(filepath=path, copy=True, check_existing=False, relative_remap=False)
        except RuntimeError as error:
            raise Refused(reason(error)) from None
    return {
        "bytes": os.path.getsize(path),
        "objects": len(bpy.data.objects),
        "packed": packed,
        "rescued": rescued,
        "files": files,
        "external": external,
        "caches": caches,
    }


def look(arguments, report):
    """Opens ``path``, for a process that is to end; returns ``objects`` and ``caches`` as they are found there."""
    del report
    read_file(arguments["path"])
    return {"objects": len(bpy.data.objects), "caches": kept_caches()}


def load(arguments, report):
    """Opens ``path`` with the caches beside it and makes it the run's own file in ``workspace``; no script runs.

    Files outside the workspace are copied, ``lent`` ones are moved. Returns ``objects``, ``version``, ``scripts``
    (whether some were kept from running), ``external`` and ``caches``. Raises Refused; then the file that was open
    before may be gone.
    """
    path, workspace = arguments["path"], arguments["workspace"]
    read_file(path)
    version = tuple(bpy.data.version)
    if version[:2] > bpy.app.version[:2]:
        raise Refused(
            f"{os.path.basename(path)} was saved by Blender {version[0]}.{version[1]}, and this is "
            f"{bpy.app.version_string}, which would lose what the newer one added."
        )
    scripts = bool(getattr(bpy.app, "autoexec_fail", False))
    folders = _folders()
    report(0, None, "taking its caches over")
    make_own(workspace)
    _bring_points(path, workspace)
    for folder in folders:
        _bring_folder(folder, workspace, lent=arguments["lent"])
    return {
        "objects": len(bpy.data.objects),
        "version": ".".join(str(part) for part in version[:2]),
        "scripts": scripts,
        "external": _outside(_folder_paths()),
        "caches": kept_caches(),
    }


def caches_of_file(arguments, report):
    """``objects`` and ``caches`` of the open file."""
    del arguments, report
    return {"objects": len(bpy.data.objects), "caches": kept_caches()}


def kept_caches():
    """Each physics cache: ``label``, ``baked``, ``outdated``, ``range``, ``where``, ``frames``, ``missing`` ones."""
    found = {}
    for scene in bpy.data.scenes:
        for cache in find_caches(scene):
            label = cache.label if cache.label not in found else f"{cache.label} ({cache.holder.name})"
            found[label] = {
                "label": label,
                "baked": cache.baked,
                "outdated": cache.outdated,
                "range": list(cache.range),
                "where": "memory" if cache.folder is None else "disk",
                **_held(cache),
            }
    return list(found.values())


def _held(cache):
    """How many frames are there, and how many that should be are not."""
    frames, missing = cache.frames, cache.missing
    if cache.points is None or cache.folder is None:
        return {"frames": frames, "missing": missing}
    # Of point caches on disk Blender tells what once was.
    found = len({name.rsplit("_", 2)[1] for name in _names(cache.folder, cache)})
    return {"frames": found, "missing": max(0, frames + missing - found)}


# Packing


def _pack(undo, wanted):
    """(names packed, names of images whose pixels are in no file). The latter stay packed in the open file, too."""
    rescued = []
    for image in _local(bpy.data.images):
        if image.is_dirty and image.source != "VIEWER":
            with contextlib.suppress(RuntimeError):
                image.pack()
                rescued.append(image.name)
    packed = []
    for thing in _packable() if wanted else ():
        try:
            thing.pack()
        except RuntimeError:
            continue  # not there to be packed: it is listed with what is outside
        if thing.packed_file is not None:
            packed.append(thing.name)
            undo.callback(_unpack, thing)
    return packed, rescued


def _packable():
    for image in _local(bpy.data.images):
        if image.source in _PACKED_SOURCES and image.filepath and image.packed_file is None:
            yield image
    for thing in (*_local(bpy.data.sounds), *_local(bpy.data.fonts)):
        if thing.packed_file is None and thing.filepath not in {"", "<builtin>"}:
            yield thing


def _local(things):
    return [thing for thing in things if thing.library is None]


def _unpack(thing):
    with contextlib.suppress(RuntimeError):
        thing.unpack(method="REMOVE")


# Folders of caches


class _Folder:
    """The folder of one fluid, or of one bake of geometry nodes. ``name`` is its own among all in the file."""

    def __init__(self, holder, attribute, name):
        self._holder = holder
        self._attribute = attribute
        self.name = name
        self.real = _absolute(self.path)

    @property
    def path(self):
        """As Blender has it; setting it leaves what is baked valid."""
        return getattr(self._holder, self._attribute)

    @path.setter
    def path(self, path):
        setattr(self._holder, self._attribute, path)


def _folders():
    found, taken = [], set()
    for thing in _local(bpy.data.objects):
        stem = re.sub(r"[^\w.-]+", "_", thing.name).strip(".") or "cache"
        for modifier in thing.modifiers:
            if modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN":
                holder, attribute = modifier.domain_settings, "cache_directory"
            elif modifier.type == "NODES" and getattr(modifier, "bake_directory", ""):
                holder, attribute = modifier, "bake_directory"
            else:
                continue
            name = _free(stem, lambda one: one.lower() in taken)
            taken.add(name.lower())
            found.append(_Folder(holder, attribute, name))
    return found


def _free(stem, is_taken):
    name, number = stem, 1
    while is_taken(name):
        number += 1
        name = f"{stem}-{number}"
    return name


def _redirect(undo, beside, workspace):
    """Lets folders of the workspace be found below ``beside``; yields their files."""
    for folder in _folders():
        if _below(folder.real, workspace) is None or not os.path.isdir(folder.real):
            continue
        undo.callback(setattr, folder, "path", folder.path)
        folder.path = f"//{beside}/{folder.name}"
        for place, _, names in os.walk(folder.real):
            inside, below = _below(place, workspace), os.path.relpath(place, folder.real)
            for one in names:
                yield [os.path.join(inside, one), os.path.normpath(os.path.join(folder.name, below, one))]


def _bring_folder(folder, workspace, *, lent):
    """Takes a folder of caches into the workspace, where it can be baked anew."""
    inside = _below(folder.real, workspace)
    if inside is not None and not lent:
        folder.path = f"//{inside}"
        return
    own = os.path.join(workspace, _CACHES)
    name = _free(folder.name, lambda one: os.path.lexists(os.path.join(own, one)))
    if os.path.isdir(folder.real):
        os.makedirs(own, exist_ok=True)
        (shutil.move if lent else shutil.copytree)(folder.real, os.path.join(own, name))
    folder.path = f"//{_CACHES}/{name}"


def _point_files(workspace):
    for cache in _on_disk():
        inside = _below(cache.folder, workspace)
        if inside is not None:
            for name in _names(cache.folder, cache):
                yield [os.path.join(inside, name), name]


def _bring_points(path, workspace):
    stem = os.path.splitext(os.path.basename(path))[0]
    source = os.path.join(os.path.dirname(path), f"blendcache_{stem}")
    target = os.path.join(workspace, f"blendcache_{os.path.splitext(SCENE_FILE)[0]}")
    if source == target:
        return
    for cache in _on_disk():
        for name in _names(target, cache):
            os.remove(os.path.join(target, name))
        for name in _names(source, cache):
            os.makedirs(target, exist_ok=True)
            shutil.copyfile(os.path.join(source, name), os.path.join(target, name))


def _on_disk():
    """The point caches that are files beside the .blend."""
    for scene in bpy.data.scenes:
        for cache in find_caches(scene):
            if cache.points is not None and cache.folder and not cache.points.use_external:
                yield cache


def _names(folder, cache):
    """The files of a point cache: named by itself, or after its object in hexadecimal."""
    start = (cache.points.name or cache.owner.name.encode(errors="surrogateescape").hex().upper()) + "_"
    try:
        found = os.listdir(folder)
    except OSError:
        return []
    return sorted(name for name in found if name.startswith(start) and _FRAME.match(name, len(start) - 1))


def _absolute(path):
    return os.path.normpath(bpy.path.abspath(path))


def _below(path, workspace):
    """The path within the workspace; None for one outside."""
    real, root = os.path.realpath(path), os.path.realpath(workspace)
    return os.path.relpath(real, root) if real == root or real.startswith(root + os.sep) else None


# Files that stay outside


def _make_absolute(undo, beside):
    """Lets what stays outside be found from anywhere on this machine; returns it, as ``_outside`` does."""
    before = {}

    def visit(owner, path):
        if not path.startswith("//"):
            return None
        before[owner, _absolute(path)] = path
        return _absolute(path)

    apart = {path for path in _folder_paths() if path.startswith(f"//{beside}/")}
    undo.callback(_outside, apart, lambda owner, path: before.get((owner, path)))
    return _outside(apart, visit)


def _outside(apart=(), visit=None):
    """Files that are used and neither packed nor ``apart``: ``what`` uses it, its ``path``, whether it is ``missing``.

    ``visit`` gets (owner, path) and returns another path for it, or None.
    """
    if not hasattr(bpy.data, "file_path_foreach"):  # before Blender 5.0
        paths = set(bpy.utils.blend_paths(absolute=True, packed=False, local=True))
        libraries = {
            _absolute(library.filepath): f"library {library.name!r}" for library in bpy.data.libraries
        }
        return [
            {"what": libraries.get(path, "a file"), "path": path, "missing": not _is_readable(path)}
            for path in sorted(paths)
            if path and not _is_own(path)
        ]
    found = []

    def at(owner, path, _meta):
        real = _absolute(path)
        if owner.library is not None or path in {"", "<builtin>", *apart} or _is_own(real):
            return None
        what = f"{owner.bl_rna.name.lower()} {owner.name!r}"
        found.append({"what": what, "path": real, "missing": not _is_readable(real)})
        return visit(owner, path) if visit is not None else None

    bpy.data.file_path_foreach(at, flags={"SKIP_PACKED"})
    return found


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


def _is_own(path):
    """Whether it is a folder that Blender names after the .blend, wherever that lies."""
    return os.path.basename(path).startswith("blendcache_")


def _folder_paths():
    return {folder.path for folder in _folders()}
