# SPDX-License-Identifier: GPL-3.0-or-later
"""Modifiers with the settings of their simulation, rigid bodies, and caches in the file and on disk."""

import os
import re

import bpy

from .json_values import called, number, text, vector
from .sample_frames import metres

MOST_FILES = 50_000  # of one folder
_FRAMES = re.compile(r"([\d,]+) frames?")
_NUMBERED = re.compile(r"_(-?\d{4,})\.")
_POINT_FILE = re.compile(r"(.*)_(-?\d{5,})_\d\d\.bphys$")
_FLUID_PARTS = ("data", "noise", "mesh", "particles")
# Type of force field → the name of its effector weight.
_WEIGHTS = {
    "ALL": "all",
    "FORCE": "force",
    "VORTEX": "vortex",
    "MAGNET": "magnetic",
    "WIND": "wind",
    "GUIDE": "curve_guide",
    "TEXTURE": "texture",
    "HARMONIC": "harmonic",
    "CHARGE": "charge",
    "LENNARDJ": "lennardjones",
    "TURBULENCE": "turbulence",
    "DRAG": "drag",
    "BOID": "boid",
    "FLUID_FLOW": "smokeflow",
}


def modifiers_of(obj):
    """Its modifiers in the order of the stack, as Modifier in ``bench/audit/facts.py`` has them."""
    return [_modifier(obj, modifier) for modifier in obj.modifiers]


def _modifier(obj, modifier):
    row = {
        "name": text(modifier.name),
        "type": modifier.type,
        "show_viewport": modifier.show_viewport,
        "show_render": modifier.show_render,
    }
    target = getattr(modifier, "object", None) or getattr(modifier, "target", None)
    if isinstance(target, bpy.types.Object):
        row["target"] = called(target)
    read = _READERS.get(modifier.type)
    if read is not None and (settings := read(obj, modifier)) is not None:
        row[_KEYS[modifier.type]] = settings
    return row


def _cloth(obj, modifier):
    settings, collisions = modifier.settings, modifier.collision_settings
    return {
        "cache": point_cache(modifier.point_cache, obj),
        "pin_group": text(settings.vertex_group_mass),
        "use_collision": collisions.use_collision,
        "use_self_collision": collisions.use_self_collision,
        "effectors": _effectors(settings.effector_weights, collisions.collection),
    }


def _soft_body(obj, modifier):
    settings = modifier.settings
    return {
        "cache": point_cache(modifier.point_cache, obj),
        "use_goal": settings.use_goal,
        "goal_group": text(settings.vertex_group_goal),
        "effectors": _effectors(settings.effector_weights, settings.collision_collection),
    }


def _particles(obj, modifier):
    system = modifier.particle_system
    settings = system.settings if system is not None else None
    if settings is None:
        return None
    cache = None
    emission = (settings.frame_start, settings.frame_end)
    if settings.type == "EMITTER":
        cache = point_cache(system.point_cache, obj, lived=(emission[0], emission[1] + settings.lifetime + 1))
    elif settings.type == "HAIR" and system.use_hair_dynamics:
        cache = point_cache(system.point_cache, obj)
    shown = {"OBJECT": "instance_object", "COLLECTION": "instance_collection"}.get(settings.render_type)
    return {
        "name": text(system.name),
        "settings": text(settings.name),
        "type": settings.type,
        "count": settings.count,
        "source": settings.emit_from,
        "emission": [number(frame) for frame in emission],
        "lifetime": number(settings.lifetime),
        "hair_dynamics": bool(system.use_hair_dynamics),
        "render_type": settings.render_type,
        "instance": called(getattr(settings, shown)) if shown else None,
        "effectors": _effectors(settings.effector_weights, settings.collision_collection),
        "cache": cache,
    }


def _fluid(obj, modifier):
    kind = modifier.fluid_type
    settings = getattr(modifier, f"{kind.lower()}_settings", None) if kind != "NONE" else None
    if settings is None:
        return {"type": "NONE"}
    if kind == "FLOW":
        used = settings.use_inflow if settings.flow_behavior == "INFLOW" else True
        return {
            "type": kind,
            "kind": settings.flow_type,
            "behavior": settings.flow_behavior,
            "used": bool(used),
        }
    if kind == "EFFECTOR":
        return {"type": kind, "kind": settings.effector_type, "used": bool(settings.use_effector)}
    return {"type": kind, "kind": settings.domain_type, "domain": _domain(obj, settings)}


def _domain(obj, settings):
    scale = metres(bpy.context.scene)
    low, high = _box_of(obj)
    return {
        "kind": settings.domain_type,
        "resolution": settings.resolution_max,
        "use_mesh": settings.use_mesh,
        "use_noise": settings.use_noise,
        "use_guide": settings.use_guide,
        "guide_source": settings.guide_source,
        "guide_domain": called(settings.guide_parent),
        "flows": called(settings.fluid_group),
        "effectors": called(settings.effector_group),
        "low": vector(low, scale),
        "high": vector(high, scale),
        "cache": _fluid_cache(settings),
    }


def _box_of(obj):
    """The corners of the bounds, in world space, of an object's own mesh, before modifiers."""
    corners = [obj.matrix_world @ vertex.co for vertex in getattr(obj.data, "vertices", ())]
    corners = corners or [obj.matrix_world.translation]
    return [[choose(corner[axis] for corner in corners) for axis in range(3)] for choose in (min, max)]


def _effectors(weights, collisions):
    row = {"collisions": called(collisions)}
    if weights is not None:
        field_weights = {kind: number(getattr(weights, name, 1.0)) for kind, name in _WEIGHTS.items()}
        row["fields"] = called(weights.collection)
        row["weights"] = {kind: value for kind, value in field_weights.items() if value != 1.0}
    return row


_READERS = {"CLOTH": _cloth, "SOFT_BODY": _soft_body, "PARTICLE_SYSTEM": _particles, "FLUID": _fluid}
_KEYS = {"CLOTH": "cloth", "SOFT_BODY": "soft", "PARTICLE_SYSTEM": "particles", "FLUID": "fluid"}


# Rigid bodies


def rigid_body_of(obj, bodies):
    """Its rigid body, or None. ``bodies``: names of those in the world."""
    body = obj.rigid_body
    if body is None:
        return None
    return {
        "type": body.type,
        "shape": body.collision_shape,
        "mass": number(body.mass),
        "enabled": body.enabled,
        "kinematic": body.kinematic,
        "in_world": called(obj) in bodies,
    }


def rigid_constraint_of(obj, constraints):
    """The rigid-body constraint on it, or None. ``constraints``: names of those in the world."""
    joint = obj.rigid_body_constraint
    if joint is None:
        return None
    return {
        "type": joint.type,
        "enabled": joint.enabled,
        "first": called(joint.object1),
        "second": called(joint.object2),
        "disable_collisions": joint.disable_collisions,
        "in_world": called(obj) in constraints,
    }


def rigid_world_of(scene):
    """The scene's rigid-body world, or None."""
    world = scene.rigidbody_world
    if world is None or world.point_cache is None:
        return None
    return {
        "enabled": world.enabled,
        "bodies": _names(world.collection),
        "constraints": _names(world.constraints),
        "cache": point_cache(world.point_cache, scene),
    }


def _names(collection):
    return sorted(called(obj) for obj in collection.all_objects) if collection is not None else []


# Caches


def point_cache(cache, owner, lived=None):
    """A point cache. ``owner``: the object or scene that its files are named after.

    ``lived``: the first and last frame at which there is anything to keep; by default always.
    """
    first, last = cache.frame_start, cache.frame_end
    step = max(1, cache.frame_step)
    held = (first, last) if lived is None else (max(first, int(lived[0]), 1), min(last, int(lived[1])))
    return {
        "range": [first, last],
        "step": step,
        "is_baked": cache.is_baked,
        "frames": _frames_held(cache, owner),
        "expected": max(0, held[1] - held[0]) // step + 1 if held[1] >= held[0] else 0,
        "where": "external" if cache.use_external else "disk" if cache.use_disk_cache else "blend",
    }


def _frames_held(cache, owner):
    """How many frames it holds; for caches on disk, the number of frames with files, whatever Blender remembers."""
    if not cache.use_external and not cache.use_disk_cache:
        matches = _FRAMES.search(cache.info)
        return int(matches[1].replace(",", "")) if matches else 0
    if cache.use_external:
        folder = bpy.path.abspath(cache.filepath)
    elif bpy.data.filepath:
        place, name = os.path.split(bpy.data.filepath)
        folder = os.path.join(place, f"blendcache_{os.path.splitext(name)[0]}")
    else:
        return 0
    start = cache.name or owner.name.encode("utf-8", "surrogateescape").hex().upper()
    matches = (_POINT_FILE.match(name) for name in files_in(folder))
    return len({match[2] for match in matches if match and match[1] == start})


def _fluid_cache(settings):
    folder, moved = _fluid_folder(settings)
    parts = []
    for name in (*_FLUID_PARTS, "guiding"):
        matches = (_NUMBERED.search(file) for file in files_in(os.path.join(folder, name)))
        frames = {int(match[1]) for match in matches if match}
        if frames:
            parts.append({"name": name, "first": min(frames), "last": max(frames), "frames": len(frames)})
    baked = [name for name in (*_FLUID_PARTS, "guide") if getattr(settings, f"has_cache_baked_{name}", False)]
    return {
        "kind": settings.cache_type,
        "range": [settings.cache_frame_start, settings.cache_frame_end],
        "directory": text(settings.cache_directory),
        "moved": moved,
        "baked": baked,
        "parts": parts,
    }


def _fluid_folder(settings):
    """(path, moved) of a fluid's cache: where the file says, or else a folder of the same name beside the file."""
    folder = os.path.normpath(bpy.path.abspath(settings.cache_directory))
    if os.path.isdir(folder) or not bpy.data.filepath:
        return folder, False
    beside = os.path.join(os.path.dirname(bpy.data.filepath), os.path.basename(folder))
    return (beside, True) if os.path.isdir(beside) else (folder, False)


def take_moved_caches(objects):
    """Makes fluids whose cache was moved beside the file play from there. Files and flags stay."""
    for obj in objects:
        for modifier in obj.modifiers:
            settings = getattr(modifier, "domain_settings", None) if modifier.type == "FLUID" else None
            if settings is not None and modifier.fluid_type == "DOMAIN":
                folder, moved = _fluid_folder(settings)
                if moved:
                    settings.cache_directory = folder


def files_in(folder):
    """Names of the files in a folder, sorted; at most MOST_FILES of them; [] if there is no such folder."""
    names = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if len(names) == MOST_FILES:
                    break
                names.append(entry.name)
    except OSError:
        return []
    return sorted(names)
