# SPDX-License-Identifier: GPL-3.0-or-later
"""A fishing harbour with its quay, its houses and its lighthouse, seen from the water."""

import math
from itertools import product

from ..props import box, boxes, cylinder, joined, mesh, prism, revolved, sheet, tube
from ..round_shapes import arch
from ..scene_setup import begin, camera, light

GRANITE, SLATE = {"colour": (0.42, 0.4, 0.38)}, {"colour": (0.16, 0.18, 0.22)}
OAK, WICKER = {"colour": (0.38, 0.24, 0.13)}, {"colour": (0.55, 0.42, 0.25)}
WHITE, TAR, IRON = (
    {"colour": (0.93, 0.92, 0.88)},
    {"colour": (0.07, 0.06, 0.06)},
    {"colour": (0.1, 0.1, 0.11)},
)
PAINTS = [(0.1, 0.25, 0.5), (0.55, 0.1, 0.08), (0.1, 0.4, 0.25)]
PLASTERS = [(0.88, 0.85, 0.78), (0.75, 0.72, 0.68), (0.85, 0.76, 0.62)]
QUAY = 2.0  # above the sea, which is at 0; its edge is at y = 0
# Of a hull, from stern to bow: how far along, half the beam, how high the side, how deep the keel.
STATIONS = [
    (-5, 1.5, 1.3, -0.4),
    (-2, 2, 1.2, -0.8),
    (2, 1.9, 1.4, -0.8),
    (4.5, 1.1, 1.8, -0.6),
    (6, 0.1, 2.2, -0.1),
]


def build():
    """Builds the scene."""
    begin(1)
    sheet("Sea", (300, 300), (1, 1), (0, -40, 0), colour=(0.04, 0.16, 0.22), roughness=0.15)
    box("Granite quay", (70, 20, 5), (-5, 10, QUAY - 2.5), **GRANITE)
    for x, paint in zip((-17, -3, 11), PAINTS, strict=True):
        _trawler((x, -3, 0), paint)
    for x, y in ((-10, 1.2), (-9, 1.5), (-9.6, 2.6)):
        _lobster_pot((x, y, QUAY))
    _rope((-6.5, 1.6, QUAY))
    for at in ((1.5, 1.6, QUAY), (2.8, 1.7, QUAY), (1.6, 2.5, QUAY), (1.5, 1.62, QUAY + 0.4)):
        _crate(at)
    knob = [(0, 0), (0.3, 0), (0.3, 0.06), (0.2, 0.1), (0.17, 0.5), (0.3, 0.58), (0.26, 0.7), (0, 0.74)]
    for x in (-13, 5):
        revolved("Iron bollard", knob, (x, 0.7, QUAY), **IRON)
    for number, x in enumerate((-20, -11, -2, 7, 16)):
        _house((x, 14, QUAY), number)
    _lighthouse(27, -13)
    _crane((-7.5, 1.2, QUAY))
    _lamp((8, 0.8, QUAY))
    _stairs()
    camera((-16, -38, 12), (5, -2, 3.5), lens=25)
    light(sun=3.5, elevation=12, azimuth=-55, sky=(0.75, 0.6, 0.5), colour=(1, 0.75, 0.45))


def _trawler(at, paint):
    points = [
        point
        for x, half, high, deep in STATIONS
        for point in ((x, -half, high), (x, 0, deep), (x, half, high))
    ]
    faces = [(0, 1, 2), (12, 14, 13)]  # the stern, the bow
    for left in range(0, 12, 3):
        keel, right = left + 1, left + 2
        faces += [(a, a + 3, b + 3, b) for a, b in ((left, keel), (keel, right), (right, left))]
    hull = mesh("Hull", points, faces, at, colour=paint)
    cabin = boxes("Cabin", [((2.2, 2, 2.2), (-2.6, 0, 2.3)), ((2.6, 2.3, 0.15), (-2.6, 0, 3.4))], at, **WHITE)
    panes = boxes(
        "Panes", [((2.24, 1.5, 0.6), (-2.6, 0, 2.8)), ((1.5, 2.04, 0.6), (-2.6, 0, 2.8))], at, **SLATE
    )
    mast = tube("Mast", [(1, 0, 1), (1, 0, 7.5)], 0.09, at, **OAK)
    boom = tube("Boom", [(1, 0, 2.6), (-2.2, 0, 5.2)], 0.07, at, **OAK)
    stay = tube("Stay", [(1, 0, 7.4), (5.8, 0, 2.2)], 0.02, at, sides=6, **TAR)
    joined("Wooden trawler", hull, cabin, panes, mast, boom, stay)


def _lobster_pot(at):
    x, y, z = at
    cage = prism("Cage", arch(0.7, 0.5), 0.9, at, **WICKER)
    bands = [prism("Band", arch(0.74, 0.53), 0.06, (x, y + aside, z), **TAR) for aside in (-0.4, 0, 0.4)]
    joined("Lobster pot", cage, *bands)


def _rope(at):
    """Four turns, one on the other, each a little wider or narrower than the last."""
    line = []
    for step in range(51):
        turn = 0.5 * step
        out = 0.35 + 0.01 * math.sin(3 * turn)
        line.append((out * math.cos(turn), out * math.sin(turn), 0.05 + 0.0155 * turn))
    tube("Coil of rope", line, 0.05, at, sides=8, **WICKER)


def _crate(at):
    long = [((1, 0.05, 0.4), (0, y, 0.2)) for y in (-0.3, 0.3)]
    short = [((0.05, 0.65, 0.4), (x, 0, 0.2)) for x in (-0.5, 0.5)]
    boxes("Fish crate", [*long, *short, ((1, 0.6, 0.05), (0, 0, 0.025))], at, **WICKER)


def _house(at, number):
    x, y, z = at
    tall, wide = 5.5 + (number * 3 % 4) * 0.6, 7.0
    plaster, paint = {"colour": PLASTERS[number % 3]}, {"colour": PAINTS[number % 3]}
    gable = [(-3, 0), (3, 0), (3, tall), (0, tall + 2.6), (-3, tall)]
    walls = prism("Walls", gable, wide, at, turn=(0, 0, 90), **plaster)
    low, high = (
        [(-3.4, tall - 0.3), (0, tall + 2.65), (3.4, tall - 0.3)],
        [(3.4, tall - 0.05), (0, tall + 2.9), (-3.4, tall - 0.05)],
    )
    roof = prism("Slates", [*low, *high], wide + 0.3, at, turn=(0, 0, 90), **SLATE)
    windows = [((1, 0.1, 1.3), (across, -3.02, up)) for across, up in product((-2.2, 2.2), (1.7, tall - 1.1))]
    openings = boxes("Openings", [*windows, ((1.1, 0.1, 2.2), (0, -3.02, 1.1))], at, **paint)
    chimney = box("Chimney", (0.8, 0.8, 2), (x + 2.5, y, z + tall + 2.8), **plaster)
    joined("House", walls, roof, openings, chimney)


def _lighthouse(x, y):
    box("Breakwater", (6, 18, 5), (x, -9, QUAY - 2.5), **GRANITE)
    tower = [(0, 0), (2.2, 0), (2.2, 0.6), (1.8, 0.8), (1.2, 10), (1.7, 10.3), (1.7, 10.6), (0, 10.6)]
    revolved("White lighthouse", tower, (x, y, QUAY), **WHITE)
    room = [(0, 0), (1, 0), (1, 0.7), (0.9, 0.7), (0.9, 2), (1.15, 2), (0.6, 2.9), (0.1, 3.2), (0, 3.4)]
    revolved("Red lantern room", room, (x, y, QUAY + 10.6), colour=(0.7, 0.05, 0.04))


def _crane(at):
    timber = [
        ((0.4, 0.4, 5.5), (0, 0, 2.75)),
        ((2.2, 0.35, 0.3), (0, 0, 0.15)),
        ((0.35, 1.8, 0.3), (0, 0.2, 0.15)),
    ]
    jib = tube("Jib", [(0, 0, 2.6), (0, -3.4, 6.2)], 0.16, at, sides=8, **OAK)
    rope = tube("Rope", [(0, 0, 5.4), (0, -3.4, 6.2), (0, -3.4, 3.6)], 0.03, at, sides=6, **TAR)
    bend = [(0, -3.4, 3.6), (0.12, -3.4, 3.4), (0, -3.4, 3.25), (-0.12, -3.4, 3.35)]
    joined(
        "Timber crane",
        boxes("Post", timber, at, **OAK),
        jib,
        rope,
        tube("Hook", bend, 0.04, at, sides=8, **TAR),
    )


def _lamp(at):
    x, y, z = at
    post = [(0, 0), (0.22, 0), (0.2, 0.4), (0.07, 0.6), (0.06, 3.4), (0.2, 3.5), (0, 3.5)]
    glass = cylinder("Glass", 0.17, 0.5, (x, y, z + 3.75), top=0.26, sides=6, colour=(1, 0.85, 0.5), glow=2)
    hat = cylinder("Hat", 0.34, 0.25, (x, y, z + 4.125), top=0.03, sides=6, **IRON)
    joined("Street lamp", revolved("Post", post, at, sides=16, **IRON), glass, hat)


def _stairs():
    """From the quay down into the sea, towards +x."""
    steps, rise, tread = 10, 0.25, 0.35
    outline = [(0, -1), (steps * tread, -1)]
    for step in range(steps):
        out, up = (steps - step) * tread, -0.5 + step * rise
        outline += [(out, up), (out, up + rise)]
    prism("Stone stairway", [*outline, (0, QUAY)], 1.6, (20, -0.8, 0), **GRANITE)
