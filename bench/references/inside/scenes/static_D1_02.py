# SPDX-License-Identifier: GPL-3.0-or-later
"""A country kitchen, seen from where its fourth wall would be."""

import math
from itertools import product

from ..props import ball, box, boxes, cylinder, joined, legs, prism, revolved, tube
from ..round_shapes import arch, around
from ..scene_setup import begin, camera, light

OAK, PINE, LIME = (
    {"colour": (0.4, 0.25, 0.12)},
    {"colour": (0.75, 0.55, 0.33)},
    {"colour": (0.85, 0.83, 0.75)},
)
IRON, ENAMEL = {"colour": (0.07, 0.07, 0.08)}, {"colour": (0.9, 0.9, 0.87), "roughness": 0.2}
COPPER = {"colour": (0.72, 0.35, 0.18), "metal": 1.0, "roughness": 0.3}
PEWTER, STRAW = {"colour": (0.5, 0.5, 0.53), "metal": 1.0}, {"colour": (0.8, 0.65, 0.3)}
TOP = 0.76  # of the table
PLATE = [(0, 0), (0.06, 0), (0.1, 0.015), (0.1, 0.02), (0.06, 0.006), (0, 0.006)]
BOWL = [(0, 0), (0.1, 0), (0.19, 0.09), (0.2, 0.12), (0.185, 0.12), (0.13, 0.015), (0, 0.015)]
JUG = [(0, 0), (0.06, 0), (0.075, 0.08), (0.05, 0.17), (0.06, 0.2)]
JUG += [(0.05, 0.2), (0.04, 0.17), (0.065, 0.08), (0.05, 0.01), (0, 0.01)]


def build():
    """Builds the scene."""
    begin(1)
    _room()
    _stove((-1.3, 1.68, 0))
    _kettle((-1.5, 1.65, 0.9))
    _hood((-1.3, 1.7, 1.6))
    _dresser((0.55, 1.76, 0))
    slab = ((1.6, 0.8, 0.04), (0, 0, TOP - 0.02))
    boxes("Pine table", [*legs(0.72, 0.32, TOP - 0.04, 0.08), slab], (0.2, -0.4, 0), **PINE)
    _bread()
    _honey((0.3, -0.2, TOP))
    _jug((0.05, -0.2, TOP))
    _lemons((0.65, -0.4, TOP))
    for x, y, turn in ((-0.3, -1.05, 180), (0.4, 0.25, 0), (-0.85, -0.4, 90), (1.25, -0.4, -90)):
        _chair((x, y, 0), turn)
    shade = [(0, 0.8), (0.01, 0.8), (0.01, 0.2), (0.2, 0), (0.19, 0), (0, 0.19)]
    revolved("Pendant lamp", shade, (0.2, -0.4, 1.7), colour=(0.1, 0.25, 0.2))
    _broom()
    camera((0.9, -5.2, 2.1), (-0.1, 0.5, 1.05), lens=27)
    light(sun=3, elevation=32, azimuth=-25, sky=(0.8, 0.85, 0.9))


def _room():
    box("Terracotta floor", (5.2, 4.4, 0.1), (0, -0.2, -0.05), colour=(0.6, 0.28, 0.17))
    box("Tiled wall", (5.2, 0.1, 2.5), (0, 2.05, 1.25), **LIME)
    box("Side wall", (0.1, 4.4, 2.5), (-2.65, -0.2, 1.25), **LIME)
    beams = [((0.14, 4.4, 0.18), (x, -0.2, 2.41)) for x in (-2, -0.7, 0.7, 2)]
    boxes("Beamed ceiling", [((5.2, 4.4, 0.1), (0, -0.2, 2.55)), *beams], **OAK)


def _stove(at):
    x, y, _ = at
    body = boxes("Body", [*legs(0.4, 0.25, 0.12), ((0.9, 0.6, 0.73), (0, 0, 0.485))], at, **IRON)
    hob = box("Hob", (0.96, 0.64, 0.05), (x, y - 0.01, 0.875), metal=1.0, **IRON)
    doors = [((0.38, 0.02, 0.4), (side, -0.31, 0.5)) for side in (-0.21, 0.21)]
    joined("Cast-iron stove", body, hob, boxes("Doors", doors, at, colour=(0.15, 0.15, 0.16)))


def _kettle(at):
    belly = [(0, 0), (0.11, 0), (0.12, 0.06), (0.06, 0.14), (0.015, 0.15), (0.015, 0.18), (0, 0.18)]
    spout = tube("Spout", [(0.1, 0, 0.05), (0.16, 0, 0.09), (0.19, 0, 0.14)], 0.016, at, **COPPER)
    handle = tube("Handle", [(x, 0, z + 0.11) for x, z in arch(0.2, 0.14)], 0.008, at, **COPPER)
    joined("Copper kettle", revolved("Belly", belly, at, **COPPER), spout, handle)


def _hood(at):
    x, _, _ = at
    outline = [(-0.5, 0), (0.5, 0), (0.5, 0.08), (0.18, 0.4), (-0.18, 0.4), (-0.5, 0.08)]
    flue = box("Flue", (0.26, 0.26, 0.5), (x, 1.84, 2.25), **ENAMEL)
    joined("Cooker hood", prism("Hood", outline, 0.6, at, **ENAMEL), flue)


def _dresser(at):
    x, y, _ = at
    shelves = [((1.3, 0.22, 0.025), (0, 0.1, z)) for z in (1.2, 1.6, 2.0)]
    sides = [((0.03, 0.22, 1.2), (side, 0.1, 1.45)) for side in (-0.635, 0.635)]
    back, base, top = (1.3, 0.02, 1.2), (1.3, 0.45, 0.82), (1.36, 0.48, 0.04)
    body = [(back, (0, 0.21, 1.45)), (base, (0, 0, 0.41)), (top, (0, 0, 0.84))]
    boxes("Oak dresser", [*shelves, *sides, *body], at, **OAK)
    for z, aside in product((0.86, 1.2125), (-0.35, 0, 0.35)):  # standing on their rims, against the back
        place = (x + aside, y + 0.195, z + 0.1)
        plate = revolved("China plate", PLATE, place, colour=(0.15, 0.3, 0.65), roughness=0.2)
        plate.rotation_euler = (math.pi / 2, 0, 0)


def _bread():
    box("Bread board", (0.45, 0.28, 0.02), (-0.2, -0.5, TOP + 0.01), **OAK)
    prism("Loaf of bread", arch(0.32, 0.11), 0.13, (-0.2, -0.5, TOP + 0.02), colour=(0.6, 0.35, 0.13))
    blade = box("Blade", (0.22, 0.03, 0.004), (0.22, -0.68, TOP + 0.005), **PEWTER)
    joined("Bread knife", blade, box("Handle", (0.12, 0.025, 0.01), (0.39, -0.68, TOP + 0.005), **OAK))


def _honey(at):
    x, y, z = at
    glass = [(0, 0), (0.045, 0), (0.045, 0.09), (0.035, 0.1), (0, 0.1)]
    jar = revolved("Jar", glass, at, colour=(0.8, 0.45, 0.05), roughness=0.1, clear=0.5)
    joined("Honey jar", jar, cylinder("Lid", 0.04, 0.015, (x, y, z + 0.1075), **STRAW))


def _jug(at):
    bend = [(0.05, 0, 0.17), (0.11, 0, 0.14), (0.11, 0, 0.08), (0.07, 0, 0.06)]
    joined("Pewter jug", revolved("Belly", JUG, at, **PEWTER), tube("Grip", bend, 0.008, at, **PEWTER))


def _lemons(at):
    x, y, z = at
    revolved("Fruit bowl", BOWL, at, colour=(0.55, 0.6, 0.65))
    for aside, behind in [(0, 0), *around(0.073, 6)]:
        ball("Lemon", 0.036, (x + aside, y + behind, z + 0.052), colour=(0.9, 0.8, 0.1))


def _chair(at, turn):
    back = [((0.04, 0.04, 1.0), (x, 0.19, 0.5)) for x in (-0.19, 0.19)]
    front = [((0.04, 0.04, 0.43), (x, -0.19, 0.215)) for x in (-0.19, 0.19)]
    rungs = [((0.36, 0.02, 0.07), (0, 0.19, z)) for z in (0.62, 0.78, 0.94)]
    seat = ((0.44, 0.42, 0.03), (0, 0, 0.445))
    boxes("Ladder-back chair", [*back, *front, *rungs, seat], at, turn=(0, 0, turn), **OAK)


def _broom():
    lean, wide = math.radians(12), 0.11  # towards the side wall; at its foot
    straw = revolved("Straw", [(0, 0), (wide, 0), (0.03, 0.35), (0, 0.35)], **STRAW)
    broom = joined("Straw broom", straw, cylinder("Stick", 0.014, 1.1, (0, 0, 0.85), **OAK))
    broom.rotation_euler, broom.location = (0, -lean, 0), (-2.29, 0.5, wide * math.sin(lean))
