# SPDX-License-Identifier: GPL-3.0-or-later
"""A toy truck rolls down a ramp and bumps into a brick; the rubber palm on its bed whips forward and quivers."""

import math

from mathutils import Euler, Matrix, Vector

from ..props import box, boxes, cylinder, joined, mesh, revolved
from ..scene_setup import begin, camera, light, paint, under
from ..simulation_parts import body, joint, soft

STEEP, SLOPE = math.radians(16), 1.0  # of the ramp; metres along it
START = 0.75  # up the ramp
WHEEL, HALF, TRACK = 0.045, 0.12, 0.1  # radius; where the axles are; half of what is across
BED = Vector((-0.12, 0, 0.085))  # where the palm is glued on, over the ground
TALL, FRONDS = 0.295, 6  # of the palm


def build():
    """Builds the scene."""
    begin(72)
    floor = box("Nursery floor", (4, 3, 0.1), (0.2, 0, -0.05), colour=(0.5, 0.38, 0.27))
    body(floor, "PASSIVE", shape="BOX", friction=0.8)
    body(_ramp(), "PASSIVE", friction=0.8)
    brick = box("Brick", (0.115, 0.24, 0.07), (0.6, 0, 0.035), colour=(0.55, 0.2, 0.12), roughness=0.9)
    body(brick, "PASSIVE", shape="BOX", bounce=0.4)
    start = Vector((-START * math.cos(STEEP), 0, START * math.sin(STEEP)))
    on_ramp = Matrix.LocRotScale(start, Euler((0, STEEP, 0)), None)
    truck = _truck()
    under(truck, _palm())
    truck.matrix_world = on_ramp @ truck.matrix_world
    body(truck, mass=0.8, bounce=0.4)
    for x in (-HALF, HALF):
        for y in (-TRACK, TRACK):
            _wheel(truck, on_ramp @ Vector((x, y, WHEEL)))
    camera((0.75, -1.35, 0.6), (-0.05, 0, 0.17), lens=35)
    light(sun=2, azimuth=30, sky=(0.45, 0.45, 0.45))


def _ramp():
    """A wedge whose toe is the origin."""
    back, high = -SLOPE * math.cos(STEEP), SLOPE * math.sin(STEEP)
    points = [(x, y, z) for y in (-0.2, 0.2) for x, z in ((back, 0), (0, 0), (back, high))]
    faces = [(0, 1, 2), (5, 4, 3), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)]
    return mesh("Cardboard ramp", points, faces, colour=(0.62, 0.47, 0.3), roughness=1.0)


def _truck():
    """Its origin is between the axles, its front along X."""
    boards = [((0.42, 0.14, 0.03), (0, 0, 0)), ((0.2, 0.14, 0.01), (-0.1, 0, 0.02))]
    cabin = [((0.13, 0.13, 0.12), (0.09, 0, 0.075)), ((0.07, 0.13, 0.05), (0.17, 0, 0.04))]
    bed, cab = boxes("Bed", boards, colour=(0.75, 0.55, 0.3)), boxes("Cab", cabin, colour=(0.7, 0.1, 0.08))
    truck = joined("Toy truck", bed, cab)
    truck.location = (0, 0, BED.z - 0.025)
    return truck


def _wheel(truck, at):
    wheel = cylinder("Wheel", WHEEL, 0.03, at, turn=(90, 0, 0), colour=(0.15, 0.2, 0.5))
    body(wheel, shape="CYLINDER", mass=0.08, friction=0.9)
    joint("Axle", "HINGE", truck, wheel, at, turn=(math.pi / 2, 0, 0))


def _palm():
    """A solid of revolution, drawn in between its fronds. The higher a point, the weaker it is held in its place."""
    trunk = [(0, 0), (0.02, 0), (0.018, 0.05), (0.017, 0.1), (0.016, 0.15), (0.016, 0.2), (0.016, 0.25)]
    crown = [(0.06, 0.27), (0.12, 0.245), (0.16, 0.2), (0.12, 0.262), (0.06, 0.29), (0, TALL)]
    palm = revolved("Palm tree", trunk + crown, BED, sides=4 * FRONDS, colour=(0.1, 0.45, 0.12))
    green = palm.data.materials[0]
    paint(palm, colour=(0.4, 0.25, 0.12)).data.materials.append(green)
    for face in palm.data.polygons:
        face.material_index = int(face.center.xy.length > 0.02)
    glue = palm.vertex_groups.new(name="glue")
    for point in palm.data.vertices:
        if point.co.xy.length > 0.02:
            beside = round(math.atan2(point.co.y, point.co.x) * 2 * FRONDS / math.pi) % 4
            point.co.xy *= (1, 0.4, 0.2, 0.4)[beside]
        glue.add([point.index], 1 if point.co.z < 0.02 else 0.85 - 0.4 * point.co.z / TALL, "REPLACE")
    settings = soft(palm, goal=glue.name, mass=0.2, stiffness=0.5, bending=1, damping=0.5).settings
    settings.goal_spring, settings.goal_friction, settings.friction = 0.8, 1.0, 0.3
    return palm
