# SPDX-License-Identifier: GPL-3.0-or-later
"""A country kitchen, seen from where its fourth wall would be."""

import math

from stage import begin, camera, light
from things import ball, box, boxes, cylinder, joined, legs, prism, revolved, tube

OAK, PINE, IRON = (0.4, 0.25, 0.12), (0.75, 0.55, 0.33), (0.06, 0.06, 0.07)
TOP = 0.76  # of the table
PLATE = [(0, 0), (0.06, 0), (0.1, 0.015), (0.1, 0.02), (0.06, 0.006), (0, 0.006)]
BOWL = [(0, 0), (0.1, 0), (0.19, 0.09), (0.2, 0.12), (0.185, 0.12), (0.13, 0.015), (0, 0.015)]
JUG = [
    *((0, 0), (0.06, 0), (0.075, 0.08), (0.05, 0.17), (0.06, 0.2)),
    *((0.05, 0.2), (0.04, 0.17), (0.065, 0.08), (0.05, 0.01), (0, 0.01)),
]


def build():
    """Builds the scene."""
    begin(1)
    _room()
    _stove()
    _dresser()
    _table()
    for x, y, turn in ((-0.3, -1.05, 180), (0.4, 0.25, 0), (-0.85, -0.4, 90), (1.25, -0.4, -90)):
        _chair((x, y, 0), turn)
    shade = [(0, 0.8), (0.01, 0.8), (0.01, 0.2), (0.2, 0), (0.19, 0), (0, 0.19)]
    revolved("Pendant lamp", shade, (0.2, -0.4, 1.7), colour=(0.1, 0.25, 0.2))
    _broom()
    camera((0.9, -5.2, 2.1), (-0.1, 0.5, 1.05), lens=27)
    light(sun=3, elevation=32, azimuth=-25, sky=(0.8, 0.85, 0.9))


def _room():
    wall = {"colour": (0.85, 0.83, 0.75)}
    box("Terracotta floor", (5.2, 4.4, 0.1), (0, -0.2, -0.05), colour=(0.6, 0.28, 0.17))
    box("Tiled wall", (5.2, 0.1, 2.5), (0, 2.05, 1.25), **wall)
    box("Side wall", (0.1, 4.4, 2.5), (-2.65, -0.2, 1.25), **wall)
    beams = [((0.14, 4.4, 0.18), (x, -0.2, 2.41)) for x in (-2, -0.7, 0.7, 2)]
    boxes("Beamed ceiling", [((5.2, 4.4, 0.1), (0, -0.2, 2.55)), *beams], colour=(0.5, 0.36, 0.22))


def _stove():
    at = (-1.3, 1.68, 0)
    body = boxes("Body", [*legs(0.4, 0.25, 0.12), ((0.9, 0.6, 0.73), (0, 0, 0.485))], at, colour=IRON)
    hob = box("Hob", (0.96, 0.64, 0.05), (-1.3, 1.67, 0.875), colour=(0.12, 0.12, 0.13), metal=1.0)
    doors = boxes(
        "Doors", [((0.38, 0.02, 0.4), (x, -0.31, 0.5)) for x in (-0.21, 0.21)], at, colour=(0.15, 0.15, 0.16)
    )
    joined("Cast-iron stove", body, hob, doors)
    copper = {"colour": (0.72, 0.35, 0.18), "metal": 1.0, "roughness": 0.3}
    place = (-1.5, 1.65, 0.9)
    pot = revolved(
        "Pot",
        [(0, 0), (0.11, 0), (0.12, 0.06), (0.06, 0.14), (0.015, 0.15), (0.015, 0.18), (0, 0.18)],
        place,
        **copper,
    )
    spout = tube("Spout", [(0.1, 0, 0.05), (0.16, 0, 0.09), (0.19, 0, 0.14)], 0.016, place, **copper)
    arc = [(0.1 * math.cos(turn), 0, 0.1 + 0.14 * math.sin(turn)) for turn in (0.2, 0.8, 1.57, 2.34, 2.94)]
    joined("Copper kettle", pot, spout, tube("Handle", arc, 0.008, place, **copper))
    hood = prism(
        "Hood",
        [(-0.5, 0), (0.5, 0), (0.5, 0.08), (0.18, 0.4), (-0.18, 0.4), (-0.5, 0.08)],
        0.6,
        (-1.3, 1.7, 1.6),
        colour=(0.9, 0.9, 0.87),
    )
    joined("Cooker hood", hood, box("Flue", (0.26, 0.26, 0.5), (-1.3, 1.84, 2.25), colour=(0.9, 0.9, 0.87)))


def _dresser():
    shelves = [((1.3, 0.22, 0.025), (0, 0.1, z)) for z in (1.2, 1.6, 2.0)]
    sides = [((0.03, 0.22, 1.2), (x, 0.1, 1.45)) for x in (-0.635, 0.635)]
    back, base, top = (
        ((1.3, 0.02, 1.2), (0, 0.21, 1.45)),
        ((1.3, 0.45, 0.82), (0, 0, 0.41)),
        ((1.36, 0.48, 0.04), (0, 0, 0.84)),
    )
    boxes("Oak dresser", [*shelves, *sides, back, base, top], (0.55, 1.76, 0), colour=OAK)
    for z in (0.86, 1.2125):
        for x in (-0.35, 0, 0.35):  # they stand on their rims, against the back
            plate = revolved(
                "China plate", PLATE, (0.55 + x, 1.955, z + 0.1), colour=(0.15, 0.3, 0.65), roughness=0.2
            )
            plate.rotation_euler = (math.pi / 2, 0, 0)


def _table():
    boxes(
        "Pine table",
        [*legs(0.72, 0.32, TOP - 0.04, 0.08), ((1.6, 0.8, 0.04), (0, 0, TOP - 0.02))],
        (0.2, -0.4, 0),
        colour=PINE,
    )
    box("Bread board", (0.45, 0.28, 0.02), (-0.2, -0.5, TOP + 0.01), colour=OAK)
    crust = [
        (0.16 * math.cos(turn), 0.11 * math.sin(turn)) for turn in [math.pi * part / 10 for part in range(11)]
    ]
    prism("Loaf of bread", crust, 0.13, (-0.2, -0.5, TOP + 0.02), colour=(0.6, 0.35, 0.13))
    blade = box(
        "Blade", (0.22, 0.03, 0.004), (0.22, -0.68, TOP + 0.005), colour=(0.75, 0.75, 0.78), metal=1.0
    )
    joined("Bread knife", blade, box("Handle", (0.12, 0.025, 0.01), (0.39, -0.68, TOP + 0.005), colour=OAK))
    honey = [(0, 0), (0.045, 0), (0.045, 0.09), (0.035, 0.1), (0, 0.1)]
    jar = revolved("Jar", honey, (0.3, -0.2, TOP), colour=(0.8, 0.45, 0.05), roughness=0.1, clear=0.5)
    joined("Honey jar", jar, cylinder("Lid", 0.04, 0.015, (0.3, -0.2, TOP + 0.1075), colour=(0.8, 0.75, 0.6)))
    pewter = {"colour": (0.5, 0.5, 0.53), "metal": 1.0}
    grip = tube(
        "Grip",
        [(0.05, 0, 0.17), (0.11, 0, 0.14), (0.11, 0, 0.08), (0.07, 0, 0.06)],
        0.008,
        (0.05, -0.2, TOP),
        **pewter,
    )
    joined("Pewter jug", revolved("Belly", JUG, (0.05, -0.2, TOP), **pewter), grip)
    revolved("Fruit bowl", BOWL, (0.65, -0.4, TOP), colour=(0.55, 0.6, 0.65))
    for number in range(7):  # one in the middle, six around it
        turn, out = math.pi * number / 3, 0.0 if number == 6 else 0.073
        ball(
            "Lemon",
            0.036,
            (0.65 + out * math.cos(turn), -0.4 + out * math.sin(turn), TOP + 0.052),
            colour=(0.9, 0.8, 0.1),
        )


def _chair(at, turn):
    posts = [((0.04, 0.04, 1.0), (x, 0.19, 0.5)) for x in (-0.19, 0.19)] + [
        ((0.04, 0.04, 0.43), (x, -0.19, 0.215)) for x in (-0.19, 0.19)
    ]
    slats = [((0.36, 0.02, 0.07), (0, 0.19, z)) for z in (0.62, 0.78, 0.94)]
    boxes(
        "Ladder-back chair",
        [*posts, *slats, ((0.44, 0.42, 0.03), (0, 0, 0.445))],
        at,
        turn=(0, 0, turn),
        colour=(0.5, 0.33, 0.17),
    )


def _broom():
    lean = 12  # degrees, towards the side wall
    straw = revolved("Straw", [(0, 0), (0.11, 0), (0.03, 0.35), (0, 0.35)], colour=(0.8, 0.65, 0.3))
    stick = cylinder("Stick", 0.014, 1.1, (0, 0, 0.85), colour=OAK)
    broom = joined("Straw broom", straw, stick)
    broom.rotation_euler = (0, -math.radians(lean), 0)
    broom.location = (-2.29, 0.5, 0.11 * math.sin(math.radians(lean)))
