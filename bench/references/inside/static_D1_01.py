# SPDX-License-Identifier: GPL-3.0-or-later
"""A living room, seen from where its fourth wall would be."""

from stage import begin, camera, light
from things import ball, box, boxes, cylinder, joined, legs, revolved

WALL, OAK, WALNUT, GREY = (0.82, 0.78, 0.7), (0.55, 0.36, 0.2), (0.28, 0.16, 0.09), (0.28, 0.33, 0.4)
SPINES = [
    (0.5, 0.1, 0.1),
    (0.1, 0.25, 0.45),
    (0.12, 0.35, 0.2),
    (0.6, 0.45, 0.15),
    (0.35, 0.2, 0.4),
    (0.2, 0.2, 0.22),
]


def build():
    """Builds the scene."""
    begin(1)
    box("Floor", (6, 5, 0.1), (0, 0, -0.05), colour=(0.45, 0.3, 0.17))
    box("Back wall", (6.2, 0.1, 2.7), (0, 2.55, 1.35), colour=WALL)
    beside = [((0.1, 1.8, 2.7), (0, y, 1.35)) for y in (-1.6, 1.6)]
    boxes(
        "Left wall",
        [*beside, ((0.1, 1.4, 0.9), (0, 0, 0.45)), ((0.1, 1.4, 0.5), (0, 0, 2.45))],
        (-3.05, 0, 0),
        colour=WALL,
    )
    bars = [((0.08, 0.06, 1.3), (0, y, 0)) for y in (-0.67, 0, 0.67)] + [
        ((0.08, 1.4, 0.06), (0, 0, z)) for z in (-0.62, 0.1, 0.62)
    ]
    boxes("Window", bars, (-3.05, 0, 1.55), colour=(0.95, 0.95, 0.93))
    sit()
    put_up()
    hang()
    camera((1.3, -5.6, 2.3), (-0.1, 0.9, 0.8), lens=26)
    light(sun=2.0, elevation=50, azimuth=-150)


def sit():
    """What people sit on and at."""
    seats = [((0.64, 0.7, 0.16), (x, -0.08, 0.38)) for x in (-0.66, 0, 0.66)]
    frame = [((2.4, 0.9, 0.2), (0, 0, 0.2)), ((2.4, 0.22, 0.65), (0, 0.34, 0.6))]
    arms = [((0.2, 0.9, 0.35), (x, 0, 0.45)) for x in (-1.1, 1.1)]
    boxes("Sofa", [*legs(1.1, 0.4, 0.1), *frame, *seats, *arms], (-0.4, 2.0, 0), colour=GREY)
    for x, colour in ((-1.05, (0.75, 0.5, 0.12)), (0.3, (0.6, 0.2, 0.15))):
        box("Cushion", (0.42, 0.12, 0.4), (x, 2.13, 0.67), turn=(-15, 0, 0), colour=colour)
    seat = [((0.7, 0.7, 0.25), (0, 0, 0.3)), ((0.7, 0.16, 0.75), (0, 0.3, 0.55))]
    arms = [((0.12, 0.7, 0.35), (x, 0, 0.42)) for x in (-0.36, 0.36)]
    boxes(
        "Armchair",
        [*legs(0.36, 0.3, 0.18), *seat, *arms],
        (-2.2, 0.1, 0),
        turn=(0, 0, 70),
        colour=(0.25, 0.4, 0.3),
    )
    box("Rug", (2.8, 1.9, 0.02), (-0.2, 0.2, 0.01), colour=(0.5, 0.16, 0.15))
    boxes(
        "Coffee table",
        [*legs(0.5, 0.25, 0.38), ((1.2, 0.65, 0.04), (0, 0, 0.4))],
        (-0.2, 0.2, 0.02),
        colour=OAK,
    )


def put_up():
    """What stands along the walls, with what is in it or on it."""
    shelves = [((0.9, 0.3, 0.03), (0, 0, 0.1 + 0.4 * row)) for row in range(6)]
    sides = [((0.03, 0.3, 2.13), (x, 0, 1.065)) for x in (-0.465, 0.465)]
    boxes(
        "Bookshelf", [*shelves, *sides, ((0.96, 0.02, 2.13), (0, 0.16, 1.065))], (2.4, 2.32, 0), colour=WALNUT
    )
    for row in range(4):
        for number, colour in enumerate(SPINES):
            height = 0.24 + 0.02 * ((number * 5 + row) % 4)
            at = (2.06 + 0.075 * number, 2.3, 0.115 + 0.4 * row + height / 2)
            box("Book", (0.05 + 0.02 * (number % 2), 0.2, height), at, colour=colour)
    pot = revolved(
        "Pot",
        [(0, 0), (0.06, 0), (0.08, 0.13), (0.065, 0.13), (0, 0.1)],
        (2.4, 2.3, 1.715),
        colour=(0.6, 0.3, 0.18),
    )
    leaves = ball("Leaves", 0.11, (2.4, 2.3, 1.89), detail=2, colour=(0.1, 0.35, 0.1))
    joined("Potted plant", pot, leaves)
    boxes(
        "Media console",
        [*legs(0.6, 0.15, 0.1), ((1.4, 0.4, 0.4), (0, 0, 0.3))],
        (2.6, 0.3, 0),
        turn=(0, 0, 90),
        colour=WALNUT,
    )
    foot, screen = ((0.3, 0.2, 0.03), (0, 0, 0.015)), ((1.1, 0.04, 0.62), (0, 0, 0.4))
    boxes(
        "Television",
        [foot, ((0.06, 0.04, 0.1), (0, 0, 0.07)), screen],
        (2.6, 0.3, 0.5),
        turn=(0, 0, 90),
        colour=(0.03, 0.03, 0.03),
        roughness=0.2,
    )


def hang():
    """What hangs on the wall, and what is left for the floor."""
    frame = box("Frame", (0.9, 0.04, 0.6), (-0.4, 2.48, 1.65), colour=WALNUT)
    canvas = box("Canvas", (0.78, 0.01, 0.48), (-0.4, 2.455, 1.65), colour=(0.2, 0.4, 0.5))
    joined("Framed picture", frame, canvas)
    case = cylinder("Case", 0.17, 0.04, (1.2, 2.48, 1.8), turn=(90, 0, 0), colour=WALNUT)
    face = cylinder("Face", 0.15, 0.01, (1.2, 2.455, 1.8), turn=(90, 0, 0), colour=(0.9, 0.88, 0.8))
    hands = boxes(
        "Hands",
        [((0.1, 0.01, 0.01), (0.05, 0, 0)), ((0.01, 0.01, 0.13), (0, 0, 0.065))],
        (1.2, 2.445, 1.8),
        colour=WALNUT,
    )
    joined("Wall clock", case, face, hands)
    stand = [(0, 0), (0.15, 0), (0.15, 0.03), (0.015, 0.04), (0.015, 1.35), (0.2, 1.3), (0.11, 1.6), (0, 1.6)]
    revolved("Floor lamp", stand, (-1.95, 2.15, 0), colour=(0.85, 0.75, 0.5))
    wicker = [(0, 0), (0.16, 0), (0.2, 0.28), (0.18, 0.28), (0.145, 0.02), (0, 0.02)]
    revolved("Basket", wicker, (1.5, 0.5, 0), colour=(0.55, 0.4, 0.22))
    for x, colour in ((-0.05, (0.7, 0.2, 0.2)), (0.0, (0.2, 0.4, 0.6)), (0.05, (0.8, 0.7, 0.2))):
        box("Magazine", (0.012, 0.2, 0.27), (1.5 + x, 0.5, 0.16), colour=colour)
