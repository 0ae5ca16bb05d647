"""Scenes for the pictures of what is checked of rigid and soft bodies."""

import math

import bpy
from cloth_pictures import sheet
from making import add, bake, body, cloth_on, empty, get, keys
from picture_parts import DARK, A, B, Shot, ball, box, coloured, group, solid


def fixed(thing, shape="BOX"):
    """A passive rigid body."""
    body(thing, "PASSIVE").collision_shape = shape
    return thing


def joint(kind, place, first, second):
    """A constraint between two bodies; ``second`` may be None."""
    bpy.context.view_layer.objects.active = empty("Joint", place)
    bpy.ops.rigidbody.constraint_add(type=kind)
    constraint = bpy.context.object.rigid_body_constraint
    constraint.object1, constraint.object2 = first, second
    return constraint


def rigid_settings(holds):
    fixed(box("B", (0, 0, 0), (1.2, 0.8, 0.2), B))
    body(box("A", (0, 0, 0.9), (0.35, 0.35, 0.35), A))
    if not holds:
        bpy.context.scene.rigidbody_world.collection.objects.unlink(get("A"))
    bake()


def rigid_type(holds):
    fixed(box("B", (0, 0, 0), (1.2, 0.8, 0.2), B))
    body(box("A", (0, 0, 0.9), (0.35, 0.35, 0.35), A), "ACTIVE" if holds else "PASSIVE")
    bake()


def rigid_shape(holds):
    fixed(get("Floor"))
    ring = coloured(
        add("torus", "A", (0, 0, 0.15), major_radius=0.5, minor_radius=0.15, major_segments=48), A
    )
    ring.data.shade_smooth()
    fixed(ring, "MESH" if holds else "CONVEX_HULL")
    body(ball("B", (0, 0, 0.9), 0.22, B)).collision_shape = "SPHERE"
    bake()


def rigid_world_populated(holds):
    fixed(get("Floor"))
    for name, x in (("Left", -0.65), ("A", 0), ("Right", 0.65)):
        body(box(name, (x, 0, 0.6), (0.35, 0.35, 0.35), A if name == "A" else B))
    if not holds:
        bpy.context.scene.rigidbody_world.collection.objects.unlink(get("Right"))
    bake()


def rigid_cache_baked(holds):
    fixed(get("Floor"))
    body(box("A", (0, 0, 1), (0.35, 0.35, 0.35), A))
    if not holds:
        bpy.context.scene.rigidbody_world.point_cache.frame_end = 8
    bake()


def rigid_constraint(holds):
    fixed(get("Floor"))
    fixed(box("B", (0, 0, 1.15), (0.3, 0.3, 0.12), B))
    rod = box("A", (0, 0, 0.4), (0.12, 0.12, 0.7), A)
    body(rod)
    rod.location, rod.rotation_euler.y = (0.3, 0, 0.92), math.radians(-60)
    joint("POINT", (0, 0, 1.1), get("B"), rod if holds else None)
    bake()


def rigid_constraint_no_collision(holds):
    fixed(get("Floor"))
    fixed(box("B", (0, 0.1, 1.0), (0.14, 0.9, 0.14), B))
    box("Post", (0, 0.6, 0), (0.16, 0.16, 1.2), DARK)
    arm = box("A", (0.2, 0, 0.94), (0.75, 0.3, 0.26), A)
    body(arm).collision_shape = "BOX"
    arm.rigid_body.angular_damping = 0.9
    joint("HINGE", (0, 0, 1.07), get("B"), arm).disable_collisions = holds
    get("Joint").rotation_euler.x = math.radians(90)
    bake()


def rigid_collision_modifier(holds):
    table = fixed(box("A", (0, 0, 0), (0.8, 0.8, 0.6), A))
    solid(get("Floor"))
    if holds:
        solid(table)
    cloth_on(sheet("B", (0, 0, 0.8), B), 30)
    bake()


def rigid_positive_mass(holds):
    fixed(get("Floor"))
    pivot = fixed(box("Pivot", (0, 0, 0), (0.1, 0.4, 0.24), (0.06, 0.06, 0.07)))
    plank = box("Plank", (0, 0, 0.25), (1.7, 0.35, 0.05), (0.5, 0.5, 0.5))
    body(plank).mass = 1
    joint("HINGE", (0, 0, 0.25), pivot, plank).disable_collisions = True
    get("Joint").rotation_euler.x = math.radians(90)
    for name, x, colour, mass in (("A", -0.6, A, 5 if holds else 0), ("B", 0.6, B, 1)):
        weight = body(box(name, (x, 0, 0.31), (0.3, 0.3, 0.3), colour))
        weight.collision_shape, weight.mass = "BOX", mass
    bake()


def soft(name, place, size):
    """A box of many faces, and its soft-body modifier."""
    thing = box(name, place, size, A)
    bpy.context.view_layer.objects.active = thing
    bpy.ops.object.transform_apply(location=False, rotation=False, scale=True)
    finer = thing.modifiers.new("Parts", "SUBSURF")
    finer.subdivision_type, finer.levels = "SIMPLE", 3
    bpy.ops.object.modifier_apply(modifier="Parts")
    modifier = thing.modifiers.new("Softbody", "SOFT_BODY")
    modifier.point_cache.frame_end = 30
    settings = modifier.settings
    settings.use_goal, settings.use_stiff_quads = False, True
    settings.pull, settings.push, settings.shear, settings.bend = 0.9, 0.9, 1.0, 4.0
    return thing


def soft_modifier(holds):
    solid(box("B", (0, 0, 0), (1.2, 0.9, 0.2), B))
    jelly = soft("A", (0, 0, 0.5), (0.5, 0.5, 0.5))
    if not holds:
        jelly.modifiers.clear()
    bake()


def soft_cache_baked(holds):
    solid(get("Floor"))
    jelly = soft("A", (0, 0, 0.9), (0.5, 0.5, 0.5))
    if not holds:
        jelly.modifiers["Softbody"].point_cache.frame_end = 8
    bake()


def soft_collision_partners(holds):
    solid(get("Floor"))
    shelf = box("B", (0, 0, 0.45), (0.9, 0.9, 0.06), B)
    if holds:
        solid(shelf)
    soft("A", (0, 0, 0.7), (0.4, 0.4, 0.4))
    bake()


def soft_goal_group(holds):
    solid(get("Floor"))
    box("B", (0, 0, 1.2), (1.2, 0.5, 0.08), B)
    for x in (-0.55, 0.55):
        box("Leg", (x, 0, 0), (0.08, 0.3, 1.2), DARK)
    settings = soft("A", (0, 0, 0.7), (0.5, 0.5, 0.5)).modifiers["Softbody"].settings
    settings.use_goal = holds
    settings.vertex_group_goal = group(get("A"), "Held", lambda place: place.z > 0.24)
    settings.goal_min, settings.goal_max, settings.goal_default = 0, 1, 1
    settings.pull, settings.push, settings.bend = 0.03, 0.5, 1  # what is not held sags
    settings.use_stiff_quads = False
    bake()


def soft_rigid_partners(holds):
    solid(fixed(get("Floor")))
    soft("A", (0.1, 0, 0.02), (0.5, 0.5, 0.5))
    weight = ball("B", (-0.8, 0, 0.3), 0.3, B)
    body(weight).kinematic = True
    keys(weight, "location", [(-0.8, 0, 0.3), (0.1, 0, 0.3)], [1, 30])
    if holds:
        solid(weight)
    bake()


SHOTS = {
    "rigid_settings": Shot(rigid_settings, (30,)),
    "rigid_type": Shot(rigid_type, (30,)),
    "rigid_shape": Shot(rigid_shape, (30,), look=(0, 0, 0.25), away=(1.6, -2.8, 2)),
    "rigid_world_populated": Shot(rigid_world_populated, (30,)),
    "rigid_cache_baked": Shot(rigid_cache_baked, (8, 30), look=(0, 0, 0.6)),
    "rigid_constraint": Shot(rigid_constraint, (30,), look=(0, 0, 0.6)),
    "rigid_constraint_no_collision": Shot(
        rigid_constraint_no_collision, (1, 30), look=(0.1, 0, 0.7), away=(1.2, -4, 1)
    ),
    "rigid_collision_modifier": Shot(rigid_collision_modifier, (30,), away=(2.2, -3.4, 2)),
    "rigid_positive_mass": Shot(rigid_positive_mass, (30,), look=(0, 0, 0.3), away=(0.8, -3.6, 1)),
    "soft_modifier": Shot(soft_modifier, (30,)),
    "soft_cache_baked": Shot(soft_cache_baked, (8, 30), look=(0, 0, 0.6)),
    "soft_collision_partners": Shot(soft_collision_partners, (30,)),
    "soft_goal_group": Shot(soft_goal_group, (1, 11)),
    "soft_rigid_partners": Shot(soft_rigid_partners, (1, 30)),
}
