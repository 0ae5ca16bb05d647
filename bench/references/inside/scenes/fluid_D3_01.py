# SPDX-License-Identifier: GPL-3.0-or-later
"""A millstone drops into a basin of water, throws up spray and sinks to the bottom."""

from ..props import box, boxes, revolved
from ..scene_setup import begin, camera, light
from ..simulation_parts import body, domain, effector, flow

STONE = (0.42, 0.4, 0.36)
TIMBER = (0.3, 0.18, 0.09)


def build():
    """Builds the scene."""
    begin(60)
    box("Quarry floor", (12, 12, 0.1), (0, 0, -0.25), colour=(0.5, 0.45, 0.35))
    walls = [((0.2, 2.4, 1.0), (1.1 * side, 0, 0.3)) for side in (-1, 1)]
    walls += [((2.0, 0.2, 1.0), (0, 1.1 * side, 0.3)) for side in (-1, 1)]
    basin = boxes("Stone basin", [((2.0, 2.0, 0.2), (0, 0, -0.1)), *walls], colour=STONE)
    body(basin, "PASSIVE", shape="MESH")
    posts = [((0.14, 0.14, 2.1), (1.4 * side, 0, 0.85)) for side in (-1, 1)]
    boxes("Timber gantry", [*posts, ((3.2, 0.16, 0.2), (0, 0, 1.95))], colour=TIMBER)
    ring = [(0.07, -0.08), (0.32, -0.08), (0.32, 0.08), (0.07, 0.08), (0.07, -0.08)]
    stone = revolved("Granite millstone", ring, (0, 0, 1.05), colour=(0.55, 0.5, 0.48))
    stone.rotation_euler = (0.3, 0.2, 0)
    body(stone, mass=150)
    effector(stone).subframes = 1  # without, it is past the surface in a step, and throws up nothing
    # What is between the stone and the bottom must be able to get away: the domain goes deeper than the floor.
    flow(box("Water at rest", (2.2, 2.2, 0.9), (0, 0, -0.05)), behavior="GEOMETRY")
    water = box(
        "Green water", (2.1, 2.1, 1.75), (0, 0, 0.72), colour=(0.15, 0.4, 0.25), clear=0.75, roughness=0.05
    )
    domain(water, resolution=44)
    camera((2.6, -4.3, 2.6), (0, 0, 0.75), lens=34)
    light(sun=4, elevation=55)
