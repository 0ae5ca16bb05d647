# SPDX-License-Identifier: GPL-3.0-or-later
"""A sledge glides down a hill and runs out on the flat; the scarf on its handrail streams out behind it, and sinks."""

import math

from mathutils import Vector

from ..props import boxes, cylinder, joined, mesh, sheet, tube, weigh
from ..scene_setup import begin, camera, light, under
from ..simulation_parts import body, cloth, collider, thrown

STEEP = math.radians(28)
ROUND = 4.0  # metres, the radius at which the hill becomes flat
SLOPE, FLAT, WIDE = 4.5, 6.0, 4.0
START = 2.8  # up the slope
SPEED = 2.0
RAIL = (-0.48, 0.52)  # of the sledge's handrail: how far behind its middle, how high


def build():
    """Builds the scene."""
    begin(80)
    hill = _hill()
    body(hill, "PASSIVE", shape="MESH", friction=0.6)
    collider(hill, thickness=0.01)
    sledge = _sledge()
    scarf = _scarf()
    under(sledge, scarf)
    down = Vector((math.cos(STEEP), 0, -math.sin(STEEP)))
    begins = Vector((-ROUND * math.sin(STEEP), 0, ROUND * (1 - math.cos(STEEP))))
    sledge.location = begins - START * down + 0.005 * Vector((math.sin(STEEP), 0, math.cos(STEEP)))
    sledge.rotation_euler = (0, STEEP, 0)
    body(sledge, mass=9, friction=0.5)
    thrown(sledge, SPEED * down)
    camera((-0.4, -5.0, 3.4), (-1.75, 0, 0.85), lens=28)
    light(elevation=12, azimuth=70, colour=(1, 0.8, 0.65), sky=(0.55, 0.62, 0.8))


def _hill():
    """A slab whose upper side comes down along X, and ends level at the height 0."""
    turns = [STEEP * (1 - step / 16) for step in range(17)]
    arc = [(-ROUND * math.sin(turn), ROUND * (1 - math.cos(turn))) for turn in turns]
    top = (arc[0][0] - SLOPE * math.cos(STEEP), arc[0][1] + SLOPE * math.sin(STEEP))
    upper = [top, *arc, (FLAT, 0)]
    count = len(upper)
    points = [(x, y, z) for y in (-WIDE / 2, WIDE / 2) for x, z in [*upper, (FLAT, -0.5), (top[0], -0.5)]]
    around = count + 2
    faces = [(i, (i + 1) % around, (i + 1) % around + around, i + around) for i in range(around)]
    faces += [tuple(range(around))[::-1], tuple(range(around, 2 * around))]
    return mesh("Snowy hillside", points, faces, colour=(0.88, 0.9, 0.95), roughness=0.9)


def _sledge():
    """Stands on its origin's plane, and looks along X."""
    wood = {"colour": (0.5, 0.3, 0.13)}
    parts = [((0.09, 0.46, 0.02), (0.12 * step - 0.36, 0, 0.2)) for step in range(7)]
    parts += [((0.04, 0.035, 0.16), (x, y, 0.11)) for x in (-0.3, 0.3) for y in (-0.2, 0.2)]
    pieces = [boxes("Seat", parts, **wood)]
    for y in (-0.2, 0.2):
        runner = [(-0.5, y, 0.015), (0.4, y, 0.015), (0.5, y, 0.05), (0.56, y, 0.13), (0.55, y, 0.2)]
        pieces.append(tube("Runner", runner, 0.015, sides=8, **wood))
    rear, high = RAIL
    half = [(-0.4, 0.2, 0.2), (rear, 0.2, high - 0.05), (rear, 0.15, high)]
    rail = [*half, *((x, -y, z) for x, y, z in reversed(half))]
    pieces.append(tube("Rail", rail, 0.014, sides=8, **wood))
    return joined("Wooden sledge", *pieces)


def _scarf():
    """Tied around the rail, and reaching out behind."""
    rear, high = RAIL
    red = {"colour": (0.65, 0.03, 0.04), "roughness": 0.95}
    long = sheet("Scarf", (1.0, 0.2), (30, 6), (rear - 0.52, 0, high), **red)
    knot = cylinder("Knot", 0.026, 0.2, (rear, 0, high), turn=(90, 0, 0), sides=12, **red)
    scarf = joined("Wool scarf", long, knot)
    cloth(scarf, pins=weigh(scarf, "knot", lambda point: point.x > 0.45), mass=0.15, stiffness=15)
    return scarf
