# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the first frame at which a simulation is no longer a number, and why that may be."""

import numpy

from simworlds.sandbox.inside.refusal import Refused

from ..geometry.evaluated_meshes import are_finite, coordinates
from . import caches

_EVALUATES_TO_VERTICES = {caches.CLOTH, caches.SOFT_BODY, caches.FLUID, caches.DYNAMIC_PAINT}
_SHORT_EDGE = 1e-6
_LIGHT = 1e-6  # kg
_STIFF = 0.9


class Diverged(Refused):
    """A simulation is not finite: its ``cache``, ``object`` (a name), the first such ``frame``, and likely ``causes``.

    ``what`` is the message without the causes.
    """

    def __init__(self, cache, name, frame, scene):
        self.cache, self.object, self.frame = cache, name, frame
        self.what = (
            f"At frame {frame} the simulation breaks down: {cache.label} has coordinates that are not finite"
        )
        self.what += "." if name == cache.object else f" ({name!r})."
        self.causes = likely_causes(cache, scene, name)
        super().__init__(
            f"{self.what} Likely cause: {'; or '.join(self.causes)}." if self.causes else self.what
        )


class DivergenceWatch:
    """Checks every frame that is visited."""

    def __init__(self, scene, chosen=None):
        """``chosen``: the caches to check; None for all that are switched on."""
        self._scene = scene
        if chosen is None:
            chosen = [cache for cache in caches.find_caches(scene) if cache.simulated]
        self._caches = chosen

    def check(self, frame, graph):
        """Raises Diverged if a simulation is not finite in the evaluated dependency graph of ``frame``."""
        for cache in self._caches:
            name = _lost_object(cache, graph)
            if name is not None:
                raise Diverged(cache, name, frame, self._scene)


def _lost_object(cache, graph):
    """The name of the object that is not where it could be; None if all are."""
    if cache.kind == caches.RIGID_BODY:
        collection = cache.owner.rigidbody_world.collection
        for obj in collection.objects if collection is not None else ():
            if not are_finite(numpy.array(obj.evaluated_get(graph).matrix_world)):
                return obj.name
        return None
    evaluated = cache.owner.evaluated_get(graph)
    if cache.kind in _EVALUATES_TO_VERTICES:
        data = evaluated.data
        lost = hasattr(data, "vertices") and not are_finite(coordinates(data.vertices))
    elif cache.kind == caches.PARTICLES:
        system = evaluated.particle_systems.get(cache.holder.name)
        lost = system is not None and not are_finite(coordinates(system.particles, "location"))
    else:
        lost = False
    return cache.owner.name if lost else None


# Why


def likely_causes(cache, scene, name):
    """Half sentences on why the solver of ``cache`` broke down, the likeliest first. ``name``: of the lost object."""
    obj = scene.objects.get(name)
    causes = [] if obj is None else list(_of_shape(obj))
    return causes + list(_OF_SOLVER.get(cache.kind, lambda _cache, _scene: ())(cache, scene))


def _of_shape(obj):
    if not are_finite(numpy.array(obj.matrix_world)):
        yield f"the transform of {obj.name!r} is not finite itself"
    if min(map(abs, obj.scale)) < _SHORT_EDGE:
        yield f"the scale of {obj.name!r} is 0 along an axis"
    vertices = getattr(obj.data, "vertices", None)
    if vertices is None or not len(vertices):
        return
    places = coordinates(vertices)
    if not are_finite(places):
        yield f"the mesh of {obj.name!r} has vertices that are not finite before it is simulated"
        return
    ends = numpy.empty(2 * len(obj.data.edges), numpy.int32)
    obj.data.edges.foreach_get("vertices", ends)
    lengths = numpy.linalg.norm(places[ends[::2]] - places[ends[1::2]], axis=1)
    if short := int((lengths < _SHORT_EDGE).sum()):
        yield f"{short} edges of {obj.name!r} have no length: merge vertices by distance"


def _cloth(cache, _scene):
    settings = cache.holder.settings
    if settings.mass < _LIGHT:
        yield f"settings.mass is {settings.mass:g} kg a vertex: raise it"
    yield (
        f"springs too stiff for the steps: raise settings.quality ({settings.quality}), or lower tension_stiffness "
        f"({settings.tension_stiffness:g}) and its like"
    )
    if settings.use_pressure:
        yield f"pressure (uniform_pressure_force {settings.uniform_pressure_force:g}): lower it"
    if cache.holder.collision_settings.use_self_collision:
        yield "self-collision of parts that begin nearer than self_distance_min"


def _soft_body(cache, _scene):
    settings = cache.holder.settings
    if settings.mass < _LIGHT:
        yield f"settings.mass is {settings.mass:g}: raise it"
    stiff = max(settings.pull, settings.push, settings.bend if settings.use_stiff_quads else 0.0)
    if stiff >= _STIFF:
        yield f"springs too stiff for the steps (pull {settings.pull:.2f}, push {settings.push:.2f}): lower them"
    if settings.use_goal and settings.goal_spring >= _STIFF:
        yield f"goal_spring {settings.goal_spring:.2f} is too stiff: lower it, or raise goal_friction"
    yield (
        f"too few steps: raise step_min ({settings.step_min}), lower error_threshold "
        f"({settings.error_threshold:g}), raise damping ({settings.damping:g})"
    )


def _bodies(cache, _scene):
    world = cache.holder
    collection = world.collection
    bodies = (
        [obj.rigid_body for obj in collection.objects if obj.rigid_body] if collection is not None else []
    )
    masses = [body.mass for body in bodies if body.type == "ACTIVE"]
    if masses and max(masses) > 1e4 * max(min(masses), _LIGHT):
        yield f"masses from {min(masses):g} to {max(masses):g} kg in one world: bring them nearer to each other"
    yield "bodies that begin inside each other, or joints between bodies that cannot meet"
    yield f"too few steps: raise substeps_per_frame ({world.substeps_per_frame})"


def _particles(_cache, scene):
    fields = [obj.name for obj in scene.objects if obj.field is not None and obj.field.type != "NONE"]
    if fields:
        named = ", ".join(map(repr, fields[:4]))
        yield f"a force field that is too strong ({named}): lower its strength, or set its distance_min"
    yield "a time step that is too long: raise settings.subframes"


def _fluid(cache, _scene):
    domain = cache.domain
    yield (
        f"too few steps: raise timesteps_max ({domain.timesteps_max}), or lower cfl_condition "
        f"({domain.cfl_condition:g})"
    )


_OF_SOLVER = {
    caches.CLOTH: _cloth,
    caches.SOFT_BODY: _soft_body,
    caches.RIGID_BODY: _bodies,
    caches.PARTICLES: _particles,
    caches.FLUID: _fluid,
}
