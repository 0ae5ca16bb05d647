# SPDX-License-Identifier: GPL-3.0-or-later
"""Particles that have gone through what is to hold them: seen frame by frame, with the likely cause."""

import numpy
from mathutils import Vector

from ..blend.protocol_tags import GROUND, ROLE, SYSTEM
from ..geometry.evaluated_meshes import coordinates
from ..physics.caches import PARTICLES

_FOLLOWED = 500  # particles of a system
_PHYSICS = {"NEWTON", "FLUID"}
_DEEP = 0.01  # metres under a surface from which a particle is under it, at least
_UP = Vector((0, 0, 1))


def watches(scene, own):
    """A FallWatch for each particle system among some caches and each object that is to hold its particles."""
    return [
        FallWatch(cache, floor)
        for cache in own
        if cache.kind == PARTICLES and cache.holder.settings.physics_type in _PHYSICS
        for floor in _floors(scene, cache)
    ]


def _floors(scene, cache):
    """The meshes that particles collide with, and those of the ground, whether they collide with it or not."""
    only = cache.holder.settings.collision_collection
    colliding = scene.objects if only is None else only.all_objects
    floors = [obj for obj in colliding if _collides(obj) and obj.collision.permeability == 0]
    floors += [
        obj
        for child in scene.collection.children_recursive
        if child.get(ROLE) == SYSTEM and child.name == GROUND
        for obj in child.all_objects
        if not _collides(obj)
    ]
    return [obj for obj in floors if obj.type == "MESH" and obj != cache.owner and obj.visible_get()]


def _collides(obj):
    return obj.collision is not None and obj.collision.use


class FallWatch:
    """Which particles of a system have gone through one ``floor``.

    A particle has gone through if it is under the floor, was not before, and the straight way between crosses it: one
    that was blown over an edge and came back below has crossed nothing. While the floor moves, nothing is judged: it
    may have passed over the particle.
    """

    def __init__(self, cache, floor):
        self._cache, self._floor = cache, floor
        self._clear = {}  # number of a particle → where it was last with nothing of the floor above it
        self._seen, self._early, self._fallen = set(), set(), set()
        self._first = self._still = None

    def add(self, frame, graph):
        """Looks at the particles at a frame, the next after the one that was added."""
        owner = self._cache.owner.evaluated_get(graph)
        system = owner.particle_systems.get(self._cache.holder.name)
        if system is None or not len(system.particles):
            return
        floor = self._floor.evaluated_get(graph)
        self._step = -(-len(system.particles) // _FOLLOWED)
        inverse = floor.matrix_world.inverted_safe()
        low, high = box = _box(floor)
        if self._still is not None and not numpy.array_equal(box, self._still):
            self._clear.clear()
        self._still = box
        places = coordinates(system.particles, "location").astype(float)
        inside = ((places[:, :2] >= low[:2]) & (places[:, :2] <= high[:2]) & (places[:, 2:] <= high[2])).all(
            1
        )
        for number in range(0, len(places), self._step):
            particle = system.particles[number]
            if particle.alive_state != "ALIVE":
                continue
            if number not in self._seen:
                self._seen.add(number)
                if particle.birth_time < self._cache.range[0]:
                    self._early.add(number)
                    self._clear[number] = _middle(owner)
            if number in self._fallen:
                continue
            place = Vector(places[number])
            depth = _covered(floor, inverse, place) if inside[number] else None
            if depth is None:
                self._clear[number] = place
            elif depth > max(_DEEP, particle.size) and number in self._clear:
                if _crosses(floor, inverse, self._clear[number], place):
                    self._fallen.add(number)
                    self._first = frame if self._first is None else self._first
                del self._clear[number]

    def fault(self):
        """A sentence about the particles that have gone through it, with the likely cause; None if none has."""
        if not self._fallen:
            return None
        share = f"{len(self._fallen) * self._step} of {len(self._seen) * self._step}"
        about = "about " if self._step > 1 else ""
        return (
            f"{about}{share} particles of {self._cache.owner.name!r} have gone through {self._floor.name!r}, the first "
            f"by frame {self._first}: {self._cause()}."
        )

    def _cause(self):
        if not _collides(self._floor):
            return "it has no Collision modifier"
        first = self._cache.range[0]
        if self._fallen & self._early:
            return (
                f"they were born before the cache's first frame, {first}, to which particles are taken in one step, "
                f"without meeting anything; frame_start of the emission must be {first} or later"
            )
        return "they are too fast for it: more subframes, or a closed mesh of more thickness"


def _box(evaluated):
    corners = numpy.array([evaluated.matrix_world @ Vector(corner) for corner in evaluated.bound_box])
    return corners.min(axis=0), corners.max(axis=0)


def _middle(evaluated):
    low, high = _box(evaluated)
    return Vector((*(low[:2] + high[:2]) / 2, high[2]))


def _covered(floor, inverse, place):
    """How far above a place the first surface of the floor is, in metres; None if there is none."""
    hit = _hit(floor, inverse, place, place + _UP * (2 * floor.dimensions.length + 1e4))
    return None if hit is None else (hit - place).length


def _crosses(floor, inverse, start, end):
    return _hit(floor, inverse, start, end) is not None


def _hit(floor, inverse, start, end):
    """Where the straight way from one place to another first meets a floor; None if it does not."""
    begin, way = inverse @ start, inverse @ end - inverse @ start
    if not way.length:
        return None
    found, place, _, _ = floor.ray_cast(begin, way.normalized(), distance=way.length)
    return floor.matrix_world @ place if found else None
