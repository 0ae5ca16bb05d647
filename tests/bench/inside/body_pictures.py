"""Scenes for the pictures of what is checked of rigid and soft bodies."""

import math

import bpy
from making import add, bake, body, empty, get
from picture_parts import A, B, Shot, ball, box, coloured


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


def rigid_constraint(holds):
    fixed(get("Floor"))
    fixed(box("B", (0, 0, 1.15), (0.3, 0.3, 0.12), B))
    rod = box("A", (0, 0, 0.4), (0.12, 0.12, 0.7), A)
    body(rod)
    rod.location, rod.rotation_euler.y = (0.3, 0, 0.92), math.radians(-60)
    joint("POINT", (0, 0, 1.1), get("B"), rod if holds else None)
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


SHOTS = {
    "rigid_type": Shot(rigid_type, (30,)),
    "rigid_shape": Shot(rigid_shape, (30,), look=(0, 0, 0.25), away=(1.6, -2.8, 2)),
    "rigid_constraint": Shot(rigid_constraint, (30,), look=(0, 0, 0.6)),
    "rigid_positive_mass": Shot(rigid_positive_mass, (30,), look=(0, 0, 0.3), away=(0.8, -3.6, 1)),
}
