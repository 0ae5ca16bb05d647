# SPDX-License-Identifier: GPL-3.0-or-later
"""Actors: objects and collections whose motion is followed, and where their geometry is at a frame."""

from contextlib import contextmanager

import bpy
import numpy
from mathutils import Vector

from simworlds.sandbox.inside.refusal import Refused

from ..blend.fluids import domain_of, is_empty_domain
from ..blend.named_objects import objects_named
from ..blend.protocol_tags import ROOT, object_collections
from ..blend.visibility import comes_and_goes
from ..geometry.evaluated_meshes import coordinates, transformed

_EVALUATES_TO_MESH = {"CURVE", "SURFACE", "META", "FONT"}
_DOTS = 500  # particles that a picture shows at least by a dot
_EMITTING = {"EMITTER", "FLIP"}
_SWARM = 20  # particles from which the farthest ones do not count for where most are
_MOST = (5, 95)  # per cent between which, along each axis, most are
_THIN = 0.01  # density up to which a cell of gas counts as empty


class Actor:
    """What moves as one: ``name``, its ``objects``, and what of them is ``measured``.

    ``most``: about how many of its points are followed, evenly chosen; None for all. Of particles all are.
    """

    def __init__(self, name, kind, objects, most=None):
        self.name, self.kind, self.objects = name, kind, objects
        self._most = None if most is None else max(1, most // len(objects))
        self._areas = None
        self._comes_and_goes = all(map(comes_and_goes, objects))
        if any(_particles(obj) for obj in objects):
            self.measured = "particles"
        elif any(domain_of(obj) for obj in objects):
            self.measured = "fluid"
        elif any(_has_surface(obj) for obj in objects):
            self.measured = "vertices"
        else:
            self.measured = "origin"

    def state_at(self, graph):
        """Its state in an evaluated dependency graph.

        None if it does not exist at that frame (no particle born yet, or keys hide it from renders), or has coordinates
        that are not finite.
        """
        if self._comes_and_goes and all(obj.hide_render for obj in self.objects):
            return None
        evaluated = [obj.evaluated_get(graph) for obj in self.objects]
        if self.measured == "particles":
            parts = [part for obj in evaluated for part in _particle_places(obj)]
            if not parts:
                return None
            places, alive = (numpy.concatenate(each) for each in zip(*parts, strict=True))
            state = ActorState(places, alive=alive)
        elif self.measured == "fluid":
            fluids = [_fluid(obj) for obj in evaluated if domain_of(obj) is not None]
            fluids = [fluid for fluid in fluids if fluid is not None]
            if not fluids:
                return None
            places, weights = (numpy.concatenate(each) for each in zip(*fluids, strict=True))
            state = ActorState(places, weights=weights)
        else:
            places = numpy.concatenate(
                [
                    _surface(obj, self._most) if self.measured == "vertices" else _origin(obj)
                    for obj in evaluated
                ]
            )
            if not len(places):
                state = ActorState(_instances(self.objects, graph))
            else:
                if self.measured == "vertices" and (self._areas is None or len(self._areas) != len(places)):
                    self._areas = numpy.concatenate([_areas(obj, self._most) for obj in evaluated])
                state = ActorState(places, areas=self._areas)
        return state if state.is_there else None


class ActorState:
    """An actor at one frame.

    ``places`` (n × 3, metres) are those of its points, the same ones in every state with as many; ``alive`` is a mask
    of those that exist. Points with ``weights``, as of a fluid, are not the same from frame to frame; ``areas`` are
    those of the surface around each point. ``centre`` is the mean of the places, by either, ``low`` and ``high`` are
    the corners of the box along the world's axes, ``core`` those of the box that a picture is to show: of a swarm that
    where most are. ``covariance`` (3 × 3, m²) says how far the places are spread about their mean.
    """

    def __init__(self, places, *, alive=None, weights=None, areas=None):
        self.places = places
        self.alive = numpy.ones(len(places), bool) if alive is None else alive
        self.weights = weights
        is_known = areas is not None and len(areas) == len(places) and areas.sum() > 0
        self.areas = areas if is_known else None
        self.is_followed = weights is None
        there = places[self.alive]
        self.is_there = bool(len(there)) and bool(numpy.isfinite(there).all())
        if self.is_there:
            self.centre = Vector(
                numpy.average(there, axis=0, weights=weights if self.areas is None else self.areas)
            )
            self.low, self.high = Vector(there.min(axis=0)), Vector(there.max(axis=0))
            self.core = self.low, self.high
            if alive is not None and len(there) >= _SWARM:
                self.core = tuple(map(Vector, numpy.percentile(there, _MOST, axis=0)))
            self.covariance = numpy.cov(there, rowvar=False, bias=True, aweights=weights)

    def sample(self, count):
        """About ``count`` of its points, evenly chosen."""
        there = self.places[self.alive]
        return [Vector(place) for place in there[:: max(1, len(there) // count)].tolist()]


def dots_of(actor, state):
    """Places at which a picture gets dots to show an actor: those of particles, which are small; else none."""
    return state.sample(_DOTS) if actor.measured == "particles" and state is not None else []


def resolve(names, scene, most=None):
    """The actors of these names, see ``objects_named``. Raises Refused.

    ``most``: about how many points of each are followed; None for all.
    """
    layer = bpy.context.view_layer
    tagged = {one.name for one in object_collections(scene)}
    actors = []
    for name, objects in objects_named(scene, names).items():
        kind = "object collection" if name in tagged else "object" if name in scene.objects else "collection"
        if not objects:
            raise Refused(f"The collection {name!r} is empty.")
        there = [obj for obj in objects if obj.name in layer.objects]
        if not there:
            raise Refused(f"{name!r} is not in the view layer {layer.name!r}, so it does not move.")
        actors.append(Actor(name, kind, _with_geometry(there), most))
    return actors


def _with_geometry(objects):
    """The objects with visible geometry; of an Empty alone, its children's; else the root or first object."""
    visible = [obj for obj in objects if _has_surface(obj) or _particles(obj)]
    if not visible:
        layer = bpy.context.view_layer
        below = [child for obj in objects for child in obj.children_recursive]
        visible = [child for child in below if child.name in layer.objects and _has_surface(child)]
    if visible:
        return sorted(set(visible), key=lambda obj: obj.name)
    roots = [obj for obj in objects if obj.get(ROOT)]
    return roots[:1] or objects[:1]


def _has_surface(obj):
    return obj.type == "MESH" or obj.type in _EVALUATES_TO_MESH or obj.instance_type == "COLLECTION"


def _particles(obj):
    """Numbers of the particle systems that stand for an object's motion."""
    domain = domain_of(obj)
    if domain is not None and domain.use_mesh:
        return []
    return [index for index, system in enumerate(obj.particle_systems) if system.settings.type in _EMITTING]


def round_to(number, step=1e-4):
    """A number rounded for reports; None stays None."""
    return None if number is None else round(round(number / step) * step, 6)


def thin_out(elements, most):
    """At most ``most`` elements (None: all), evenly chosen; the same ones each time for the same number."""
    return elements if most is None else elements[:: -(-len(elements) // most) or 1]


@contextmanager
def _mesh_of(evaluated):
    """An object's evaluated mesh while it is in use; None for one without a surface."""
    if evaluated.type == "MESH":
        yield evaluated.data
        return
    try:
        mesh = evaluated.to_mesh() if evaluated.type in _EVALUATES_TO_MESH else None
    except RuntimeError:  # it has no surface
        mesh = None
    yield mesh
    if mesh is not None:
        evaluated.to_mesh_clear()


def _surface(evaluated, most=None):
    """The vertices of an object's evaluated geometry."""
    with _mesh_of(evaluated) as mesh:
        if mesh is None:
            return numpy.empty((0, 3))
        return transformed(thin_out(coordinates(mesh.vertices), most), evaluated.matrix_world)


def _areas(evaluated, most=None):
    """The area around each vertex that ``_surface`` gives, before the object is scaled; all 1 without faces."""
    with _mesh_of(evaluated) as mesh:
        return numpy.empty(0) if mesh is None else thin_out(_vertex_areas(mesh), most)


def _vertex_areas(mesh):
    sizes, corners = numpy.empty(len(mesh.polygons)), numpy.empty(len(mesh.loops), numpy.int32)
    totals = numpy.empty(len(mesh.polygons), numpy.int32)
    mesh.polygons.foreach_get("area", sizes)
    mesh.polygons.foreach_get("loop_total", totals)
    mesh.loops.foreach_get("vertex_index", corners)
    shares = numpy.repeat(sizes / numpy.maximum(totals, 1), totals)
    areas = numpy.bincount(corners, shares, len(mesh.vertices))
    return areas if numpy.isfinite(areas).all() and areas.sum() > 0 else numpy.ones(len(mesh.vertices))


def _particle_places(evaluated):
    """(places, whether there to be seen) of each system of an object: alive, or dead and shown so."""
    named = bpy.types.Particle.bl_rna.properties["alive_state"].enum_items
    for index in _particles(evaluated):
        system = evaluated.particle_systems[index]
        particles, settings = system.particles, system.settings
        states = numpy.empty(len(particles), numpy.int32)
        particles.foreach_get("alive_state", states)
        shown = ["ALIVE", *["DEAD"] * settings.use_dead]
        yield (
            coordinates(particles, "location").astype(float),
            numpy.isin(states, [named[name].value for name in shown]),
        )


def _fluid(evaluated):
    """(places, weights) of a domain's fluid: the vertices of a liquid's surface, the cells of a gas; None for none."""
    domain = domain_of(evaluated)
    if domain.domain_type == "GAS":
        return _gas(evaluated, domain)
    if is_empty_domain(evaluated):
        return None
    places = _surface(evaluated)
    return places, numpy.ones(len(places))


def _gas(evaluated, domain):
    across = tuple(domain.domain_resolution)
    density = numpy.array(domain.density_grid[:], float)
    if len(density) != numpy.prod(across):
        return None
    flames = domain.flame_grid[:]
    if len(flames) == len(density):
        density += flames
    filled = numpy.flatnonzero(density > _THIN)
    low, high = (numpy.array(evaluated.bound_box[at]) for at in (0, 6))
    cells = numpy.stack(
        [filled % across[0], filled // across[0] % across[1], filled // (across[0] * across[1])], 1
    )
    return transformed(low + (cells + 0.5) * ((high - low) / across), evaluated.matrix_world), density[filled]


def _instances(objects, graph):
    """The corners of the boxes of all instances that some objects make."""
    names = {obj.name for obj in objects}
    boxes = [
        transformed(numpy.array(instance.object.bound_box), instance.matrix_world)
        for instance in graph.object_instances
        if instance.is_instance and instance.parent is not None and instance.parent.original.name in names
    ]
    return numpy.concatenate([numpy.empty((0, 3)), *boxes])


def _origin(evaluated):
    """Points of an object without geometry: the ends of its bones, or points on its axes, which show its rotation."""
    if evaluated.pose is not None:
        ends = [end for bone in evaluated.pose.bones for end in (bone.head, bone.tail)]
        return transformed(numpy.array(ends).reshape(-1, 3), evaluated.matrix_world)
    reach = max(evaluated.empty_display_size, 0.05)
    matrix = evaluated.matrix_world.normalized()
    return transformed(reach * numpy.concatenate([numpy.eye(3), -numpy.eye(3)]), matrix)
