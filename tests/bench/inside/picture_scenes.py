"""Makes two scenes for each picture of the audit's pages, one in which it holds and one in which not, and renders both.

The result: {NAME or NAME_not: [.blend, .png]}. In each scene, the actors are the objects ``A`` and ``B``.
"""

import math
import os

import bpy
from making import PLACE, add, bake, body, cloth_on, finish, new, save
from mathutils import Vector

SIZE = (240, 180)
A, B, FLOOR = (0.85, 0.33, 0.05), (0.16, 0.30, 0.42), (0.72, 0.70, 0.66)


def coloured(thing, colour):
    material = bpy.data.materials.new(thing.name)
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = 0.6
    thing.data.materials.append(material)
    return thing


def box(name, place, size, colour):
    """A box; ``place`` is the middle of its underside."""
    thing = add("cube", name, (place[0], place[1], place[2] + size[2] / 2), size=1)
    thing.scale = size
    return coloured(thing, colour)


def ball(name, place, radius, colour):
    thing = coloured(add("uv_sphere", name, place, radius=radius, segments=48, ring_count=24), colour)
    thing.data.shade_smooth()
    return thing


def floor():
    box("Floor", (0, 0, -0.1), (30, 30, 0.1), FLOOR)


def camera(look=(0, 0, 0.45), away=(2.2, -3.6, 1.5)):
    """A camera that looks at a place, and light."""
    scene = bpy.context.scene
    eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    eye.location = Vector(look) + Vector(away)
    eye.rotation_euler = (-Vector(away)).to_track_quat("-Z", "Y").to_euler()
    eye.data.lens = 55
    scene.collection.objects.link(eye)
    scene.camera = eye
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 1.8, 0.2
    sun.rotation_euler = (math.radians(35), math.radians(-20), 0)
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("World")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.53, 0.56, 1)


def supported_by(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    ball("A", (0, 0, 0.7 if holds else 0.8), 0.2, A)


def on_top_of(holds):
    box("B", (0, 0, 0), (0.8, 0.8, 0.5), B)
    plate = box("A", (0.1, 0, 0.5), (0.64, 0.5, 0.06), A)
    if not holds:
        flap = box("flap", (0.43, 0, 0.2), (0.04, 0.5, 0.36), A)
        with bpy.context.temp_override(active_object=plate, selected_editable_objects=[plate, flap]):
            bpy.ops.object.join()


def inside(holds):
    sides = [box("B", (0, 0, 0), (0.9, 0.9, 0.05), B)]
    sides += [box("side", (x, 0, 0.05), (0.05, 0.9, 0.35), B) for x in (-0.425, 0.425)]
    sides += [box("side", (0, y, 0.05), (0.8, 0.05, 0.35), B) for y in (-0.425, 0.425)]
    with bpy.context.temp_override(active_object=sides[0], selected_editable_objects=sides):
        bpy.ops.object.join()
    ball("A", (0, 0, 0.2) if holds else (0.75, -0.3, 0.15), 0.15, A)


def in_contact(holds):
    box("B", (0, 0, 0), (1.4, 1, 0.25), B)
    box("A", (0, 0, 0 if holds else 0.35), (0.12, 0.12, 0.8), A)


def against(holds):
    box("B", (0, 0.3, 0), (1.6, 0.15, 1), B)
    box("A", (0, -0.075 if holds else -0.3, 0), (0.9, 0.6, 0.45), A)


def attached_to(holds):
    box("B", (0, 0, 0.8), (1.4, 0.15, 0.15), B)
    ball("A", (0, 0, 0.6 if holds else 0.45), 0.2, A)


def next_to(holds):
    box("B", (-0.3, 0, 0), (0.5, 0.5, 0.5), B)
    ball("A", (0.25 if holds else 0.9, 0, 0.2), 0.2, A)


def above(holds):
    box("B", (-0.2, 0, 0), (0.8, 0.6, 0.3), B)
    ball("A", (-0.2 if holds else 0.7, 0, 0.8), 0.15, A)


def left_of(holds):
    box("B", (0, 0, 0), (0.4, 0.4, 0.5), B)
    ball("A", (-0.7 if holds else 0.7, 0, 0.2), 0.2, A)


def in_front_of(holds):
    box("B", (0, 0, 0), (0.4, 0.4, 0.5), B)
    ball("A", (0.2, -0.8 if holds else 0.8, 0.2), 0.2, A)


def cloth_collision_partners(holds):
    table = box("B", (0, 0, 0), (0.8, 0.8, 0.6), B)
    if holds:
        table.modifiers.new("Collision", "COLLISION")
    sheet = add("grid", "A", (0, 0, 0.8), size=1.3, x_subdivisions=32, y_subdivisions=32)
    cloth_on(coloured(sheet, A), 30)
    sheet.data.shade_smooth()
    bake()


def rigid_type(holds):
    body(box("B", (0, 0, 0), (1.2, 0.8, 0.2), B), "PASSIVE").collision_shape = "BOX"
    body(box("A", (0, 0, 0.9), (0.35, 0.35, 0.35), A), "ACTIVE" if holds else "PASSIVE")
    bake()


def particle_collision_partners(holds):
    shelf = box("B", (0, 0, 0.45), (0.9, 0.9, 0.08), B)
    if holds:
        shelf.modifiers.new("Collision", "COLLISION")
        shelf.collision.damping_factor = 0.9
    seed = ball("Seed", (5, 0, -1), 0.04, A)
    source = coloured(add("plane", "A", (0, 0, 1.0), size=0.5), A)
    source.modifiers.new("Grains", "PARTICLE_SYSTEM")
    settings = source.particle_systems[0].settings
    settings.count, settings.lifetime, settings.frame_start, settings.frame_end = 120, 60, 1, 10
    settings.particle_size, settings.normal_factor = 1.0, 0.0
    settings.render_type, settings.instance_object = "OBJECT", seed
    source.particle_systems[0].point_cache.frame_end = 30
    bake()


STILL = {
    "SupportedBy": supported_by,
    "OnTopOf": on_top_of,
    "Inside": inside,
    "InContact": in_contact,
    "Against": against,
    "AttachedTo": attached_to,
    "NextTo": next_to,
    "Above": above,
    "LeftOf": left_of,
    "InFrontOf": in_front_of,
}
MOVING = {
    "cloth_collision_partners": cloth_collision_partners,
    "rigid_type": rigid_type,
    "particle_collision_partners": particle_collision_partners,
}
STRAIGHT_ON = {"LeftOf": (0, -4, 1.2), "InFrontOf": (0, -3.6, 2)}


def render(path):
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 16, "CPU"
    scene.cycles.use_denoising = True
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    made = {}
    for name, build in (STILL | MOVING).items():
        for holds in (True, False):
            key = name if holds else f"{name}_not"
            new(30)
            floor()
            build(holds)
            camera(away=STRAIGHT_ON.get(name, (2.2, -3.6, 1.5)))
            bpy.context.view_layer.update()
            blend = save(key)
            for frame in range(1, 31 if name in MOVING else 2):
                bpy.context.scene.frame_set(frame)
            picture = os.path.join(PLACE, f"{key}.png")
            render(picture)
            made[key] = [blend, picture]
    finish(made)


main()
