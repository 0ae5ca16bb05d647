# SPDX-License-Identifier: GPL-3.0-or-later
"""A column of blue water collapses in a long glass tank, surges to its far wall and sloshes back."""

from ..props import box, boxes, legs
from ..scene_setup import begin, camera, light
from ..simulation_parts import domain, flow

CELL = 0.035
EDGE = 0.6 * CELL  # how far a fluid keeps from the sides of its domain
LENGTH, WIDTH, HEIGHT = 46 * CELL, 10 * CELL, 26 * CELL  # of what is within the glass
GLASS = 0.015
TOP = 0.9


def build():
    """Builds the scene."""
    begin(60)
    box("Laboratory floor", (8, 8, 0.1), (0, 0, -0.05), colour=(0.55, 0.52, 0.48))
    box("Laboratory wall", (8, 0.1, 4), (0, 1.6, 2), colour=(0.85, 0.85, 0.8))
    top = ((2.2, 0.8, 0.05), (0, 0, TOP - 0.025))
    boxes(
        "Steel bench", [*legs(1.0, 0.34, TOP - 0.05), top], colour=(0.6, 0.62, 0.64), metal=1.0, roughness=0.4
    )
    low, middle = TOP + GLASS, TOP + GLASS + HEIGHT / 2
    panes = [((LENGTH + 2 * GLASS, WIDTH + 2 * GLASS, GLASS), (0, 0, TOP + GLASS / 2))]
    for side in (-1, 1):
        panes.append(((GLASS, WIDTH, HEIGHT), (side * (LENGTH + GLASS) / 2, 0, middle)))
        panes.append(((LENGTH + 2 * GLASS, GLASS, HEIGHT), (0, side * (WIDTH + GLASS) / 2, middle)))
    boxes("Glass tank", panes, colour=(0.95, 1, 0.98), clear=1.0, roughness=0.0)
    blue = {"colour": (0.05, 0.25, 0.8), "clear": 0.6, "roughness": 0.05}
    around = (LENGTH + 2 * EDGE, WIDTH + 2 * EDGE, HEIGHT + EDGE)
    domain(box("Blue water", around, (0, 0, low + (HEIGHT - EDGE) / 2), **blue), resolution=48)
    column = (0.24, WIDTH + 2 * EDGE, 0.4)
    place = ((column[0] - LENGTH) / 2 - EDGE, 0, low - EDGE + column[2] / 2)
    flow(box("Column of water", column, place, **blue), behavior="GEOMETRY")
    camera((0.5, -2.6, 1.75), (0, 0, 1.2), lens=38)
    light(sun=3, elevation=65, azimuth=30, sky=(0.75, 0.8, 0.85))
