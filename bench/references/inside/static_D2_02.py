# SPDX-License-Identifier: GPL-3.0-or-later
"""A narrow-gauge railway halt in the Alps in winter: the train before its platform, the mountain behind."""

import math

from stage import begin, camera, light
from things import ball, box, boxes, cylinder, joined, legs, prism, revolved, sheet, tube

SNOW, OAK, IRON = (0.93, 0.95, 0.98), (0.42, 0.26, 0.13), {"colour": (0.08, 0.08, 0.09), "metal": 0.7}
RAIL, DECK, GAUGE = 0.24, 0.7, 0.38  # heights of the rails' and the platform's tops; half the gauge
FIRS = [(-24, 16), (-19, 22), (-14, 13), (-3, 19), (4, 17), (11, 20), (19, 13), (25, 19)]


def build():
    """Builds the scene."""
    begin(1)
    sheet("Snow", (240, 240), (1, 1), (0, 60, 0), colour=SNOW)
    sleepers = [((0.25, 1.3, 0.12), (0.7 * number, 0, 0.06)) for number in range(-45, 46)]
    ties = boxes("Sleepers", sleepers, colour=(0.2, 0.14, 0.1))
    rails = boxes(
        "Rails",
        [((63.5, 0.06, 0.12), (0, y, 0.18)) for y in (-GAUGE, GAUGE)],
        colour=(0.5, 0.5, 0.52),
        metal=1.0,
    )
    joined("Steel rails", rails, ties)
    stone = box("Stone", (42, 5.6, DECK - 0.08), (0, 4.3, (DECK - 0.08) / 2), colour=(0.4, 0.38, 0.37))
    joined("Platform", stone, box("Cover", (42, 5.6, 0.08), (0, 4.3, DECK - 0.04), colour=SNOW))
    _locomotive()
    _wagons()
    _station()
    _on_the_platform()
    _behind()
    camera((8, -15.5, 6.6), (0.5, 4, 2.6), lens=24)
    light(sun=3, elevation=28, azimuth=40, sky=(0.45, 0.62, 0.9), colour=(1, 0.93, 0.8))


def _wheels(places, radius):
    """Pairs of wheels on the rails, with their axles, at these places along the track."""
    found = []
    for x in places:
        found += [
            cylinder("Wheel", radius, 0.08, (x, y, RAIL + radius), turn=(90, 0, 0), sides=24, **IRON)
            for y in (-GAUGE, GAUGE)
        ]
        found.append(
            cylinder("Axle", 0.05, 2 * GAUGE, (x, 0, RAIL + radius), turn=(90, 0, 0), sides=12, **IRON)
        )
    return found


def _locomotive():
    green = {"colour": (0.04, 0.28, 0.12), "roughness": 0.35}
    boiler = cylinder("Boiler", 0.62, 3.6, (1.0, 0, 1.75), turn=(0, 90, 0), **green)
    cab = boxes(
        "Cab",
        [((1.5, 1.7, 1.2), (-1.4, 0, 1.4)), ((1.8, 1.9, 0.12), (-1.4, 0, 2.86)), *legs(0.65, 0.8, 0.8, 0.12)],
        **green,
    )
    for point in cab.data.vertices:  # the cab's posts stand on its sides
        if point.co.z < 0.81 and abs(point.co.x) < 0.8 and abs(point.co.y) > 0.7:
            point.co.x, point.co.z = point.co.x - 1.4, point.co.z + 2.0
    frame = boxes(
        "Frame",
        [((5.4, 1.1, 0.25), (0.3, 0, 0.95)), ((0.2, 1.7, 0.35), (3.0, 0, 0.9))],
        colour=(0.55, 0.08, 0.06),
    )
    stack = revolved("Chimney", [(0, 0), (0.2, 0), (0.17, 0.6), (0.27, 0.9), (0, 0.9)], (2.3, 0, 2.3), **IRON)
    dome = revolved(
        "Dome",
        [(0, 0), (0.28, 0), (0.26, 0.3), (0.1, 0.45), (0, 0.47)],
        (0.8, 0, 2.3),
        colour=(0.75, 0.55, 0.2),
        metal=1.0,
    )
    lamp = cylinder("Lantern", 0.16, 0.2, (2.9, 0, 2.05), turn=(0, 90, 0), colour=(1, 0.9, 0.6), glow=1)
    rods = boxes(
        "Rods", [((2.4, 0.06, 0.1), (0.6, y, RAIL + 0.35)) for y in (-GAUGE - 0.07, GAUGE + 0.07)], **IRON
    )
    joined(
        "Green steam locomotive",
        boiler,
        cab,
        frame,
        stack,
        dome,
        lamp,
        rods,
        *_wheels((-0.6, 0.6, 1.8), 0.42),
    )


def _wagons():
    box_ = boxes(
        "Bunker",
        [((2.2, 1.6, 0.9), (-4.0, 0, 1.5)), ((2.4, 1.1, 0.2), (-4.0, 0, 0.95))],
        colour=(0.04, 0.24, 0.1),
    )
    coal = [
        ball(
            "Coal", 0.3, (-4.7 + 0.45 * step, 0.35 * (-1) ** step, 1.95), detail=1, colour=(0.02, 0.02, 0.02)
        )
        for step in range(4)
    ]
    joined("Coal tender", box_, *coal, *_wheels((-4.7, -3.3), 0.34))
    for x in (-9.0, -15.6):
        floor = boxes("Floor", [((6.0, 1.7, 0.2), (x, 0, 1.0))], colour=(0.1, 0.1, 0.1))
        side = boxes(
            "Side",
            [((5.8, 1.8, 1.0), (x, 0, 1.6)), ((5.8, 1.8, 0.25), (x, 0, 2.85))],
            colour=(0.5, 0.28, 0.12),
        )
        posts = boxes(
            "Posts",
            [((0.25, 1.8, 0.65), (x + 0.925 * step, 0, 2.42)) for step in range(-3, 4)],
            colour=(0.5, 0.28, 0.12),
        )
        glass = box("Glass", (5.6, 1.7, 0.65), (x, 0, 2.42), colour=(0.12, 0.16, 0.2), roughness=0.1)
        arch = [
            (1.0 * math.cos(turn), 0.3 * math.sin(turn)) for turn in [math.pi * part / 8 for part in range(9)]
        ]
        roof = prism("Roof", arch, 6.2, (x, 0, 2.97), turn=(0, 0, 90), colour=SNOW)
        joined("Wooden carriage", side, floor, posts, glass, roof, *_wheels((x - 2.2, x + 2.2), 0.34))


def _station():
    at = (10, 5.2, DECK)
    walls = prism(
        "Walls", [(-3, 0), (3, 0), (3, 2.6), (0, 4.8), (-3, 2.6)], 3.6, at, colour=(0.45, 0.27, 0.13)
    )
    slope = [(-3.5, 2.23), (0, 4.8), (3.5, 2.23), (3.5, 2.5), (0, 5.07), (-3.5, 2.5)]
    roof = prism("Roof", slope, 4.4, at, colour=SNOW)
    panes = boxes(
        "Panes",
        [((0.9, 0.06, 1.0), (x, -1.82, 1.5)) for x in (-1.8, 1.8)],
        at,
        colour=(0.95, 0.8, 0.5),
        glow=0.4,
    )
    door = box("Door", (1.1, 0.08, 2.1), (10, 3.38, DECK + 1.05), colour=(0.2, 0.32, 0.22))
    joined("Timber station building", walls, roof, panes, door)
    case = cylinder("Case", 0.3, 0.1, (10, 3.35, DECK + 2.9), turn=(90, 0, 0), colour=(0.1, 0.1, 0.1))
    face = cylinder("Face", 0.26, 0.02, (10, 3.29, DECK + 2.9), turn=(90, 0, 0), colour=(0.95, 0.93, 0.88))
    hands = boxes(
        "Hands",
        [((0.03, 0.01, 0.22), (0, 0, 0.1)), ((0.15, 0.01, 0.03), (0.07, 0, 0))],
        (10, 3.275, DECK + 2.9),
        colour=(0, 0, 0),
    )
    joined("Station clock", case, face, hands)


def _on_the_platform():
    slats = [((1.8, 0.12, 0.04), (0, y, 0.45)) for y in (-0.15, 0, 0.15)] + [
        ((1.8, 0.04, 0.12), (0, 0.22, z)) for z in (0.65, 0.85)
    ]
    ends = [((0.08, 0.45, 0.43), (x, 0, 0.215)) for x in (-0.75, 0.75)] + [
        ((0.08, 0.05, 0.5), (x, 0.245, 0.66)) for x in (-0.75, 0.75)
    ]
    boxes("Bench", [*slats, *ends], (5.0, 3.0, DECK), colour=OAK)
    for x, y, size, colour in (
        (6.7, 2.5, 0.8, (0.4, 0.2, 0.08)),
        (7.5, 2.7, 0.65, (0.3, 0.13, 0.06)),
        (7.1, 3.2, 0.95, (0.5, 0.28, 0.12)),
    ):
        case = box("Case", (size, 0.24, 0.6 * size), (x, y, DECK + 0.3 * size), colour=colour)
        grip = [(-0.12, 0, 0), (-0.1, 0, 0.07), (0.1, 0, 0.07), (0.12, 0, 0)]
        joined(
            "Leather suitcase",
            case,
            tube("Grip", grip, 0.018, (x, y, DECK + 0.6 * size), sides=8, colour=(0.1, 0.06, 0.03)),
        )
    bed = [((1.5, 0.8, 0.06), (0, 0, 0.4)), *(((0.05, 0.8, 0.7), (x, 0, 0.75)) for x in (-0.72,))]
    truck = boxes("Bed", bed, (2.2, 3.0, DECK), colour=(0.35, 0.2, 0.1))
    rollers = [
        cylinder("Roller", 0.19, 0.08, (2.2 + x, 3.0 + y, DECK + 0.19), turn=(90, 0, 0), sides=20, **IRON)
        for x in (-0.5, 0.5)
        for y in (-0.3, 0.3)
    ]
    joined("Luggage trolley", truck, *rollers)
    board = boxes("Board", [((2.4, 0.08, 0.6), (0, 0, 2.4))], (-1.5, 3.4, DECK), colour=(0.1, 0.2, 0.45))
    joined(
        "Signpost",
        board,
        boxes(
            "Posts",
            [((0.1, 0.1, 2.75), (x, 0.08, 1.375)) for x in (-0.9, 0.9)],
            (-1.5, 3.4, DECK),
            colour=OAK,
        ),
    )


def _behind():
    struts = [
        tube("Strut", [(1.1 * x, 1.1 * y, -0.1), (0.8 * x, 0.8 * y, 5)], 0.14, (-8, 10.5, 0), colour=OAK)
        for x in (-1, 1)
        for y in (-1, 1)
    ]
    tank = cylinder("Tank", 1.6, 2.4, (-8, 10.5, 6.2), colour=(0.4, 0.22, 0.12))
    joined("Water tower", tank, cylinder("Cap", 1.9, 1.0, (-8, 10.5, 7.9), top=0.1, colour=SNOW), *struts)
    _footbridge((3, 11.5, 0))
    mast = cylinder("Mast", 0.1, 6.3, (-18.5, 8.6, 3.05), colour=(0.9, 0.9, 0.88))
    arm = boxes("Arm", [((1.6, 0.06, 0.3), (0.75, -0.13, 5.7))], (-18.5, 8.6, 0), colour=(0.75, 0.06, 0.05))
    joined("Signal mast", mast, arm)
    for number, (x, y) in enumerate(FIRS):
        size = 1 + 0.15 * (number * 3 % 4)
        trunk = cylinder("Trunk", 0.25 * size, 1.4 * size, (x, y, 0.6 * size), colour=(0.25, 0.15, 0.08))
        tiers = [
            cylinder(
                "Tier",
                (1.7 - 0.4 * tier) * size,
                2.2 * size,
                (x, y, (2.0 + 1.4 * tier) * size),
                top=0,
                sides=10,
                colour=(0.05, 0.2, 0.1),
            )
            for tier in range(3)
        ]
        joined("Fir tree", trunk, *tiers)
    peaks = [((-34, 95), 46, 38), ((4, 105), 60, 58), ((46, 98), 48, 44)]
    rocks = [
        cylinder(
            "Rock", base, high, (x, y, high / 2 - 1), top=0, sides=9, colour=(0.36, 0.36, 0.4), roughness=1
        )
        for (x, y), base, high in peaks
    ]
    caps = [
        cylinder("Cap", 0.403 * base, 0.4 * high, (x, y, 0.8 * high - 0.9), top=0, sides=9, colour=SNOW)
        for (x, y), base, high in peaks
    ]
    joined("Rocky mountain", *rocks, *caps)


def _footbridge(at):
    iron = {"colour": (0.2, 0.24, 0.28), "metal": 0.6}
    towers = [((0.25, 0.25, 4.7), (x, y, 2.25)) for x in (-4.5, -3.5, 3.5, 4.5) for y in (-0.8, 0.8)]
    deck = [((9.6, 1.9, 0.2), (0, 0, 4.5)), *(((9.6, 0.08, 0.12), (0, y, 5.6)) for y in (-0.9, 0.9))]
    posts = [((0.08, 0.08, 1.1), (0.8 * step, y, 5.1)) for step in range(-6, 7) for y in (-0.9, 0.9)]
    frame = boxes("Frame", [*towers, *deck, *posts], at, **iron)
    lattice = [
        tube("Lattice", [(0.8 * step, y, 4.6), (0.8 * (step + 1), y, 5.6)], 0.035, at, sides=6, **iron)
        for step in range(-6, 6)
        for y in (-0.9, 0.9)
    ]
    arch = [
        tube(
            "Arch",
            [(0.35 * step, y, 4.4 - 0.012 * step * step) for step in range(-10, 11)],
            0.1,
            at,
            sides=8,
            **iron,
        )
        for y in (-0.8, 0.8)
    ]
    joined("Iron footbridge", frame, *lattice, *arch)
