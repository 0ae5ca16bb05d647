# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds settings of modifiers that have no effect on a new one, unless another setting is changed.

Each kind works on several meshes, one of which is deformed before. A number, or what is pointed to, gets other values;
where all of them leave every evaluated mesh as it was, the same is tried with each switch, choice and vertex group
changed, one at a time. What has an effect with none of these is not told: it may need more than the meshes have.
"""

from array import array

import bpy

from ..classes.rna import path_of
from ..instances.making import add_object, choices, new_modifier, scratch_scene

SIZE = 4  # of the grid, in vertices
FRAME = 12  # what changes with time has begun
FAR = 25.0  # metres, or whatever a number is of
STEPS = {"INT": (1, -1, 3), "FLOAT": (0.37, -0.61, FAR)}
# What numbers differ by at most that are the same (equal work does not end in equal bits), and at least where a switch
# has plainly an effect on a setting, and not by chance.
NEAR, PLAIN = 1e-3, 2e-2
GROUP = "group"
# Modifiers whose work is a simulation, in a file, or weights alone.
LEFT_OUT = frozenset(
    {
        "CLOTH", "COLLISION", "DATA_TRANSFER", "DYNAMIC_PAINT", "EXPLODE", "FLUID", "MESH_CACHE",
        "MESH_SEQUENCE_CACHE", "MULTIRES", "NODES", "OCEAN", "PARTICLE_INSTANCE", "PARTICLE_SYSTEM", "SOFT_BODY",
        "SURFACE", "VERTEX_WEIGHT_EDIT", "VERTEX_WEIGHT_MIX", "VERTEX_WEIGHT_PROXIMITY",
    }
)  # fmt: skip
# Settings of which all but lower values make much more work, or take all memory.
COSTLY = frozenset({"levels", "render_levels", "octree_depth", "steps", "render_steps"})
COARSE = {"voxel_size": 0.5}  # so much of a new one's work is spared
POINTED = ("object", "target", "texture")  # which a modifier is of no use without


def find_all(write):
    """One ``idle`` record for each such setting: with ``needs``, the other settings of which one must have a value; an
    empty text stands for any text.
    """
    scratch_scene()
    bpy.context.scene.frame_set(FRAME)
    trial = Trial()
    for kind in choices("Modifier", "type"):
        if kind not in LEFT_OUT:
            for path, needs in trial.idle(kind):
                write("idle", path=path, needs=needs)


def cube(corner):
    """The points and faces of a cube."""
    points = [
        tuple(c + d for c, d in zip(corner, (x, y, z), strict=True))
        for x in (0, 1)
        for y in (0, 1)
        for z in (0, 1)
    ]
    return points, [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def uneven():
    """The points and faces of a grid that is not flat, with a cube beside it: there are borders and closed parts."""
    points = [(x, y, 0.15 * ((3 * x + 5 * y) % 4)) for x in range(SIZE) for y in range(SIZE)]
    faces = [
        (x * SIZE + y, (x + 1) * SIZE + y, (x + 1) * SIZE + y + 1, x * SIZE + y + 1)
        for x in range(SIZE - 1)
        for y in range(SIZE - 1)
    ]
    first = len(points)
    more, sides = cube((-3.05, -1.3, 0))
    return points + more, faces + [tuple(first + corner for corner in side) for side in sides]


def mesh_of(points, faces):
    """A new object with such a mesh, a UV map, faces of two materials, and a vertex group of all weights."""
    mesh = bpy.data.meshes.new("new")
    mesh.from_pydata(points, [], faces)
    layer = mesh.uv_layers.new(name="map").data
    for loop in mesh.loops:
        x, y, _ = mesh.vertices[loop.vertex_index].co
        layer[loop.index].uv = 0.2 * x + 0.1, 0.2 * y + 0.1
    for place, face in enumerate(mesh.polygons):
        face.material_index = place % 2
    obj = add_object(mesh)
    weights = obj.vertex_groups.new(name=GROUP)
    for place in range(len(points)):
        weights.add([place], place % 5 / 4, "REPLACE")
    return obj


def numbers(elements, name, code, width=1):
    """What all elements of a collection have under a name."""
    values = array(code, bytes(len(elements) * width * array(code).itemsize))
    elements.foreach_get(name, values)
    return values


def are_alike(first, second, near):
    """Whether two shapes are the same but for numbers that are near each other."""
    return len(first) == len(second) and all(
        one == two
        or (
            one.typecode == "f"
            and len(one) == len(two)
            and not any(abs(a - b) > near for a, b in zip(one, two, strict=True))
        )
        for one, two in zip(first, second, strict=True)
    )


def shape(obj):
    """What an evaluated mesh has that modifiers change."""
    graph = bpy.context.evaluated_depsgraph_get()
    mesh = obj.evaluated_get(graph).data
    parts = [
        numbers(mesh.vertices, "co", "f", 3),
        numbers(mesh.loops, "vertex_index", "i"),
        numbers(mesh.loops, "normal", "f", 3),
        numbers(mesh.polygons, "material_index", "i"),
    ]
    return parts + [numbers(layer.data, "uv", "f", 2) for layer in mesh.uv_layers]


def is_plain(prop):
    """Whether a property is a number, several in a row, one choice, a switch or a text."""
    if prop.type in STEPS:
        return not (prop.is_array and prop.array_dimensions[1])
    if prop.type == "ENUM":
        return not prop.is_enum_flag
    return prop.type == "STRING" or (prop.type == "BOOLEAN" and not prop.is_array)


def other_values(prop, value):
    """Some other values of a property, none of which makes much work."""
    if prop.type == "BOOLEAN":
        return [not value]
    if prop.type == "ENUM":
        return [item.identifier for item in prop.enum_items if item.identifier != value]
    if prop.type == "STRING":
        return [GROUP] if "vertex_group" in prop.identifier and not value else []
    if prop.identifier in COSTLY:
        return [value - 1]
    low, high = max(prop.hard_min, -2 * FAR), min(prop.hard_max, 2 * FAR)
    steps = STEPS[prop.type]
    if prop.is_array:
        return [[min(max(one + step, low), high) for one in value] for step in steps]
    return [value + step for step in steps if low <= value + step <= high]


def kept(value):
    """A copy of a property's value, which an array would change with it."""
    return list(value) if hasattr(value, "__len__") and not isinstance(value, str) else value


def is_assigned(modifier, name, value):
    """Assigns a value; whether the modifier takes it."""
    try:
        setattr(modifier, name, value)
    except (TypeError, ValueError, AttributeError):
        return False
    return True


def is_effective(modifier, name, values, least=NEAR):
    """Whether any of the values changes the mesh of the modifier's object, by more than the ``least``."""
    obj, before = modifier.id_data, kept(getattr(modifier, name))
    usual = shape(obj)
    try:
        return any(
            is_assigned(modifier, name, value) and not are_alike(shape(obj), usual, least) for value in values
        )
    finally:
        setattr(modifier, name, before)


class Trial:
    """Objects that each modifier is tried on, and what such modifiers point to."""

    def __init__(self):
        other = mesh_of(*uneven())
        other.location, other.rotation_euler = (0.5, 0.4, 0.7), (0.3, 0.2, 0.1)
        group = bpy.data.collections.new("some")
        group.objects.link(other)
        self.things = {
            "Object": other,
            "Collection": group,
            "Texture": bpy.data.textures.new("clouds", "CLOUDS"),
        }
        self.objects = [mesh_of(*uneven()), mesh_of(*cube((0, 0, 0))), mesh_of(*uneven())]
        for obj in self.objects:
            obj.location = 0.2, 0.3, 0.1
        self.objects[-1].modifiers.new("before", "SIMPLE_DEFORM").angle = 1

    def thing(self, prop):
        """What a pointer may point to; None for one of another class."""
        return self.things.get(prop.fixed_type.identifier) if prop.type == "POINTER" else None

    def settings(self, modifier):
        """(property, other values) of a modifier's own settings."""
        common = bpy.types.Modifier.bl_rna.properties.keys()
        for prop in modifier.bl_rna.properties:
            name = prop.identifier
            if prop.is_readonly or name in common or name.startswith("show_"):
                continue
            value = kept(getattr(modifier, name))
            if is_plain(prop):
                yield prop, other_values(prop, value)
            elif thing := self.thing(prop):
                yield prop, [None if value else thing]

    def idle(self, kind):
        """(path, needs) of each setting of a kind of modifier that has no effect on a new one."""
        modifiers = [one for obj in self.objects if (one := new_modifier(obj, kind))]
        needs = {}
        for modifier in modifiers:
            for name in POINTED:
                prop = modifier.bl_rna.properties.get(name)
                if prop and (thing := self.thing(prop)):
                    setattr(modifier, name, thing)
            for name, value in COARSE.items():
                if name in modifier.bl_rna.properties:
                    setattr(modifier, name, value)
        settings = [row for row in self.settings(modifiers[0]) if row[1]] if modifiers else []
        switches = [row for row in settings if row[0].type in {"BOOLEAN", "ENUM", "STRING"}]
        for prop, values in settings:
            name = prop.identifier
            if (prop, values) in switches or any(is_effective(one, name, values) for one in modifiers):
                continue
            needs[path_of(modifiers[0].bl_rna, name)] = [
                [switch.identifier, "" if switch.type == "STRING" else value]
                for switch, others in switches
                for value in others
                if any(with_switch(one, switch.identifier, value, name, values) for one in modifiers)
            ]
        for modifier in modifiers:
            modifier.id_data.modifiers.remove(modifier)
        yield from ((path, found) for path, found in needs.items() if found)


def with_switch(modifier, switch, value, name, values):
    """Whether another value of a setting has an effect once a switch has a value."""
    before = kept(getattr(modifier, switch))
    try:
        return is_assigned(modifier, switch, value) and is_effective(modifier, name, values, PLAIN)
    finally:
        setattr(modifier, switch, before)
