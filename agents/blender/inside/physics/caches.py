# SPDX-License-Identifier: GPL-3.0-or-later
"""The physics caches of a scene: what each belongs to, its frame range, and whether its frames exist."""

import os
import re

import bpy

from . import bake_inputs, rigid_body_inputs

CLOTH, SOFT_BODY, PARTICLES, HAIR = "cloth", "soft_body", "particles", "hair"
RIGID_BODY, DYNAMIC_PAINT, FLUID = "rigid_body", "dynamic_paint", "fluid"

_OF_MODIFIER = {"CLOTH": CLOTH, "SOFT_BODY": SOFT_BODY}
_NAMED = 5  # of what has changed since a bake
_UNITS = {"B": 1, "KiB": 1024, "MiB": 1024**2, "GiB": 1024**3, "TiB": 1024**4}


class PhysicsCache:
    """One cache. ``owner`` is an object, or the scene for its rigid-body world; ``holder`` has the settings:
    a modifier, a particle system, a dynamic-paint surface, the rigid-body world.

    Valid until data-blocks or modifiers are removed.
    """

    def __init__(self, kind, owner, holder, modifier=None):
        self.kind = kind
        self.owner = owner
        self.holder = holder
        self.modifier = modifier  # None for the rigid-body world
        self.domain = holder.domain_settings if kind == FLUID else None  # a bpy.types.FluidDomainSettings
        self.points = None if kind == FLUID else holder.point_cache  # a bpy.types.PointCache

    @property
    def object(self):
        """The name of the object; None for the rigid-body world, which is the scene's."""
        return None if self.kind == RIGID_BODY else self.owner.name

    @property
    def label(self):
        """A description, such as ``cloth of 'Flag'``."""
        if self.kind == RIGID_BODY:
            return "the rigid-body world"
        kind = self.kind.replace("_", " ")
        if self.kind == FLUID:
            kind = "gas" if self.domain.domain_type == "GAS" else "liquid"
        return f"{kind} of {self.owner.name!r}"

    @property
    def range(self):
        """(first, last) frame that the cache is for."""
        if self.domain is not None:
            return self.domain.cache_frame_start, self.domain.cache_frame_end
        return self.points.frame_start, self.points.frame_end

    @range.setter
    def range(self, frames):
        first, last = frames
        if self.domain is not None:
            settings, names = self.domain, ("cache_frame_start", "cache_frame_end")
        else:
            settings, names = self.points, ("frame_start", "frame_end")
        # Blender keeps start ≤ end: the end goes first, and again in case the old start held it back.
        for name, value in ((names[1], last), (names[0], first), (names[1], last)):
            setattr(settings, name, value)
        if self.kind == DYNAMIC_PAINT:
            # Blender sets the cache's range from these whenever it reads it.
            self.holder.frame_end, self.holder.frame_start, self.holder.frame_end = last, first, last

    @property
    def expected(self):
        """(first, last) frame that a bake over the range fills: an emitter has none before and after its particles."""
        first, last = self.range
        if self.kind == PARTICLES:
            settings = self.holder.settings
            first = max(first, int(settings.frame_start), 1)
            last = min(last, int(settings.frame_end + settings.lifetime + 1))
        return first, last

    @property
    def simulated(self):
        """Whether the simulation is switched on."""
        if self.kind == RIGID_BODY:
            return self.holder.enabled
        return self.modifier.show_viewport

    @property
    def baked(self):
        """Whether Blender considers it baked."""
        domain = self.domain
        if domain is None:
            return self.points.is_baked
        if not domain.has_cache_baked_data:
            return False
        if domain.domain_type == "LIQUID":
            return not domain.use_mesh or domain.has_cache_baked_mesh
        return not domain.use_noise or domain.has_cache_baked_noise

    @property
    def outdated(self):
        """Whether something was changed since it was filled."""
        if self.kind == RIGID_BODY and self.points.is_baked:
            return rigid_body_inputs.is_outdated(self.owner)
        if self.domain is None and self.points.is_outdated:
            return True
        return self.baked and bool(self.changed)

    @property
    def changed(self):
        """What has changed since it was baked, as far as that is known: ``its settings``, ``'Table'``, …"""
        return bake_inputs.changed_since_bake(self)

    @property
    def folder(self):
        """The folder of its frames (absolute path); None if they are kept in memory and in the .blend."""
        if self.domain is not None:
            return os.path.normpath(bpy.path.abspath(self.domain.cache_directory))
        if self.points.use_external:
            return os.path.normpath(bpy.path.abspath(self.points.filepath))
        if self.points.use_disk_cache and bpy.data.filepath:
            beside, name = os.path.split(bpy.data.filepath)
            return os.path.join(beside, f"blendcache_{os.path.splitext(name)[0]}")
        return None

    @property
    def frames(self):
        """How many frames of its range exist."""
        if self.domain is not None:
            first, last = self.range
            return sum(first <= frame <= last for frame in self._frames_on_disk())
        match = re.match(r"\s*([\d,.\s]*\d)\s+(?:frames?|points?)", self.points.info)
        return int(re.sub(r"\D", "", match[1])) if match else 0

    @property
    def bytes(self):
        """Its size, in memory or on disk."""
        if self.domain is not None:
            return sum(os.path.getsize(path) for path in _files(self.folder))
        if self.folder:
            # One file for each frame; those of other caches are beside them.
            start = file_prefix(self.points, self.owner)
            return sum(
                os.path.getsize(path)
                for path in _files(self.folder)
                if os.path.basename(path).startswith(start)
            )
        return bytes_in_memory(self.points) or 0

    @property
    def missing(self):
        """How many frames that a bake over the range would fill do not exist."""
        first, last = self.expected
        if self.domain is not None:
            return len(set(range(first, last + 1)) - self._frames_on_disk())
        step = max(1, self.points.frame_step)
        return max(0, max(0, last - first) // step + 1 - self.frames) if last >= first else 0

    def _frames_on_disk(self):
        """The frames of a fluid for which every part that its settings need is on disk."""
        wanted = ["data"]
        if self.domain.domain_type == "LIQUID" and self.domain.use_mesh:
            wanted.append("mesh")
        if self.domain.domain_type == "GAS" and self.domain.use_noise:
            wanted.append("noise")
        by_part = [_numbers(os.path.join(self.folder, name)) for name in wanted]  # pyright: ignore[reportCallIssue]
        return set.intersection(*by_part)

    def describe(self):
        """The cache as JSON data."""
        first, last = self.range
        return {
            "kind": self.kind,
            "object": self.object,
            "name": getattr(self.holder, "name", ""),
            "range": [first, last],
            "baked": self.baked,
            "outdated": self.outdated,
            "frames": self.frames,
            "missing": self.missing,
            "bytes": self.bytes,
            "folder": self.folder,
        }


def find_caches(scene):
    """The caches of a scene: the rigid-body world's, then object by object."""
    caches = []
    world = scene.rigidbody_world
    if world is not None and world.point_cache is not None:
        caches.append(PhysicsCache(RIGID_BODY, scene, world))
    for obj in scene.objects:
        caches += caches_of(obj)
    return caches


def caches_of(obj):
    """The caches of an object."""
    return [cache for modifier in obj.modifiers for cache in _of_modifier(obj, modifier)]


def file_prefix(points, owner):
    """How the files of a point cache are named: after the cache, or after its object or scene in hexadecimal."""
    return f"{points.name or owner.name.encode(errors='surrogateescape').hex().upper()}_"


def bytes_in_memory(points):
    """The size of a point cache in memory, as Blender says it; None if it does not say."""
    match = re.search(r"\(([\d.,]+)\s*(bytes|[KMGT]?i?B)\)", points.info)
    return round(float(match[1].replace(",", "")) * _UNITS.get(match[2], 1)) if match else None


def of_objects(scene, names):
    """Those caches of a scene that the named objects take part in: their own, and that of the rigid-body world."""
    names = set(names)
    takes_part = any(obj.name in names and obj.rigid_body is not None for obj in scene.objects)
    return [
        cache
        for cache in find_caches(scene)
        if (takes_part if cache.kind == RIGID_BODY else cache.owner.name in names)
    ]


def unbaked(scene):
    """The caches that do not allow skipping frames.

    ``start`` is the frame from which to step. What is switched off in the viewport is not simulated.
    """
    return [
        {"kind": cache.kind, "object": cache.object, "label": cache.label, "start": cache.range[0]}
        for cache in find_caches(scene)
        if cache.simulated and not (cache.baked and not cache.outdated)
    ]


def stale(scene):
    """The baked caches that are older than what they depend on: Blender plays them as they are."""
    return [cache for cache in find_caches(scene) if cache.baked and cache.outdated]


def describe_stale(cache):
    """``cloth of 'Flag' (changed since: its settings)``."""
    changed = cache.changed
    if not changed:
        return cache.label
    more = f" and {len(changed) - _NAMED} more" if len(changed) > _NAMED else ""
    return f"{cache.label} (changed since: {', '.join(changed[:_NAMED])}{more})"


def restart_unbaked(scene):
    """Makes simulations that are not baked start again at their first frame.

    After a jump to a frame, Blender keeps the state there and would use it as a result when it steps through later.
    """
    for cache in find_caches(scene):
        if cache.simulated and cache.points is not None and not cache.baked:
            restart(cache)


def restart(cache):
    """Makes a simulation that is not baked, and is no fluid, start again at its first frame."""
    cache.points.frame_step = cache.points.frame_step  # setting it, to any value, marks the cache as outdated


def _of_modifier(obj, modifier):
    if modifier.type in _OF_MODIFIER:
        yield PhysicsCache(_OF_MODIFIER[modifier.type], obj, modifier, modifier)
    elif modifier.type == "PARTICLE_SYSTEM":
        # Hair that does not move has no cache, and a fluid's particles are kept in the fluid's.
        system = modifier.particle_system
        settings = system.settings if system is not None else None
        if settings is not None and settings.type == "EMITTER":
            yield PhysicsCache(PARTICLES, obj, system, modifier)
        elif settings is not None and settings.type == "HAIR" and system.use_hair_dynamics:
            yield PhysicsCache(HAIR, obj, system, modifier)
    elif modifier.type == "DYNAMIC_PAINT" and modifier.canvas_settings is not None:
        for surface in modifier.canvas_settings.canvas_surfaces:
            if surface.is_cache_user:
                yield PhysicsCache(DYNAMIC_PAINT, obj, surface, modifier)
    elif (
        modifier.type == "FLUID" and modifier.fluid_type == "DOMAIN" and modifier.domain_settings is not None
    ):
        yield PhysicsCache(FLUID, obj, modifier, modifier)


def _files(folder):
    for place, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(place, name)
            if os.path.isfile(path):
                yield path


def _numbers(folder):
    """The frames of files that are called …_0012.vdb or the like."""
    try:
        names = os.listdir(folder)
    except OSError:
        return set()
    return {int(match[1]) for name in names if (match := re.search(r"_(-?\d{4,})\.", name))}
