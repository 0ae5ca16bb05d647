# SPDX-License-Identifier: GPL-3.0-or-later
"""A living room, seen from where its fourth wall would be."""

from ..props import ball, box, boxes, cylinder, joined, legs, revolved
from ..scene_setup import begin, camera, light

PLASTER, CREAM = {"colour": (0.82, 0.78, 0.7)}, {"colour": (0.93, 0.91, 0.86)}
OAK, WALNUT, BLACK = (
    {"colour": (0.55, 0.36, 0.2)},
    {"colour": (0.28, 0.16, 0.09)},
    {"colour": (0.03, 0.03, 0.03)},
)
RED, BLUE, GREEN = {"colour": (0.5, 0.1, 0.1)}, {"colour": (0.1, 0.25, 0.45)}, {"colour": (0.12, 0.35, 0.2)}
OCHRE, PLUM, SLATE = (
    {"colour": (0.6, 0.45, 0.15)},
    {"colour": (0.35, 0.2, 0.4)},
    {"colour": (0.28, 0.33, 0.4)},
)
FRONT, WEST = (
    (90, 0, 0),
    (0, 0, 90),
)  # how a cylinder is turned to face the camera; what stands against the right


def build():
    """Builds the scene."""
    begin(1)
    _room()
    _sofa((-0.4, 2.0, 0))
    seat, back = ((0.7, 0.7, 0.25), (0, 0, 0.3)), ((0.7, 0.16, 0.75), (0, 0.3, 0.55))
    arms = [((0.12, 0.7, 0.35), (x, 0, 0.42)) for x in (-0.36, 0.36)]
    boxes("Armchair", [*legs(0.36, 0.3, 0.18), seat, back, *arms], (-2.2, 0.1, 0), turn=(0, 0, 70), **GREEN)
    box("Rug", (2.8, 1.9, 0.02), (-0.2, 0.2, 0.01), **RED)
    boxes(
        "Coffee table", [*legs(0.5, 0.25, 0.38), ((1.2, 0.65, 0.04), (0, 0, 0.4))], (-0.2, 0.2, 0.02), **OAK
    )
    _bookshelf((2.4, 2.32, 0))
    _television((2.6, 0.3, 0))
    _picture_and_clock(-0.4, 1.2)
    stand = [(0, 0), (0.15, 0), (0.15, 0.03), (0.015, 0.04), (0.015, 1.35), (0.2, 1.3), (0.11, 1.6), (0, 1.6)]
    revolved("Floor lamp", stand, (-1.95, 2.15, 0), **CREAM)
    wicker = [(0, 0), (0.16, 0), (0.2, 0.28), (0.18, 0.28), (0.145, 0.02), (0, 0.02)]
    revolved("Basket", wicker, (1.5, 0.5, 0), **OAK)
    for x, look in ((1.45, RED), (1.5, BLUE), (1.55, OCHRE)):
        box("Magazine", (0.012, 0.2, 0.27), (x, 0.5, 0.16), **look)
    camera((1.3, -5.6, 2.3), (-0.1, 0.9, 0.8), lens=26)
    light(sun=2.0, elevation=50, azimuth=-150)


def _room():
    box("Floor", (6, 5, 0.1), (0, 0, -0.05), colour=(0.45, 0.3, 0.17))
    box("Back wall", (6.2, 0.1, 2.7), (0, 2.55, 1.35), **PLASTER)
    beside = [((0.1, 1.8, 2.7), (0, y, 1.35)) for y in (-1.6, 1.6)]
    below, above = ((0.1, 1.4, 0.9), (0, 0, 0.45)), ((0.1, 1.4, 0.5), (0, 0, 2.45))
    boxes("Left wall", [*beside, below, above], (-3.05, 0, 0), **PLASTER)
    upright = [((0.08, 0.06, 1.3), (0, y, 0)) for y in (-0.67, 0, 0.67)]
    across = [((0.08, 1.4, 0.06), (0, 0, z)) for z in (-0.62, 0.1, 0.62)]
    boxes("Window", [*upright, *across], (-3.05, 0, 1.55), **CREAM)


def _sofa(at):
    x, y, _ = at
    seats = [((0.64, 0.7, 0.16), (side, -0.08, 0.38)) for side in (-0.66, 0, 0.66)]
    frame = [((2.4, 0.9, 0.2), (0, 0, 0.2)), ((2.4, 0.22, 0.65), (0, 0.34, 0.6))]
    arms = [((0.2, 0.9, 0.35), (side, 0, 0.45)) for side in (-1.1, 1.1)]
    boxes("Sofa", [*legs(1.1, 0.4, 0.1), *frame, *seats, *arms], at, **SLATE)
    for side, look in ((-0.65, OCHRE), (0.7, RED)):  # leaning against its back
        box("Cushion", (0.42, 0.12, 0.4), (x + side, y + 0.13, 0.67), turn=(-15, 0, 0), **look)


def _bookshelf(at):
    x, y, _ = at
    shelves = [((0.9, 0.3, 0.03), (0, 0, 0.1 + 0.4 * row)) for row in range(6)]
    sides = [((0.03, 0.3, 2.13), (side, 0, 1.065)) for side in (-0.465, 0.465)]
    boxes("Bookshelf", [*shelves, *sides, ((0.96, 0.02, 2.13), (0, 0.16, 1.065))], at, **WALNUT)
    for row in range(4):
        for number, look in enumerate((RED, BLUE, GREEN, OCHRE, PLUM, SLATE)):
            thick, high = 0.05 + 0.02 * (number % 2), 0.24 + 0.02 * ((number * 5 + row) % 4)
            place = (x - 0.34 + 0.075 * number, y - 0.02, 0.115 + 0.4 * row + high / 2)
            box("Book", (thick, 0.2, high), place, **look)
    clay = [(0, 0), (0.06, 0), (0.08, 0.13), (0.065, 0.13), (0, 0.1)]
    pot = revolved("Pot", clay, (x, y - 0.02, 1.715), colour=(0.6, 0.3, 0.18))
    joined("Potted plant", pot, ball("Leaves", 0.11, (x, y - 0.02, 1.89), detail=2, **GREEN))


def _television(at):
    x, y, _ = at
    boxes("Media console", [*legs(0.6, 0.15, 0.1), ((1.4, 0.4, 0.4), (0, 0, 0.3))], at, turn=WEST, **WALNUT)
    foot, neck = ((0.3, 0.2, 0.03), (0, 0, 0.015)), ((0.06, 0.04, 0.1), (0, 0, 0.07))
    screen = ((1.1, 0.04, 0.62), (0, 0, 0.4))
    boxes("Television", [foot, neck, screen], (x, y, 0.5), turn=WEST, roughness=0.2, **BLACK)


def _picture_and_clock(left, right):
    frame = box("Frame", (0.9, 0.04, 0.6), (left, 2.48, 1.65), **WALNUT)
    joined("Framed picture", frame, box("Canvas", (0.78, 0.01, 0.48), (left, 2.455, 1.65), **BLUE))
    case = cylinder("Case", 0.17, 0.04, (right, 2.48, 1.8), turn=FRONT, **WALNUT)
    face = cylinder("Face", 0.15, 0.01, (right, 2.455, 1.8), turn=FRONT, **CREAM)
    pointers = [((0.1, 0.01, 0.01), (0.05, 0, 0)), ((0.01, 0.01, 0.13), (0, 0, 0.065))]
    joined("Wall clock", case, face, boxes("Hands", pointers, (right, 2.445, 1.8), **BLACK))
