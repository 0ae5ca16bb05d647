# SPDX-License-Identifier: GPL-3.0-or-later
"""Smoke climbs from the chimney of a snowed-in log cabin at dusk."""

from ..props import block, box, cylinder, joined, prism, weigh
from ..scene_setup import begin, camera, light, vapour
from ..simulation_parts import domain, flow

WOOD = (0.22, 0.12, 0.06)
SNOW = (0.85, 0.88, 0.95)
LOG = 0.15  # radius; they lie in each other a little


def build():
    """Builds the scene."""
    begin(72)
    box("Deep snow", (60, 60, 0.6), (0, 0, 0), colour=SNOW, roughness=0.9)
    joined("Log cabin", *walls(), *roof())
    # In rings, so that the weight of the topmost fades out just below it.
    chimney = block("Brick chimney", (0.6, 0.6, 2.4), (1, 1, 12), (0.8, 0.9, 3.2), colour=(0.35, 0.12, 0.08))
    source = flow(chimney, "SMOKE", speed=(0, 0, 1))
    source.density_vertex_group = weigh(chimney, "Mouth", lambda point: point.z > 1.19)
    smoke = vapour(box("Woodsmoke", (2.0, 2.0, 5.0), (0.8, 0.9, 6.6)), colour=(0.85, 0.85, 0.87), density=5.0)
    air = domain(smoke, "GAS", resolution=40)
    air.beta, air.vorticity = 4.0, 0.1
    air.use_dissolve_smoke, air.dissolve_speed = True, 60  # it thins out as it climbs
    camera((8.5, -14, 3.2), (0.5, 0, 4.4), lens=32)
    light(sun=1.5, elevation=12, azimuth=40, sky=(0.06, 0.07, 0.17), colour=(1, 0.75, 0.65))


def walls():
    """Logs on each other, a door and a lit window in the front, and what closes the gables."""
    for row in range(9):
        height = 0.1 + 0.26 * row
        for side in (-1, 1):
            yield cylinder("Log", LOG, 4.5, (1.5 * side, 0, height), turn=(90, 0, 0), sides=10, colour=WOOD)
            yield cylinder("Log", LOG, 3.5, (0, 2 * side, height), turn=(0, 90, 0), sides=10, colour=WOOD)
    yield prism("Gables", [(-1.5, 2.1), (1.5, 2.1), (0, 3.4)], 4, colour=WOOD)
    yield box("Door", (0.8, 0.4, 1.7), (-0.6, -2, 0.85), colour=(0.1, 0.05, 0.03))
    yield box("Window", (0.6, 0.4, 0.6), (0.65, -2, 1.3), colour=(1, 0.6, 0.2), glow=2.0)


def roof():
    """Boards, and the snow that lies on them."""
    for name, low, thick, colour in (("Boards", 1.95, 0.12, WOOD), ("Snow load", 2.07, 0.3, SNOW)):
        under, over = ((-2, low), (0, low + 1.6), (2, low)), ((2, low + thick), (0, low + 1.6 + thick))
        yield prism(name, [*under, *over, (-2, low + thick)], 4.8, colour=colour)
