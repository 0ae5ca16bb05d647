# SPDX-License-Identifier: GPL-3.0-or-later
"""Two lion heads on opposite walls spout water into a sunken basin, where the jets meet."""

from ..props import ball, box, boxes, cylinder, joined
from ..scene_setup import begin, camera, light, under
from ..simulation_parts import domain, effector, flow

MARBLE = (0.85, 0.83, 0.78)
BRONZE = {"colour": (0.4, 0.24, 0.1), "metal": 1.0, "roughness": 0.35}
WATER = {"colour": (0.25, 0.55, 0.6), "clear": 0.7, "roughness": 0.05}


def build():
    """Builds the scene."""
    begin(60)
    floor = [((0.5, 5, 0.1), (1.25 * side, 0, -0.05)) for side in (-1, 1)]
    floor += [((2.0, 1.9, 0.1), (0, 1.55 * side, -0.05)) for side in (-1, 1)]
    boxes("Mosaic floor", floor, colour=(0.55, 0.3, 0.2))
    rim = [((0.2, 1.2, 0.45), (0.9 * side, 0, -0.175)) for side in (-1, 1)]
    rim += [((1.6, 0.2, 0.45), (0, 0.5 * side, -0.175)) for side in (-1, 1)]
    effector(boxes("Marble basin", [((2.0, 1.2, 0.1), (0, 0, -0.45)), *rim], colour=MARBLE), thickness=1.0)
    sides = [((0.2, 5, 2.2), (1.15 * side, 0, 1.1)) for side in (-1, 1)]
    boxes("Bathhouse walls", [*sides, ((2.1, 0.2, 2.2), (0, 1.4, 1.1))], colour=(0.75, 0.55, 0.4))
    for side in (-1, 1):
        lion(side)
    domain(box("Bath water", (1.9, 1.1, 1.3), (0, 0, 0.17), **WATER), resolution=44)
    camera((0.0, -3.2, 1.9), (0, 0, 0.25), lens=42)
    light(sun=3, elevation=70, azimuth=15, sky=(0.7, 0.75, 0.85))


def lion(side):
    """A lion's head on a wall, with the jet out of its mouth."""
    ears = [ball("Ear", 0.04, (0.93 * side, y, 0.69), detail=2, **BRONZE) for y in (-0.1, 0.1)]
    head = joined(
        "Lion head",
        cylinder("Mane", 0.19, 0.1, (1.0 * side, 0, 0.55), turn=(0, 90, 0), sides=14, **BRONZE),
        ball("Face", 0.13, (0.92 * side, 0, 0.57), **BRONZE),
        ball("Snout", 0.08, (0.82 * side, 0, 0.53), **BRONZE),
        *ears,
    )
    jet = box("Jet", (0.09, 0.09, 0.09), (0.76 * side, 0, 0.53), **WATER)
    flow(jet, speed=(-2.6 * side, 0, 0.2))
    under(head, jet)
