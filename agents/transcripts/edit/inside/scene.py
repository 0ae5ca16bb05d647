# SPDX-License-Identifier: GPL-3.0-or-later
"""A desk as somebody might have left it: names as they came, no order in the collections, nothing that moves."""

import itertools
import math

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector

scene = bpy.context.scene
for left in [*bpy.data.objects, *bpy.data.collections]:
    (bpy.data.objects if isinstance(left, bpy.types.Object) else bpy.data.collections).remove(left)
scene.frame_start, scene.frame_end, scene.render.fps = 1, 250, 24
stuff = bpy.data.collections.new("Collection 1")
more = bpy.data.collections.new("stuff")
for collection in (stuff, more):
    scene.collection.children.link(collection)


def material(name, colour, roughness=0.5, metallic=0.0):
    """A plain material."""
    made = bpy.data.materials.new(name)
    made.diffuse_color, made.roughness, made.metallic = (*colour, 1), roughness, metallic
    surface = made.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Roughness"].default_value, surface.inputs["Metallic"].default_value = roughness, metallic
    return made


def wood(name, dark, light, stretch):
    """A wood whose grain runs where its texture is stretched."""
    made = material(name, light, 0.45)
    tree = made.node_tree
    place, mapping, noise, ramp = (
        tree.nodes.new(kind)
        for kind in ("ShaderNodeTexCoord", "ShaderNodeMapping", "ShaderNodeTexNoise", "ShaderNodeValToRGB")
    )
    mapping.inputs["Scale"].default_value = stretch
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 2.5, 3.0
    for element, at, colour in zip(ramp.color_ramp.elements, (0.3, 0.7), (dark, light), strict=True):
        element.position, element.color = at, (*colour, 1)
    tree.links.new(place.outputs["Object"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], ramp.inputs[0])
    tree.links.new(ramp.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


def linked(name, shape, surface, where, collection=stuff):
    """An object of a bmesh, with its normals outwards."""
    bmesh.ops.recalc_face_normals(shape, faces=shape.faces)
    data = bpy.data.meshes.new(name)
    shape.to_mesh(data)
    shape.free()
    data.materials.append(surface)
    made = bpy.data.objects.new(name, data)
    made.matrix_world = where
    collection.objects.link(made)
    return made


def box(name, size, at, surface, turn=0.0, bevel=0.003, collection=stuff):  # noqa: PLR0913, PLR0917
    """A box with softened edges, turned about z by degrees."""
    shape = bmesh.new()
    bmesh.ops.create_cube(shape, size=1.0)
    bmesh.ops.scale(shape, vec=size, verts=shape.verts)
    where = Matrix.Translation(at) @ Matrix.Rotation(math.radians(turn), 4, "Z")
    made = linked(name, shape, surface, where, collection)
    soft = made.modifiers.new("Bevel", "BEVEL")
    soft.width, soft.segments = bevel, 2
    return made


def turned(name, profile, at, surface, collection=stuff, segments=48):  # noqa: PLR0913, PLR0917
    """What a profile of (radius, height) becomes on a lathe."""
    shape, rings = bmesh.new(), []
    for radius, height in profile:
        turns = [math.tau * step / segments for step in range(segments if radius else 1)]
        rings.append(
            [shape.verts.new((radius * math.cos(turn), radius * math.sin(turn), height)) for turn in turns]
        )
    for below, above in itertools.pairwise(rings):
        for step in range(segments):
            after = (step + 1) % segments
            corners = [below[step % len(below)], below[after % len(below)]]
            corners += [above[after % len(above)], above[step % len(above)]]
            corners = list(dict.fromkeys(corners))
            if len(corners) > 2:
                shape.faces.new(corners).smooth = True
    made = linked(name, shape, surface, Matrix.Translation(at), collection)
    made.data.set_sharp_from_angle(angle=math.radians(40))
    return made


desk = wood("Material.001", (0.16, 0.08, 0.035), (0.4, 0.22, 0.1), (1.4, 18, 1))
plywood = wood("plywood", (0.5, 0.34, 0.18), (0.66, 0.48, 0.28), (1.5, 16, 16))
glaze = material("Material.003", (0.3, 0.42, 0.5), 0.22)
rubber = material("ball_mat", (0.9, 0.5, 0.04), 0.4)
covers = [
    material(f"book.{number:03d}", colour, 0.6)
    for number, colour in enumerate(((0.05, 0.12, 0.2), (0.3, 0.25, 0.06), (0.12, 0.2, 0.09)), 1)
]

box("Cube", (1.8, 1.2, 0.04), (0, -0.1, -0.02), desk)
box("wall", (3.0, 0.05, 1.6), (0, 0.6, 0.6), material("Material.004", (0.6, 0.6, 0.57), 0.9), collection=more)

# A ramp: a wedge with its high end at the left.
shape = bmesh.new()
points = [
    [shape.verts.new((x, y, z)) for x, z in ((-0.2, 0), (0.2, 0), (0.2, 0.004), (-0.2, 0.13))]
    for y in (-0.06, 0.06)
]
shape.faces.new(points[0])
shape.faces.new(points[1])
for at in range(4):
    shape.faces.new((points[0][at], points[0][(at + 1) % 4], points[1][(at + 1) % 4], points[1][at]))
linked("ramp FINAL2", shape, plywood, Matrix.Translation((-0.42, -0.1, 0)))

# The ball, on the ramp's upper end, where nothing would hold it.
slope = math.atan2(0.126, 0.4)
ball = bmesh.new()
bmesh.ops.create_uvsphere(ball, u_segments=48, v_segments=24, radius=0.04)
touching = Vector((-0.56, -0.1, 0.13 - 0.06 * math.tan(slope)))
centre = touching + 0.04 * Vector((math.sin(slope), 0, math.cos(slope)))
linked("Sphere", ball, rubber, Matrix.Translation(centre)).data.shade_smooth()

# Books: three that lie, in the way of what comes down the ramp.
height = 0.0
for number, (size, turn) in enumerate(
    (((0.2, 0.27, 0.03), 8), ((0.18, 0.25, 0.024), -5), ((0.16, 0.23, 0.02), 14))
):
    name = "Cube.001" if number == 0 else f"Cube.001.{number:03d}"
    box(name, size, (0.5, -0.06, height + size[2] / 2), covers[number], turn, 0.002, more)
    height += size[2]

profile = [
    (0, 0),
    (0.036, 0),
    (0.04, 0.004),
    (0.042, 0.095),
    (0.0395, 0.097),
    (0.038, 0.094),
    (0.036, 0.008),
    (0, 0.008),
]
mug = turned("Cylinder.002", profile, (0.1, 0.16, 0), glaze)
bpy.ops.mesh.primitive_torus_add(major_radius=0.026, minor_radius=0.006, major_segments=40, minor_segments=16)
handle = bpy.context.object
handle.name = handle.data.name = "Torus"
for place in handle.users_collection:
    place.objects.unlink(handle)
stuff.objects.link(handle)
handle.matrix_world = Matrix.LocRotScale((0.151, 0.16, 0.05), Euler((math.pi / 2, 0, 0)), None)
handle.data.materials.append(glaze)
handle.data.shade_smooth()
handle.parent, handle.matrix_parent_inverse = mug, mug.matrix_world.inverted()

pot = [
    (0, 0),
    (0.04, 0),
    (0.05, 0.08),
    (0.054, 0.08),
    (0.054, 0.095),
    (0.046, 0.095),
    (0.044, 0.075),
    (0, 0.075),
]
turned("pot", pot, (-0.12, 0.25, 0), material("terracotta", (0.42, 0.16, 0.08), 0.8), more)
leaf = material("leaf", (0.06, 0.22, 0.07), 0.5)
for number in range(7):
    shape = bmesh.new()
    bmesh.ops.create_cone(shape, cap_ends=True, segments=10, radius1=0.012, radius2=0.001, depth=0.13)
    lean = Matrix.Rotation(math.radians(51 * number), 4, "Z") @ Matrix.Rotation(
        math.radians(12 + 4 * number), 4, "Y"
    )
    where = Matrix.Translation((-0.12, 0.25, 0.07)) @ lean @ Matrix.Translation((0, 0, 0.06))
    linked(f"Cone.{number:03d}", shape, leaf, where, more)

for name, at, size, energy, colour in (
    ("Area", (-1.0, -0.7, 1.2), 0.7, 22, (1.0, 0.9, 0.76)),
    ("Area.001", (1.2, -0.8, 0.8), 0.9, 6, (0.75, 0.85, 1.0)),
):
    data = bpy.data.lights.new(name, "AREA")
    data.size, data.energy, data.color = size, energy, colour
    light = bpy.data.objects.new(name, data)
    light.location = at
    light.rotation_euler = (Vector((0, 0, 0.05)) - light.location).to_track_quat("-Z", "Y").to_euler()
    more.objects.link(light)
scene.world = scene.world or bpy.data.worlds.new("World")
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.8, 0.88, 1.0, 1)
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35

camera = bpy.data.objects.new("Camera.001", bpy.data.cameras.new("Camera.001"))
camera.location, camera.data.lens = (0.1, -1.5, 0.74), 39
camera.rotation_euler = (Vector((-0.02, 0.0, 0.04)) - camera.location).to_track_quat("-Z", "Y").to_euler()
scene.collection.objects.link(camera)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.render.resolution_x, scene.render.resolution_y = 480, 270
scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.denoising_prefilter = 12, True, "FAST"
scene.cycles.max_bounces, scene.cycles.use_adaptive_sampling, scene.cycles.use_light_tree = 4, False, False
scene.render.use_persistent_data = True
