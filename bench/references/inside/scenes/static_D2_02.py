# SPDX-License-Identifier: GPL-3.0-or-later
"""A narrow-gauge railway halt in the Alps in winter: the train before its platform, the mountain behind."""

from itertools import product

from ..props import ball, box, boxes, cylinder, joined, prism, revolved, sheet, tube
from ..round_shapes import arch
from ..scene_setup import begin, camera, light

SNOW, OAK, LARCH = (
    {"colour": (0.93, 0.95, 0.98)},
    {"colour": (0.42, 0.26, 0.13)},
    {"colour": (0.5, 0.28, 0.12)},
)
GREEN, RED, BLACK = (
    {"colour": (0.04, 0.28, 0.12)},
    {"colour": (0.55, 0.08, 0.06)},
    {"colour": (0.02, 0.02, 0.02)},
)
IRON, BRASS = {"colour": (0.08, 0.08, 0.09), "metal": 0.7}, {"colour": (0.75, 0.55, 0.2), "metal": 1.0}
RAIL, DECK, GAUGE = 0.24, 0.7, 0.38  # heights of the rails' and the platform's tops; half the gauge
FIRS = [(-24, 16), (-19, 22), (-14, 13), (-3, 19), (4, 17), (11, 20), (19, 13), (25, 19)]
PEAKS = [((-34, 95), 46, 38), ((4, 105), 60, 58), ((46, 98), 48, 44)]  # place, radius, height


def build():
    """Builds the scene."""
    begin(1)
    sheet("Snow", (240, 240), (1, 1), (0, 60, 0), **SNOW)
    ties = boxes(
        "Sleepers", [((0.25, 1.3, 0.12), (0.7 * number, 0, 0.06)) for number in range(-45, 46)], **OAK
    )
    lines = [((63.5, 0.06, 0.12), (0, y, 0.18)) for y in (-GAUGE, GAUGE)]
    joined("Steel rails", boxes("Rails", lines, colour=(0.5, 0.5, 0.52), metal=1.0), ties)
    stone = box("Stone", (42, 5.6, DECK - 0.08), (0, 4.3, (DECK - 0.08) / 2), colour=(0.4, 0.38, 0.37))
    joined("Platform", stone, box("Cover", (42, 5.6, 0.08), (0, 4.3, DECK - 0.04), **SNOW))
    _locomotive()
    _tender()
    for x in (-9.0, -15.6):
        _carriage(x)
    _station((10, 5.2, DECK))
    _furniture()
    _behind()
    camera((8, -15.5, 6.6), (0.5, 4, 2.6), lens=24)
    light(sun=3, elevation=28, azimuth=40, sky=(0.45, 0.62, 0.9), colour=(1, 0.93, 0.8))


def _wheels(places, radius):
    """Wheels on both rails at these places along the track."""
    spots = [(x, y, RAIL + radius) for x, y in product(places, (-GAUGE, GAUGE))]
    return [cylinder("Wheel", radius, 0.08, spot, turn=(90, 0, 0), sides=24, **IRON) for spot in spots]


def _locomotive():
    boiler = cylinder("Boiler", 0.62, 3.6, (1.0, 0, 1.75), turn=(0, 90, 0), **GREEN)
    posts = [((0.12, 0.12, 0.85), (-1.4 + x, y, 2.4)) for x, y in product((-0.65, 0.65), (-0.79, 0.79))]
    cab = boxes(
        "Cab", [((1.5, 1.7, 1.2), (-1.4, 0, 1.4)), *posts, ((1.8, 1.9, 0.12), (-1.4, 0, 2.86))], **GREEN
    )
    frame = boxes("Frame", [((5.4, 1.1, 0.25), (0.3, 0, 0.95)), ((0.2, 1.7, 0.35), (3.0, 0, 0.9))], **RED)
    stack = revolved("Chimney", [(0, 0), (0.2, 0), (0.17, 0.6), (0.27, 0.9), (0, 0.9)], (2.3, 0, 2.3), **IRON)
    swell = [(0, 0), (0.28, 0), (0.26, 0.3), (0.1, 0.45), (0, 0.47)]
    dome = revolved("Dome", swell, (0.8, 0, 2.3), **BRASS)
    lantern = cylinder("Lantern", 0.16, 0.2, (2.9, 0, 2.05), turn=(0, 90, 0), colour=(1, 0.9, 0.6), glow=1)
    rods = [((2.4, 0.06, 0.1), (0.6, y, RAIL + 0.42)) for y in (-GAUGE - 0.07, GAUGE + 0.07)]
    wheels = _wheels((-0.6, 0.6, 1.8), 0.42)
    joined(
        "Green steam locomotive",
        boiler,
        cab,
        frame,
        stack,
        dome,
        lantern,
        boxes("Rods", rods, **IRON),
        *wheels,
    )


def _tender():
    bunker = boxes("Bunker", [((2.2, 1.6, 0.9), (-4, 0, 1.5)), ((2.4, 1.1, 0.2), (-4, 0, 0.95))], **GREEN)
    heap = [(-4.7 + 0.45 * lump, 0.35 * (-1) ** lump, 1.95) for lump in range(4)]
    coal = [ball("Coal", 0.3, place, detail=1, **BLACK) for place in heap]
    joined("Coal tender", bunker, *coal, *_wheels((-4.7, -3.3), 0.34))


def _carriage(x):
    posts = [((0.25, 1.8, 0.65), (x + 0.925 * number, 0, 2.42)) for number in range(-3, 4)]
    walls = boxes(
        "Walls", [((5.8, 1.8, 1.0), (x, 0, 1.6)), *posts, ((5.8, 1.8, 0.25), (x, 0, 2.85))], **LARCH
    )
    panes = box("Panes", (5.6, 1.7, 0.65), (x, 0, 2.42), colour=(0.12, 0.16, 0.2), roughness=0.1)
    roof = prism("Roof", arch(2.0, 0.3), 6.2, (x, 0, 2.97), turn=(0, 0, 90), **SNOW)
    wheels = _wheels((x - 2.2, x + 2.2), 0.34)
    joined("Wooden carriage", walls, panes, roof, box("Floor", (6, 1.7, 0.2), (x, 0, 1.0), **BLACK), *wheels)


def _station(at):
    x, _, _ = at
    walls = prism("Walls", [(-3, 0), (3, 0), (3, 2.6), (0, 4.8), (-3, 2.6)], 3.6, at, **LARCH)
    slope = [(-3.5, 2.23), (0, 4.8), (3.5, 2.23), (3.5, 2.5), (0, 5.07), (-3.5, 2.5)]
    panes = [((0.9, 0.06, 1.0), (side, -1.82, 1.5)) for side in (-1.8, 1.8)]
    lit = boxes("Panes", panes, at, colour=(0.95, 0.8, 0.5), glow=0.4)
    door = box("Door", (1.1, 0.08, 2.1), (x, 3.38, DECK + 1.05), **GREEN)
    joined("Timber station building", walls, prism("Roof", slope, 4.4, at, **SNOW), lit, door)
    case = cylinder("Case", 0.3, 0.1, (x, 3.35, DECK + 2.9), turn=(90, 0, 0), **BLACK)
    face = cylinder("Face", 0.26, 0.02, (x, 3.29, DECK + 2.9), turn=(90, 0, 0), **SNOW)
    pointers = [((0.03, 0.01, 0.22), (0, 0, 0.1)), ((0.15, 0.01, 0.03), (0.07, 0, 0))]
    joined("Station clock", case, face, boxes("Hands", pointers, (x, 3.275, DECK + 2.9), **BLACK))


def _furniture():
    slats = [((1.8, 0.12, 0.04), (0, y, 0.45)) for y in (-0.15, 0, 0.15)]
    back = [((1.8, 0.04, 0.12), (0, 0.22, z)) for z in (0.65, 0.85)]
    ends = [((0.08, 0.45, 0.43), (x, 0, 0.215)) for x in (-0.75, 0.75)]
    stays = [((0.08, 0.05, 0.5), (x, 0.245, 0.66)) for x in (-0.75, 0.75)]
    boxes("Bench", [*slats, *back, *ends, *stays], (5, 3, DECK), **OAK)
    for x, y, wide in ((6.7, 2.5, 0.8), (7.5, 2.7, 0.65), (7.1, 3.2, 0.95)):
        case = box("Case", (wide, 0.24, 0.6 * wide), (x, y, DECK + 0.3 * wide), colour=(0.4, 0.2, 0.08))
        grip = [(-0.12, 0, 0), (-0.1, 0, 0.07), (0.1, 0, 0.07), (0.12, 0, 0)]
        joined("Leather suitcase", case, tube("Grip", grip, 0.018, (x, y, DECK + 0.6 * wide), **BLACK))
    bed = boxes(
        "Bed", [((1.5, 0.8, 0.06), (0, 0, 0.4)), ((0.05, 0.8, 0.7), (-0.72, 0, 0.75))], (2.2, 3, DECK), **OAK
    )
    spots = [(2.2 + x, 3 + y, DECK + 0.19) for x, y in product((-0.5, 0.5), (-0.3, 0.3))]
    rollers = [cylinder("Roller", 0.19, 0.08, spot, turn=(90, 0, 0), **IRON) for spot in spots]
    joined("Luggage trolley", bed, *rollers)
    board = box("Board", (2.4, 0.08, 0.6), (-1.5, 3.4, DECK + 2.4), colour=(0.1, 0.2, 0.45))
    posts = [((0.1, 0.1, 2.75), (x, 0.08, 1.375)) for x in (-0.9, 0.9)]
    joined("Signpost", board, boxes("Posts", posts, (-1.5, 3.4, DECK), **OAK))


def _behind():
    ways = [[(1.1 * x, 1.1 * y, -0.1), (0.8 * x, 0.8 * y, 5)] for x, y in product((-1, 1), (-1, 1))]
    struts = [tube("Strut", way, 0.14, (-8, 10.5, 0), **OAK) for way in ways]
    tank = cylinder("Tank", 1.6, 2.4, (-8, 10.5, 6.2), **LARCH)
    joined("Water tower", tank, cylinder("Cap", 1.9, 1.0, (-8, 10.5, 7.9), top=0.1, **SNOW), *struts)
    _footbridge((3, 11.5, 0))
    mast = cylinder("Mast", 0.1, 6.3, (-18.5, 8.6, 3.05), **SNOW)
    joined("Signal mast", mast, box("Arm", (1.6, 0.06, 0.3), (-17.75, 8.47, 5.7), **RED))
    for number, (x, y) in enumerate(FIRS):
        _fir(x, y, 1 + 0.15 * (number * 3 % 4))
    stone = {"colour": (0.36, 0.36, 0.4), "roughness": 1}
    rocks = [
        cylinder("Rock", wide, high, (*at, high / 2 - 1), top=0, sides=9, **stone) for at, wide, high in PEAKS
    ]
    # Snow from three fifths of the height up, a hand's breadth over the rock.
    caps = [
        cylinder("Cap", 0.403 * wide, 0.4 * high, (*at, 0.8 * high - 0.9), top=0, sides=9, **SNOW)
        for at, wide, high in PEAKS
    ]
    joined("Rocky mountain", *rocks, *caps)


def _fir(x, y, size):
    trunk = cylinder("Trunk", 0.25 * size, 1.4 * size, (x, y, 0.6 * size), **OAK)
    tiers = [(1.7 - 0.4 * tier, 2.0 + 1.4 * tier) for tier in range(3)]  # how wide, how high its middle
    cones = [
        cylinder("Tier", wide * size, 2.2 * size, (x, y, middle * size), top=0, sides=10, **GREEN)
        for wide, middle in tiers
    ]
    joined("Fir tree", trunk, *cones)


def _footbridge(at):
    iron, sides = {"colour": (0.2, 0.24, 0.28), "metal": 0.6}, (-0.9, 0.9)
    towers = [((0.25, 0.25, 4.7), (x, y, 2.25)) for x, y in product((-4.5, -3.5, 3.5, 4.5), (-0.8, 0.8))]
    deck = [((9.6, 1.9, 0.2), (0, 0, 4.5)), *(((9.6, 0.08, 0.12), (0, y, 5.6)) for y in sides)]
    posts = [((0.08, 0.08, 1.1), (0.8 * number, y, 5.1)) for number, y in product(range(-6, 7), sides)]
    frame = boxes("Frame", [*towers, *deck, *posts], at, **iron)
    slants = [[(0.8 * one, y, 4.6), (0.8 * (one + 1), y, 5.6)] for one, y in product(range(-6, 6), sides)]
    bows = [[(x, y, z + 3.2) for x, z in arch(7.0, 1.2)] for y in (-0.8, 0.8)]
    ribs = [tube("Rib", way, 0.05, at, sides=8, **iron) for way in (*slants, *bows)]
    joined("Iron footbridge", frame, *ribs)
