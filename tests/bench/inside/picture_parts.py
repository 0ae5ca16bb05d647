"""What the scenes of the audit's pictures are made of, and how each is rendered."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass

import bpy
from making import PLACE, add
from mathutils import Vector

SIZE = (240, 180)
A, B, FLOOR = (0.85, 0.33, 0.05), (0.16, 0.30, 0.42), (0.72, 0.70, 0.66)
WATER, DARK = (0.05, 0.28, 0.75), (0.06, 0.06, 0.07)


@dataclass(frozen=True)
class Shot:
    """How a scene is made (``build`` is told whether it is to hold), which frames are shown, and from where."""

    build: Callable[[bool], None]
    frames: tuple[int, ...] = (1,)
    look: tuple[float, float, float] = (0, 0, 0.45)
    away: tuple[float, float, float] = (2.2, -3.6, 1.5)


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
    return box("Floor", (0, 0, -0.1), (30, 30, 0.1), FLOOR)


def solid(thing):
    """Cloth, soft bodies and particles collide with it."""
    thing.modifiers.new("Collision", "COLLISION")
    return thing


def group(thing, name, within):
    """A vertex group of the vertices whose place (local) is ``within``; its name."""
    indices = [vertex.index for vertex in thing.data.vertices if within(vertex.co)]
    thing.vertex_groups.new(name=name).add(indices, 1.0, "REPLACE")
    return name


def camera(shot):
    """The shot's camera, and light."""
    scene, away = bpy.context.scene, Vector(shot.away)
    eye = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    eye.location = Vector(shot.look) + away
    eye.rotation_euler = (-away).to_track_quat("-Z", "Y").to_euler()
    eye.data.lens = 55
    scene.collection.objects.link(eye)
    scene.camera = eye
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy, sun.data.angle = 1.8, 0.2
    sun.rotation_euler = (math.radians(35), math.radians(-20), 0)
    scene.collection.objects.link(sun)
    scene.world = bpy.data.worlds.new("World")
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.53, 0.56, 1)


def render(shot, name):
    """Plays the open scene up to the shot's last frame; the pictures of its frames, which share a picture's width."""
    scene = bpy.context.scene
    scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 16, "CPU"
    scene.cycles.use_denoising, scene.cycles.max_bounces = True, 3
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x, scene.render.resolution_y = SIZE[0] // len(shot.frames), SIZE[1]
    scene.render.resolution_percentage = 100
    scene.view_settings.view_transform = "Standard"
    pictures = []
    for frame in range(1, shot.frames[-1] + 1):
        scene.frame_set(frame)
        if frame in shot.frames:
            scene.render.filepath = os.path.join(PLACE, f"{name}_{frame}.png")
            bpy.ops.render.render(write_still=True)
            pictures.append(scene.render.filepath)
    return pictures
