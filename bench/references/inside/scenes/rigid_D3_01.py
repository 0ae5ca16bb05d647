# SPDX-License-Identifier: GPL-3.0-or-later
"""A motor turns a grinding wheel against an axe, whose edge throws sparks that bounce on the floor."""

import math

from mathutils import Vector

from ..props import ball, box, boxes, cylinder, joined, mesh, weigh
from ..scene_setup import begin, camera, lamp, light
from ..simulation_parts import body, collider, joint, particles

RADIUS, THICK, AXLE = 0.26, 0.07, 0.75
SPEED = 14.0  # of the wheel, radians a second
POST = 0.12  # how far beside the wheel's middle the posts are
RAISED = math.radians(12)  # where on the rim the edge is held, above the level
IRON = {"colour": (0.16, 0.16, 0.18), "metal": 0.7}


def build():
    """Builds the scene."""
    begin(60)
    floor = box("Brick floor", (6, 6, 0.1), (0, 0, -0.05), colour=(0.35, 0.16, 0.11), roughness=0.9)
    collider(floor, damping=0.5)
    stand, wheel = _stand(), _wheel()
    joint("Bearing", "HINGE", stand, wheel, wheel.location, turn=(math.pi / 2, 0, 0))
    motor = joint("Motor", "MOTOR", stand, wheel, wheel.location, turn=(0, 0, math.pi / 2))
    motor.use_motor_ang, motor.motor_ang_target_velocity, motor.motor_ang_max_impulse = True, -SPEED, 50.0
    _sparks(_axe())
    camera((1.2, -1.8, 1.15), (0.2, 0, 0.48), lens=35)
    light(sun=0.4, elevation=20, sky=(0.1, 0.1, 0.14), colour=(1, 0.6, 0.4))
    lamp("Forge light", 60, (-1.0, -1.2, 1.6), colour=(1, 0.55, 0.25))


def _stand():
    """Two posts on feet, each with an arm that the axe lies on."""
    high = AXLE + 0.063
    parts = []
    for y in (-POST, POST):
        parts += [((0.06, 0.04, high), (0, y, high / 2)), ((0.5, 0.06, 0.04), (0, y, 0.02))]
        parts += [((0.42, 0.03, 0.03), (0.24, y, high - 0.015))]
    stand = boxes("Iron stand", parts, **IRON)
    body(stand, "PASSIVE", shape="MESH")
    return stand


def _wheel():
    """Of sandstone, on an axle with a cross that shows how it turns."""
    stone = cylinder("Stone", RADIUS, THICK, colour=(0.66, 0.52, 0.36), roughness=1.0, sides=48)
    cross = boxes(
        "Cross", [((0.3, 0.05, THICK + 0.02), (0, 0, 0)), ((0.05, 0.3, THICK + 0.02), (0, 0, 0))], **IRON
    )
    wheel = joined("Grinding wheel", stone, cylinder("Axle", 0.015, 2 * POST + 0.08, **IRON), cross)
    wheel.location, wheel.rotation_euler = (0, 0, AXLE), (math.pi / 2, 0, 0)
    body(wheel, mass=20)
    return wheel


def _axe():
    """Its edge is the origin's Y axis, and looks along -X."""
    edge = [(0, (step / 8 - 0.5) * 0.14, 0) for step in range(9)]
    back = [(0.16, y, z) for y, z in ((-0.045, -0.018), (0.045, -0.018), (0.045, 0.018), (-0.045, 0.018))]
    sides = [(9, 10, 11, 12), (9, 12, 0), (10, 8, 11), (10, 9, *range(9)), (11, *range(8, -1, -1), 12)]
    head = mesh("Head", [*edge, *back], sides, colour=(0.5, 0.5, 0.53), metal=1.0, roughness=0.3)
    handle = box("Handle", (0.035, 0.75, 0.024), (0.12, -0.24, 0), colour=(0.45, 0.28, 0.12))
    axe = joined("Axe", head, handle)
    out = Vector((math.cos(RAISED), 0, math.sin(RAISED)))
    axe.location, axe.rotation_euler = Vector((0, 0, AXLE)) + (RADIUS + 0.004) * out, (0, -RAISED, 0)
    return axe


def _sparks(axe):
    """Leave the edge the way that the rim goes, down and away from the wheel."""
    grain = ball("Glowing grain", 0.006, detail=1, colour=(1, 0.45, 0.08), glow=12)
    settings = particles(axe, "Sparks", 1500, lifetime=24, size=1.0, shown=grain, source="VERT", speed=0.0)
    axe.particle_systems[0].vertex_group_density = weigh(axe, "edge", lambda point: point.x < 0.001)
    settings.object_align_factor = (1.0, 0, -SPEED * RADIUS)
    settings.factor_random, settings.lifetime_random = 0.9, 0.5
