# SPDX-License-Identifier: GPL-3.0-or-later
"""Rice trickles out of a torn sack, over the edge of its shelf, and skips over the stone floor."""

from random import Random

from ..props import ball, box, boxes, fused, joined, sheet, weigh
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, particles

HIGH = 0.9  # the shelf's upper side


def build():
    """Builds the scene."""
    begin(96)
    floor = sheet("Stone floor", (7, 5), (175, 125), (0, -2.2, 0), colour=(0.42, 0.42, 0.44), roughness=0.8)
    rough = Random(1)
    for point in floor.data.vertices:  # hewn: that is what sends the grains in all directions
        point.co.z = rough.uniform(-0.004, 0.004)
    collider(floor, thickness=0.003, damping=0.5)
    floor.collision.damping_random, floor.collision.friction_factor = 0.3, 0.15
    wall = box("Pantry wall", (7, 0.2, 2.7), (0, 0.3, 1.25), colour=(0.75, 0.74, 0.68))
    collider(wall, thickness=0.003)
    props = [((0.05, 0.3, 0.05), (x, 0.05, -0.075)) for x in (-0.6, 0.6)]
    props += [((0.05, 0.05, 0.3), (x, 0.175, -0.2)) for x in (-0.6, 0.6)]
    boxes(
        "Oak shelf", [((1.6, 0.42, 0.05), (0, -0.01, -0.025)), *props], (0, 0, HIGH), colour=(0.4, 0.26, 0.13)
    )
    sack = _sack()
    grain = ball("Rice grain", 1.0, (0, 0, -2), detail=1, colour=(0.95, 0.92, 0.82))
    grain.data.transform(((1, 0, 0, 0), (0, 0.4, 0, 0), (0, 0, 0.4, 0), (0, 0, 0, 1)))
    rice = particles(sack, "Dry rice", 1500, until=86, lifetime=200, size=0.012, shown=grain, speed=0.25)
    rice.factor_random, rice.use_rotations, rice.rotation_factor_random = 0.15, True, 1.0
    rice.subframes = 2
    sack.particle_systems[0].vertex_group_density = "tear"
    camera((1.1, -3.0, 1.3), (0, -0.45, 0.55), lens=36)
    light(sun=2, elevation=40, azimuth=-50, sky=(0.55, 0.6, 0.65))


def _sack():
    """Slumped on the shelf, over whose edge it bulges; there gapes the tear."""
    burlap = {"colour": (0.55, 0.42, 0.25), "roughness": 1.0}
    lumps = [(0.2, (0, 0.18)), (0.17, (0.12, 0.15)), (0.17, (-0.12, 0.15)), (0.1, (0.02, 0.33))]
    parts = [ball("Lump", size, (x, -0.06, HIGH + up)) for size, (x, up) in lumps]
    sack = fused("Sack", 0.02, *parts, **burlap)
    for point in sack.data.vertices:  # it lies flat
        point.co.z = max(point.co.z, HIGH - sack.location.z)
    tear = sheet(
        "Tear", (0.05, 0.05), (2, 2), (0, -0.265, HIGH + 0.18), turn=(90, 45, 0), colour=(0.1, 0.07, 0.04)
    )
    weigh(tear, "tear", lambda _: True)
    return joined("Burlap sack", sack, tear)
