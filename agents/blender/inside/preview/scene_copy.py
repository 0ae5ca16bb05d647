# SPDX-License-Identifier: GPL-3.0-or-later
"""A copy of a scene's visible geometry at this frame: with modifiers, simulations, instances, hair and particles."""

import copy
import itertools
import math
from array import array

import bpy
from mathutils import Matrix, Vector

from simworlds.sandbox.inside.refusal import Refused

from ..blend.fluids import domain_of
from ..blend.visibility import rendered_objects
from .material_colours import PreviewMaterial, surface_of
from .proxy_meshes import gas_cells, octahedra, tubes

INSTANCES = 6000  # that are shown; of more, only every second, third, …
_TO_MESH = {"CURVE", "SURFACE", "FONT", "META"}
_AS_THEY_ARE = {"CURVES", "POINTCLOUD", "VOLUME"}
_GREASE_PENCIL = "GREASEPENCIL"
DRAWABLE = {"MESH", _GREASE_PENCIL, *_TO_MESH, *_AS_THEY_ARE}
_MOST_PIECES = 12_000
_BEYOND = 1e12  # metres; NaN counts as beyond, too
_STROKE = 0.004  # thickness of a strand, in sizes of its object
_STRANDS = 2000  # hairs of a system that are shown


class Piece:
    """A drawn object or instance: ``owner`` is the name of its object, ``data`` belongs to the studio scene, ``low``
    and ``high`` are the ends of its box along the world's axes, ``corners`` those of a box around it."""

    is_solid = True  # False for smoke, strands, dots
    is_liquid = False
    is_helper = False  # a fluid's domain, or what is only outlined in the viewport
    is_mover = False  # it moves by itself: a door, not a wall

    def __init__(self, owner, data, matrix, corners, *, exactly=True):
        self.owner, self.data, self.matrix = owner, data, matrix
        self.corners = [matrix @ corner for corner in corners]
        ends = self.corners
        if exactly and isinstance(data, bpy.types.Mesh) and not _keeps_axes(matrix):
            moved = data.copy()
            moved.transform(matrix)
            ends = _corners_of(moved)
            bpy.data.meshes.remove(moved)
        self.low = Vector(min(end[axis] for end in ends) for axis in range(3))
        self.high = Vector(max(end[axis] for end in ends) for axis in range(3))

    def outline(self, most):
        """Points in the world that outline it: about ``most`` of its vertices, or its corners."""
        if not isinstance(self.data, bpy.types.Mesh) or len(self.data.vertices) < 4:
            return self.corners
        flat = _coordinates(self.data)
        step = max(1, len(self.data.vertices) // most)
        return [self.matrix @ Vector(flat[at : at + 3]) for at in range(0, len(flat), 3 * step)]


def _is_particle(instance):
    """Whether an instance is a particle shown as one object: renders show it where they do not show that object."""
    system = instance.particle_system
    return system is not None and system.settings.render_type == "OBJECT"


class SceneCopy:
    """``pieces``, and the names of what is missing: ``broken`` (with why), ``hidden`` in the viewport, ``unrendered``,
    ``empty``; ``left_out`` counts instances, of the objects ``templates``; ``gases``: the domains whose gas is drawn,
    ``gasless``: those that have none at this frame.
    ``studio`` owns all data-blocks."""

    def __init__(self, studio, graph, objects, *, unrendered=False):
        """Copies ``objects`` of the scene (None: all), with ``unrendered`` also those that renders do not show."""
        self._studio, self._graph = studio, graph
        self._copies, self._surfaces, self._averages = {}, {}, {}
        self.pieces, self.broken, self.left_out, self.templates = [], {}, 0, set()
        self.gases, gas_domains = set(), set()
        names = None if objects is None else {obj.name for obj in objects}
        layer = graph.view_layer
        rendered = None if unrendered else {obj.name for obj in rendered_objects(layer.layer_collection)}
        met, not_rendered = self._copy_instances(names, rendered, gas_domains)
        candidates = {
            obj.name
            for obj in (layer.objects if objects is None else objects)
            if obj.type in DRAWABLE and obj.name in (rendered or layer.objects)
        }
        self.unrendered = sorted(not_rendered)
        self.hidden = sorted(candidates - met)
        drawn = {piece.owner for piece in self.pieces}
        undrawn = (candidates & met) - drawn - set(self.broken) - _metaballs(layer)
        self.gasless = sorted(undrawn & gas_domains)
        self.empty = sorted(undrawn - gas_domains)

    def copy_unevaluated(self, obj):
        """Copies an object that is hidden, and so not evaluated: without its modifiers."""
        data = self._studio.owned(bpy.data.meshes.new_from_object(obj))
        self._colour_and_add(obj.name, data, obj, obj.matrix_world.copy())

    def _copy_instances(self, names, rendered, gas_domains):
        """Copies the instances; returns the names of the visible objects, and of those that renders do not show.

        ``gas_domains`` gets the names of the domains of gas among them.
        """
        met, not_rendered, placed, count = set(), set(), set(), 0
        instances = self._graph.object_instances
        step = max(1, math.ceil(len(instances) / INSTANCES))
        for instance in instances:
            if len(self.pieces) > _MOST_PIECES:
                raise Refused(
                    f"More than {_MOST_PIECES} objects are too many for one picture: preview a part of them."
                )
            obj = instance.object
            owner = (instance.parent if instance.is_instance else obj).original
            if names is not None and owner.name not in names:
                continue
            met.add(owner.name)
            if rendered is not None and owner.name not in rendered:
                not_rendered.add(owner.name)
                continue
            matrix = instance.matrix_world.copy()
            if not _is_finite(matrix):
                self.broken[owner.name] = "its transform is not finite, or far too large"
                continue
            if instance.is_instance:
                self.templates.add(obj.original.name)
                if rendered is not None and obj.original.hide_render and not _is_particle(instance):
                    continue
                count += 1
                if count % step:
                    self.left_out += 1
                    continue
            else:
                self._copy_particles_and_gas(obj, matrix)
                if _gas_of(obj):
                    gas_domains.add(owner.name)
                    continue
                if not instance.show_self:
                    continue
            # Text, curves and metaballs come twice: as themselves, and as an instance of their mesh.
            is_made = instance.is_instance and obj.type == "MESH" and owner.type in _TO_MESH
            place = (owner.name, tuple(map(tuple, matrix)))
            if is_made and (place, len(obj.data.vertices)) in placed:
                continue
            placed.add((place, self._copy_instance(owner.name, obj, matrix)))
        return met, not_rendered

    def _copy_instance(self, owner, obj, matrix):
        """Copies an object's geometry; returns its number of vertices, None if it is not a mesh."""
        if obj.data is None or obj.type not in DRAWABLE:
            return None
        key = (
            obj.data.as_pointer(),
            obj.as_pointer() if obj.type in _TO_MESH else 0,
            tuple(
                slot.material.name_full
                for slot in obj.material_slots
                if slot.link == "OBJECT" and slot.material
            ),
            tuple(obj.color),
        )
        if key not in self._copies:
            copied = self._copy_data(obj)
            vertices = len(copied.vertices) if isinstance(copied, bpy.types.Mesh) else None
            self._copies[key] = (*self._colour_and_add(owner, copied, obj, matrix), vertices)
            return vertices
        data, corners, vertices = self._copies[key]
        if data is not None:
            self._add(Piece(owner, data, matrix, corners, exactly=False), obj)
        return vertices

    def _add(self, piece, obj):
        piece.is_liquid = _shows_liquid(obj)
        piece.is_helper = domain_of(obj) is not None or obj.display_type in {"WIRE", "BOUNDS"}
        piece.is_mover = _moves(obj)
        self.pieces.append(piece)

    def _copy_data(self, obj):
        """A copy of an evaluated object's geometry; None if there is none."""
        if obj.type == _GREASE_PENCIL:  # Workbench can draw it, but needs seconds to prepare for it
            mesh = tubes(
                _stroke_segments(obj.data),
                max(2 * _largest_radius(obj.data), obj.dimensions.length * _STROKE),
            )
            return self._studio.owned(mesh) if mesh else None
        if obj.type not in _TO_MESH and getattr(obj.data, "shape_keys", None) is None:
            data = self._studio.owned(obj.data.copy())
            if obj.type != "MESH" or data.vertices:
                return data
        # A plain copy would leave shape keys behind, and be empty for a mesh in edit mode.
        try:
            return self._studio.owned(bpy.data.meshes.new_from_object(obj))
        except RuntimeError:
            return None

    def _colour_and_add(self, owner, data, obj, matrix):
        """Colours a copy and adds it: (data-block, corners of its box), (None, None) if there is nothing visible."""
        nothing = (None, None)
        if data is None:
            return nothing
        is_mesh = isinstance(data, bpy.types.Mesh)
        corners = _corners_of(data) if is_mesh else [Vector(corner) for corner in obj.bound_box]
        if not corners or (not is_mesh and corners[0] == corners[6]):
            return nothing
        if not _is_finite(corners):
            self.broken[owner] = "its geometry has coordinates that are not finite, or far too large"
            return nothing
        if is_mesh and not data.polygons:
            data = self._thread(data, (corners[-1] - corners[0]).length)
            if data is None:
                return nothing
        if is_mesh:
            self._colour(data, obj)
        self._add(Piece(owner, data, matrix, corners), obj)
        return data, corners

    def _thread(self, mesh, size):
        """A mesh of edges alone as tubes."""
        edges = ((mesh.vertices[start].co, mesh.vertices[end].co) for start, end in mesh.edge_keys)
        thread = tubes(edges, size * _STROKE)
        if thread is not None:
            self._studio.owned(thread)
            for material in mesh.materials[:1]:
                thread.materials.append(material)
        return thread

    def _surface(self, material, obj):
        """A PreviewMaterial for a material on an object, which the caller may change."""
        key = (material.name_full if material else None, tuple(obj.color))
        if key not in self._surfaces:
            self._surfaces[key] = surface_of(material, obj.color, self._averages)
        return copy.copy(self._surfaces[key])

    def _colour(self, mesh, obj):
        slots = obj.material_slots
        if self._studio.keeps_materials and obj.type != _GREASE_PENCIL:
            _keep_materials(mesh, slots)
            return
        for at in range(max(1, len(mesh.materials))):
            material = mesh.materials[at] if at < len(mesh.materials) else None
            if at < len(slots) and slots[at].link == "OBJECT":
                material = slots[at].material
            if obj.type == _GREASE_PENCIL and slots:
                material = slots[0].material
            surface = self._surface(material, obj)
            if surface.attribute is not None:
                surface.rgb = _average_of(mesh, surface.attribute) or surface.rgb
            if surface.image is not None and not _use_uv_map(mesh, at, surface):
                surface.image = None
            preview_material = self._studio.material(surface)
            if at < len(mesh.materials):
                mesh.materials[at] = preview_material
            else:
                mesh.materials.append(preview_material)

    # What has no mesh

    def _copy_particles_and_gas(self, obj, matrix):
        """Adds hair, particles as dots, and smoke."""
        size = max(obj.dimensions.length, 1e-9) * _STROKE
        has_surface = _shows_liquid(obj)
        for system in obj.particle_systems:
            settings = system.settings
            if settings.type == "FLIP" and has_surface:
                continue  # the liquid's surface stands for them
            if settings.type == "HAIR" and settings.render_type == "PATH":
                mesh = tubes(_strands(obj, system), size / 2)
            elif settings.type != "HAIR" and settings.render_type in {"HALO", "LINE", "PATH"}:
                mesh = octahedra(
                    [
                        (particle.location, max(particle.size / 2, size))
                        for particle in system.particles
                        if particle.alive_state == "ALIVE"
                    ]
                )
            else:
                continue
            slots = obj.material_slots
            number = min(settings.material, len(slots)) - 1
            self._add_proxy(
                obj, mesh, [self._surface(slots[number].material if slots else None, obj)], Matrix()
            )
        domain = _gas_of(obj)
        if domain is not None:
            grids = domain.density_grid, domain.flame_grid, tuple(domain.domain_resolution)
            cells = gas_cells(*grids, obj.bound_box)
            if cells is not None:
                self.gases.add(obj.original.name)
            self._add_proxy(
                obj,
                cells,
                [PreviewMaterial((0.3,) * 3, 0.5), PreviewMaterial((1, 0.3, 0.03), 0.8)],
                matrix,
            )

    def _add_proxy(self, obj, mesh, surfaces, matrix):
        if mesh is None:
            return
        self._studio.owned(mesh)
        for surface in surfaces:
            mesh.materials.append(self._studio.material(surface))
        corners = _corners_of(mesh)
        if _is_finite(corners):
            self.pieces.append(Piece(obj.original.name, mesh, matrix, corners))
            self.pieces[-1].is_solid = False


def _keep_materials(mesh, slots):
    """Gives a copy the file's own materials, also those that belong to the object instead of its mesh."""
    for at, own in enumerate(list(mesh.materials)):
        material = slots[at].material if at < len(slots) and slots[at].link == "OBJECT" else own
        mesh.materials[at] = material.original if material else None


def _metaballs(layer):
    """Names of metaballs: only one of each family is drawn."""
    return {obj.name for obj in layer.objects if obj.type == "META"}


def _is_finite(vectors):
    return all(abs(part) < _BEYOND for vector in vectors for part in vector)


def _corners_of(mesh):
    """The eight corners of a mesh's box, one NaN if a coordinate is not finite; None without vertices."""
    if not mesh.vertices:
        return None
    flat = _coordinates(mesh)
    if not math.isfinite(sum(flat)):
        return [Vector((math.nan,) * 3)]
    axes = [flat[axis::3] for axis in range(3)]
    spans = [(min(values), max(values)) for values in axes]
    return [Vector((x, y, z)) for x in spans[0] for y in spans[1] for z in spans[2]]


def _coordinates(mesh):
    flat = array("f", bytes(12 * len(mesh.vertices)))
    mesh.vertices.foreach_get("co", flat)
    return flat


def _keeps_axes(matrix):
    """Whether the matrix keeps boxes along the axes."""
    return all(sum(abs(part) > 1e-7 * max(map(abs, row[:3])) for part in row[:3]) <= 1 for row in matrix[:3])


def _average_of(mesh, name):
    """The average of a colour attribute ("": the active one); None if the mesh has none of that name."""
    attribute = mesh.color_attributes.get(name) if name else mesh.color_attributes.active_color
    if attribute is None or not len(attribute.data):
        return None
    values = array("f", bytes(16 * len(attribute.data)))
    attribute.data.foreach_get("color", values)
    return tuple(sum(values[at::4]) / len(attribute.data) for at in range(3))


def _use_uv_map(mesh, slot, surface):
    """Activates the UV map of an image, with its mapping applied; False if there is no such map."""
    layers = mesh.uv_layers
    layer = layers.get(surface.uv_map) if surface.uv_map else layers.active
    if layer is None:
        return False
    layers.active = layer
    layer.active_render = True
    if surface.mapping is not None:
        for polygon in mesh.polygons:
            if polygon.material_index == slot:
                for at in polygon.loop_indices:
                    layer.data[at].uv = (surface.mapping @ layer.data[at].uv.to_3d()).to_2d()
    return True


def _strands(obj, system):
    """Line segments of a hair system, in the world."""
    steps = 2**system.settings.display_step
    count = len(system.particles) + len(system.child_particles)
    for number in range(0, count, max(1, count // _STRANDS)):
        points = [system.co_hair(obj, particle_no=number, step=step) for step in range(steps + 1)]
        points = [point for point in points if point.length_squared > 0]
        yield from itertools.pairwise(points)


def _strokes(data):
    """(layer, stroke) of a drawing, that are visible."""
    for layer in data.layers:
        frame = None if layer.hide else layer.current_frame()
        for stroke in frame.drawing.strokes if frame else ():
            yield layer, stroke


def _largest_radius(data):
    """The largest radius of its strokes."""
    return max((point.radius for _, stroke in _strokes(data) for point in stroke.points), default=0.0)


def _stroke_segments(data):
    """Line segments of a drawing."""
    for layer, stroke in _strokes(data):
        points = [layer.matrix_local @ point.position for point in stroke.points]
        yield from itertools.pairwise(points)


def _moves(obj):
    """Whether keyframes or a solver move an object, or what it is parented to."""
    while obj is not None:
        body, animation = obj.rigid_body, obj.animation_data
        if body is not None and body.type == "ACTIVE":
            return True
        if animation is not None and (animation.action is not None or len(animation.drivers)):
            return True
        obj = obj.parent
    return False


def _gas_of(obj):
    """The fluid domain settings of an object; None if it is not a domain of gas."""
    domain = domain_of(obj, shown_only=True)
    return domain if domain is not None and domain.domain_type == "GAS" else None


def _shows_liquid(obj):
    """Whether an object is a domain that shows the surface of its liquid, not its own mesh."""
    domain = domain_of(obj, shown_only=True)
    if domain is None or domain.domain_type != "LIQUID" or not domain.use_mesh:
        return False
    return len(obj.data.vertices) != len(obj.original.data.vertices)
