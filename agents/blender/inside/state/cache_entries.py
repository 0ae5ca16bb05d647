# SPDX-License-Identifier: GPL-3.0-or-later
"""Physics caches in a readout: their frames, whether they are baked or outdated, where they are, how large."""

import os
import re

import bpy

from ..physics import rigid_body_inputs
from ..physics.caches import bytes_in_memory, caches_of, file_prefix
from .rna_values import text

MOST_FILES = 50_000  # of one cache folder that are read
_FRAMES = re.compile(r"([\d,]+) frames? (?:found|on disk|in memory)")
_FRAME_NUMBER = re.compile(r"_(-?\d{4,})\.")


def point_cache_facts(cache, owner):
    """A point cache: ``state`` (baked, unbaked, baking), ``outdated``, ``range``, ``frames`` that it holds, ``bytes``.

    ``owner``: the object or scene that its files are named after.
    """
    facts = {
        "state": "baking" if cache.is_baking else "baked" if cache.is_baked else "unbaked",
        "range": [cache.frame_start, cache.frame_end],
    }
    if cache.frame_step != 1:
        facts["step"] = cache.frame_step
    if cache.name:
        facts["name"] = text(cache.name)
    held = _FRAMES.search(cache.info)
    facts["frames"] = int(held[1].replace(",", "")) if held else 0
    of_bodies = cache.is_baked and isinstance(owner, bpy.types.Scene)
    outdated = (
        rigid_body_inputs.is_outdated(owner) if of_bodies else cache.is_outdated or _is_stale(cache, owner)
    )
    # An empty cache cannot be outdated, whatever Blender says.
    if outdated and (facts["frames"] or cache.is_baked):
        facts["outdated"] = True
    if cache.use_external:
        facts["external"] = text(cache.filepath)
    elif cache.use_disk_cache:
        facts["on_disk"] = True
        facts.update(_files_of(owner, cache))
    elif (size := bytes_in_memory(cache)) is not None:
        facts["bytes"] = size
    return facts


def _is_stale(points, obj):
    """Whether something that Blender does not watch has changed since a bake of an object was made."""
    return points.is_baked and any(cache.points == points and cache.outdated for cache in caches_of(obj))


def _files_of(owner, cache):
    """The size of a cache's files beside the .blend; {} if there are none."""
    if not bpy.data.filepath:
        return {}
    stem = os.path.splitext(os.path.basename(bpy.data.filepath))[0]
    folder = os.path.join(os.path.dirname(bpy.data.filepath), f"blendcache_{stem}")
    start = file_prefix(cache, owner)
    total = sum(size for name, size in _entries(folder) if name.startswith(start))
    return {"bytes": total} if total else {}


def _is_used(domain, part):
    """Whether a domain uses this part: a bake of type ALL marks every part as baked."""
    if part in {"mesh", "particles", "noise"} and (part == "noise") != (domain.domain_type == "GAS"):
        return False
    kinds = ("spray_particles", "foam_particles", "bubble_particles", "tracer_particles")
    switches = {"data": (), "particles": kinds}.get(part, (part,))
    return not switches or any(getattr(domain, f"use_{name}", False) for name in switches)


def fluid_cache_facts(domain):
    """The cache of a fluid domain: which parts are baked, and the frames of each on disk."""
    parts = ("data", "noise", "mesh", "particles", "guide")
    facts = {
        "type": domain.cache_type,
        "range": [domain.cache_frame_start, domain.cache_frame_end],
        "directory": text(domain.cache_directory),
        "baked": [
            part
            for part in parts
            if getattr(domain, f"has_cache_baked_{part}", False) and _is_used(domain, part)
        ],
    }
    facts["state"] = "baked" if "data" in facts["baked"] else "unbaked"
    baking = [part for part in parts if getattr(domain, f"is_cache_baking_{part}", False)]
    if baking:
        facts["state"] = "baking"
    folder = bpy.path.abspath(domain.cache_directory)
    held, total = {}, 0
    for part in (*parts[:-1], "guiding"):
        frames = set()
        for name, size in _entries(os.path.join(folder, part)):
            total += size
            if number := _FRAME_NUMBER.search(name):
                frames.add(int(number[1]))
        if frames:
            held[part] = _span(frames)
    if held:
        facts["on_disk"], facts["bytes"] = held, total
    return facts


def nodes_cache_facts(modifier, bake):
    """A bake or simulation of geometry nodes: its range where it has its own, and the frames on disk.

    Frames that are packed into the .blend cannot be seen from Python.
    """
    target = modifier.bake_target if bake.bake_target == "INHERIT" else bake.bake_target
    facts = {"node": text(bake.node.name) if bake.node is not None else None, "target": target}
    if bake.use_custom_simulation_frame_range:
        facts["range"] = [bake.frame_start, bake.frame_end]
    folder = bpy.path.abspath(bake.directory if bake.use_custom_path else modifier.bake_directory)
    if not bake.use_custom_path:
        folder = os.path.join(folder, str(bake.bake_id))
    frames = {
        int(name.split("_")[0]) for name, _ in _entries(os.path.join(folder, "meta")) if name[:1].isdigit()
    }
    if frames:
        facts["on_disk"] = _span(frames)
        facts["bytes"] = sum(
            size for part in ("meta", "blobs") for _, size in _entries(os.path.join(folder, part))
        )
    facts["state"] = "baked" if frames else "unbaked" if target == "DISK" else "unbaked or packed"
    return facts


def _span(frames):
    return {"first": min(frames), "last": max(frames), "frames": len(frames)}


def _entries(folder):
    """(name, size) of the files in a folder, of MOST_FILES at most."""
    try:
        with os.scandir(folder) as entries:
            for count, entry in enumerate(entries):
                if count == MOST_FILES:
                    return
                try:
                    yield entry.name, entry.stat(follow_symlinks=False).st_size
                except OSError:
                    continue
    except OSError:
        return
