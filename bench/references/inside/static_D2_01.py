# SPDX-License-Identifier: GPL-3.0-or-later
"""A fishing harbour with its quay, its houses and its lighthouse, seen from the water."""

import math

from stage import begin, camera, light
from things import box, boxes, cylinder, joined, mesh, prism, revolved, sheet, tube

GRANITE, OAK, TAR = (0.42, 0.4, 0.38), (0.38, 0.24, 0.13), (0.07, 0.06, 0.06)
QUAY = 2.0  # above the sea, which is at 0; its edge is at y = 0
# Of a hull, from stern to bow: how far along, half the beam, how high the side, how deep the keel.
STATIONS = [
    (-5, 1.5, 1.3, -0.4),
    (-2, 2.0, 1.2, -0.8),
    (2, 1.9, 1.4, -0.8),
    (4.5, 1.1, 1.8, -0.6),
    (6, 0.1, 2.2, -0.1),
]


def build():
    """Builds the scene."""
    begin(1)
    sheet("Sea", (300, 300), (1, 1), (0, -40, 0), colour=(0.04, 0.16, 0.22), roughness=0.15)
    box("Granite quay", (70, 20, 5), (-5, 10, QUAY - 2.5), colour=GRANITE)
    for x, y, colour in (
        (-17, -3, (0.1, 0.25, 0.5)),
        (-3, -2.9, (0.55, 0.1, 0.08)),
        (11, -3.1, (0.1, 0.4, 0.25)),
    ):
        _trawler((x, y, 0), colour)
    _on_the_quay()
    for number, x in enumerate((-20, -11, -2, 7, 16)):
        _house(x, number)
    _lighthouse()
    _crane()
    _lamp()
    _stairs()
    camera((-16, -38, 12), (5, -2, 3.5), lens=25)
    light(sun=3.5, elevation=12, azimuth=-55, sky=(0.75, 0.6, 0.5), colour=(1, 0.75, 0.45))


def _trawler(at, colour):
    points = [
        point
        for x, half, high, deep in STATIONS
        for point in ((x, -half, high), (x, 0, deep), (x, half, high))
    ]
    faces = [(0, 1, 2), (12, 14, 13)]  # the stern, the bow
    for left in range(0, 12, 3):
        keel, right = left + 1, left + 2
        faces += [
            (left, left + 3, keel + 3, keel),
            (keel, keel + 3, right + 3, right),
            (right, right + 3, left + 3, left),
        ]
    hull = mesh("Hull", points, faces, at, colour=colour)
    cabin = boxes(
        "Cabin",
        [((2.2, 2, 2.2), (-2.6, 0, 2.3)), ((2.6, 2.3, 0.15), (-2.6, 0, 3.4))],
        at,
        colour=(0.9, 0.88, 0.82),
    )
    panes = boxes(
        "Panes",
        [((2.24, 1.5, 0.6), (-2.6, 0, 2.8)), ((1.5, 2.04, 0.6), (-2.6, 0, 2.8))],
        at,
        colour=(0.1, 0.15, 0.2),
    )
    mast = tube("Mast", [(1, 0, 1), (1, 0, 7.5)], 0.09, at, colour=OAK)
    boom = tube("Boom", [(1, 0, 2.6), (-2.2, 0, 5.2)], 0.07, at, colour=OAK)
    stay = tube("Stay", [(1, 0, 7.4), (5.8, 0, 2.2)], 0.02, at, sides=6, colour=TAR)
    joined("Trawler", hull, cabin, panes, mast, boom, stay)


def _on_the_quay():
    arch = [
        (0.35 * math.cos(turn), 0.5 * math.sin(turn)) for turn in [math.pi * part / 8 for part in range(9)]
    ]
    for x, y in ((-10, 1.2), (-9, 1.5), (-9.6, 2.6)):
        cage = prism("Cage", arch, 0.9, (x, y, QUAY), colour=(0.5, 0.4, 0.22))
        bands = [
            prism(
                "Band",
                [(1.06 * across, 1.06 * up) for across, up in arch],
                0.06,
                (x, y + aside, QUAY),
                colour=TAR,
            )
            for aside in (-0.4, 0, 0.4)
        ]
        joined("Lobster pot", cage, *bands)
    wound = [(0.35 + 0.01 * math.sin(3 * turn), turn) for turn in [0.5 * step for step in range(51)]]
    line = [(out * math.cos(turn), out * math.sin(turn), 0.05 + 0.0155 * turn) for out, turn in wound]
    tube("Coil of rope", line, 0.05, (-6.5, 1.6, QUAY), sides=8, colour=(0.65, 0.55, 0.38))
    walls = [((1, 0.05, 0.4), (0, y, 0.2)) for y in (-0.3, 0.3)] + [
        ((0.05, 0.65, 0.4), (x, 0, 0.2)) for x in (-0.5, 0.5)
    ]
    for at in ((1.5, 1.6, QUAY), (2.8, 1.7, QUAY), (1.6, 2.5, QUAY), (1.5, 1.62, QUAY + 0.4)):
        boxes("Fish crate", [*walls, ((1, 0.6, 0.05), (0, 0, 0.025))], at, colour=(0.55, 0.42, 0.25))
    iron = [(0, 0), (0.3, 0), (0.3, 0.06), (0.2, 0.1), (0.17, 0.5), (0.3, 0.58), (0.26, 0.7), (0, 0.74)]
    for x in (-13, 5):
        revolved("Bollard", iron, (x, 0.7, QUAY), colour=(0.1, 0.1, 0.11), metal=0.7)


def _house(x, number):
    tall, wide, at = 5.5 + (number * 3 % 4) * 0.6, 7.0, (x, 14, QUAY)
    plaster = [(0.88, 0.85, 0.78), (0.75, 0.72, 0.68), (0.85, 0.76, 0.62)][number % 3]
    shade = [(0.12, 0.25, 0.42), (0.45, 0.12, 0.1), (0.14, 0.32, 0.22)][number % 3]
    walls = prism(
        "Walls",
        [(-3, 0), (3, 0), (3, tall), (0, tall + 2.6), (-3, tall)],
        wide,
        at,
        turn=(0, 0, 90),
        colour=plaster,
    )
    roof = [
        (-3.4, tall - 0.3),
        (0, tall + 2.65),
        (3.4, tall - 0.3),
        (3.4, tall - 0.05),
        (0, tall + 2.9),
        (-3.4, tall - 0.05),
    ]
    slates = prism("Slates", roof, wide + 0.3, at, turn=(0, 0, 90), colour=(0.16, 0.18, 0.22))
    holes = [((1.0, 0.1, 1.3), (across, -3.02, up)) for across in (-2.2, 2.2) for up in (1.7, tall - 1.1)]
    openings = boxes("Openings", [*holes, ((1.1, 0.1, 2.2), (0, -3.02, 1.1))], at, colour=shade)
    joined(
        "House",
        walls,
        slates,
        openings,
        box("Chimney", (0.8, 0.8, 2), (x + 2.5, 14, QUAY + tall + 2.8), colour=plaster),
    )


def _lighthouse():
    box("Breakwater", (6, 18, 5), (27, -9, QUAY - 2.5), colour=(0.36, 0.34, 0.33))
    white = {"colour": (0.93, 0.92, 0.88)}
    revolved(
        "White lighthouse",
        [(0, 0), (2.2, 0), (2.2, 0.6), (1.8, 0.8), (1.2, 10), (1.7, 10.3), (1.7, 10.6), (0, 10.6)],
        (27, -13, QUAY),
        **white,
    )
    red = [
        (0, 0),
        (1.0, 0),
        (1.0, 0.7),
        (0.9, 0.7),
        (0.9, 2.0),
        (1.15, 2.0),
        (0.6, 2.9),
        (0.1, 3.2),
        (0, 3.4),
    ]
    revolved("Red lantern room", red, (27, -13, QUAY + 10.6), colour=(0.7, 0.05, 0.04))


def _crane():
    at = (-7.5, 1.2, QUAY)
    post = box("Post", (0.4, 0.4, 5.5), (-7.5, 1.2, QUAY + 2.75), colour=OAK)
    feet = boxes(
        "Feet", [((2.2, 0.35, 0.3), (0, 0, 0.15)), ((0.35, 1.8, 0.3), (0, 0.2, 0.15))], at, colour=OAK
    )
    jib = tube("Jib", [(0, 0, 2.6), (0, -3.4, 6.2)], 0.16, at, sides=8, colour=OAK)
    ropes = [
        tube("Rope", way, 0.03, at, sides=6, colour=TAR)
        for way in ([(0, 0, 5.4), (0, -3.4, 6.2)], [(0, -3.4, 6.2), (0, -3.4, 3.6)])
    ]
    hook = tube(
        "Hook",
        [(0, -3.4, 3.6), (0.12, -3.4, 3.4), (0, -3.4, 3.25), (-0.12, -3.4, 3.35)],
        0.04,
        at,
        sides=8,
        colour=TAR,
    )
    joined("Timber crane", post, feet, jib, *ropes, hook)


def _lamp():
    iron = [(0, 0), (0.22, 0), (0.2, 0.4), (0.07, 0.6), (0.06, 3.4), (0.2, 3.5), (0, 3.5)]
    post = revolved("Post", iron, (8, 0.8, QUAY), sides=16, colour=(0.06, 0.1, 0.09))
    glass = cylinder(
        "Glass", 0.17, 0.5, (8, 0.8, QUAY + 3.75), top=0.26, sides=6, colour=(1, 0.85, 0.5), glow=2
    )
    joined(
        "Street lamp",
        post,
        glass,
        cylinder("Hat", 0.34, 0.25, (8, 0.8, QUAY + 4.125), top=0.03, sides=6, colour=(0.06, 0.1, 0.09)),
    )


def _stairs():
    steps, rise, tread = 10, 0.25, 0.35
    outline = [(0, -1), (steps * tread, -1)]
    for step in range(steps):  # from the sea up to the quay, towards -x
        outline += [
            ((steps - step) * tread, -0.5 + step * rise),
            ((steps - step) * tread, -0.25 + step * rise),
        ]
    prism(
        "Stone stairway", [*outline, (0, -0.5 + steps * rise)], 1.6, (20, -0.8, 0), colour=(0.5, 0.48, 0.45)
    )
