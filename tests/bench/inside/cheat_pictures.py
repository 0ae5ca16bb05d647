"""Scenes for the pictures of imitated simulations, and of physics in a static scene."""

import bpy
from body_pictures import fixed
from cloth_pictures import drape
from making import bake, body, get, keys
from picture_parts import DARK, A, B, Shot, ball, box


def flight(frame):
    """Where the ball is at a frame of its flight."""
    way = (frame - 1) / 15
    return (1.5 * way - 0.75, 0, 0.2 + 3.2 * way * (1 - way))


def dense_transform_keys(holds):
    frames = range(1, 17) if holds else (1, 8, 16)
    keys(ball("A", flight(1), 0.13, A), "location", [flight(frame) for frame in frames], frames)
    for frame in frames:
        ball("Key", flight(frame), 0.035, DARK)


def animated_shape_keys(holds):
    slab = box("A", (0, 0, 0), (0.45, 0.45, 0.8), A)
    slab.shape_key_add(name="Basis")
    squashed = slab.shape_key_add(name="Squashed")
    for point in squashed.data:
        point.co = (1.5 * point.co.x, 1.5 * point.co.y, 0.3 * point.co.z - 0.35)
    if holds:
        keys(squashed, "value", [0.0, 1.0], [1, 12])


def static_has_cache(holds):
    drape(0.61)
    if not holds:
        bpy.context.scene.frame_set(30)
        bpy.context.view_layer.objects.active = get("A")
        bpy.ops.object.modifier_apply(modifier="Cloth")


def static_has_rigid_world(holds):
    things = [box("A", (0, 0, 0), (0.5, 0.4, 0.12), A), box("B", (0.2, 0, 0.12), (0.5, 0.4, 0.12), B)]
    things.append(box("Book", (0.4, 0, 0.24), (0.5, 0.4, 0.12), A))
    if holds:
        fixed(get("Floor"))
        for thing in things:
            body(thing).collision_shape = "BOX"
        bake()


def static_has_solver(holds):
    drape(0.61, is_cloth=holds)


SHOTS = {
    "dense_transform_keys": Shot(dense_transform_keys, (16,), look=(0, 0, 0.55)),
    "animated_shape_keys": Shot(animated_shape_keys, (1, 6, 12), look=(0, 0, 0.35)),
    "static_has_cache": Shot(static_has_cache, (1, 30)),
    "static_has_rigid_world": Shot(static_has_rigid_world, (1, 30), look=(0.1, 0, 0.3)),
    "static_has_solver": Shot(static_has_solver, (1, 30)),
}
