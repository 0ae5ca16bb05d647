# SPDX-License-Identifier: GPL-3.0-or-later
"""A hot-water bottle lands on a trampoline, whose mat dips under it and flings it up once more."""

from ..props import box, cylinder, fused, joined, revolved, weigh
from ..round_shapes import around, ring
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, soft
from ..soft_body_struts import braced

HIGH, WIDE, TUBE = 0.7, 1.3, 0.035
RINGS = 12


def build():
    """Builds the scene."""
    begin(60)
    box("Grass", (9, 9, 0.1), (0, 0, -0.05), colour=(0.13, 0.36, 0.08))
    _ring()
    circles = [(WIDE * ring / RINGS, 0) for ring in range(RINGS + 1)]
    mat = revolved("Trampoline mat", circles, (0, 0, HIGH), sides=36, colour=(0.15, 0.15, 0.18))
    mat.data.flip_normals()  # up: a sheet stops what comes from the side that its normals show
    laced = weigh(mat, "Laced", lambda point: point.xy.length > WIDE - 0.01)
    springs = soft(mat, goal=laced, mass=6, stiffness=0.9, bending=0, damping=0).settings
    springs.spring_length = 85  # laced taut
    collider(mat, thickness=0.05, inner=0.1, damping=0.02)
    body = box("Body", (0.34, 0.46, 0.12), (0, 0, 1.5))
    neck = cylinder("Neck", 0.06, 0.16, (0, 0.28, 1.5), turn=(90, 0, 0))
    bottle = braced(fused("Hot-water bottle", 0.05, body, neck, colour=(0.65, 0.08, 0.1), roughness=0.4))
    rubber = soft(bottle, mass=3, stiffness=0.85, bending=0, damping=0).settings
    collider(bottle, thickness=0.05, inner=0.05, damping=0)
    springs.choke = rubber.choke = 0  # nothing brakes them where they press into each other but the damping
    springs.friction = rubber.friction = 0.3
    camera((2.4, -3.2, 2.2), (0, 0, 0.85), lens=33)
    light(elevation=50)


def _ring():
    steel = {"colour": (0.6, 0.62, 0.65), "metal": 1.0, "roughness": 0.3}
    rim = ring("Rim", WIDE + TUBE, TUBE, (0, 0, HIGH), sides=48, **steel)
    legs = [cylinder("Leg", 0.025, HIGH, (x, y, HIGH / 2), **steel) for x, y in around(WIDE + TUBE, 6)]
    joined("Steel ring", rim, *legs)
