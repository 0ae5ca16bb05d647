# SPDX-License-Identifier: GPL-3.0-or-later
"""A watchmaker's attic workshop by the light of a desk lamp."""

import math

from ..props import ball, box, boxes, cylinder, joined, legs, prism, revolved, tube
from ..round_shapes import around, ring
from ..scene_setup import begin, camera, lamp, light

WALNUT, OAK, CREAM = (
    {"colour": (0.25, 0.14, 0.07)},
    {"colour": (0.42, 0.27, 0.13)},
    {"colour": (0.9, 0.87, 0.78)},
)
BRASS = {"colour": (0.75, 0.55, 0.2), "metal": 1.0, "roughness": 0.3}
STEEL = {"colour": (0.5, 0.52, 0.55), "metal": 1.0, "roughness": 0.4}
IRON, BLACK = {"colour": (0.12, 0.12, 0.13), "metal": 0.8}, {"colour": (0.02, 0.02, 0.02)}
TOP = 0.85  # of the workbench
WALL = 1.5  # where the wall's face is
FRONT, SIDE = (90, 0, 0), (0, 90, 0)  # how a cylinder is turned to face the camera, or to lie along x


def build():
    """Builds the scene."""
    begin(1)
    box("Plank floor", (4.6, 3.4, 0.1), (0, -0.2, -0.05), colour=(0.38, 0.25, 0.14))
    box("Brick wall", (4.6, 0.12, 2.7), (0, WALL + 0.06, 1.35), colour=(0.5, 0.24, 0.16), roughness=0.9)
    _window((0, WALL - 0.03, 1.95))
    top, apron = ((1.8, 0.75, 0.06), (0, 0, TOP - 0.03)), ((1.7, 0.03, 0.14), (0, -0.3, TOP - 0.13))
    boxes("Walnut workbench", [*legs(0.82, 0.3, TOP - 0.06, 0.08), top, apron], (0, 1.1, 0), **WALNUT)
    _desk_lamp((-0.62, 1.25, TOP))
    _vice(0.72, 0.88)
    _magnifier(0.4, 0.9)
    _anvil((0.55, 1.22, TOP))
    _ledger((0.1, 1.25, TOP))
    _tray(-0.15, 0.92)
    _stool((0.15, 0.35, 0))
    _longcase(-1.5, 1.3)
    _pegboard(1.05)
    _cuckoo(1.75)
    _safe((1.35, 1.15, 0))
    _cat((1.35, 1.15, 0.73))
    wound = [(0.006 * turn, turn) for turn in [0.4 * step for step in range(10, 80)]]
    spiral = [(out * math.cos(turn), out * math.sin(turn), 0.018) for out, turn in wound]
    tube("Coiled hemp rope", spiral, 0.018, (1.3, 0.45, 0), colour=(0.62, 0.5, 0.32))
    camera((0.3, -3.9, 2.0), (0, 0.9, 1.05), lens=28)
    light(sun=0.4, elevation=35, azimuth=20, sky=(0.16, 0.18, 0.26), colour=(0.7, 0.8, 1))


def _window(at):
    frame = ring("Frame", 0.4, 0.04, at, **CREAM)
    pane = cylinder("Pane", 0.39, 0.02, at, colour=(0.12, 0.16, 0.35), roughness=0.1)
    bars = boxes("Bars", [((0.76, 0.03, 0.04), (0, 0, 0)), ((0.03, 0.76, 0.04), (0, 0, 0))], at, **CREAM)
    joined("Round dormer window", frame, pane, bars).rotation_euler = (math.pi / 2, 0, 0)


def _desk_lamp(at):
    x, y, z = at
    foot = revolved("Foot", [(0, 0), (0.09, 0), (0.08, 0.02), (0.015, 0.03), (0, 0.03)], at, **BRASS)
    arm = tube("Arm", [(0, 0, 0.02), (0, 0, 0.3), (0.08, -0.05, 0.42), (0.16, -0.1, 0.42)], 0.01, at, **BRASS)
    cone = [(0, 0.1), (0.03, 0.1), (0.1, 0), (0.09, 0), (0, 0.085)]
    joined("Brass desk lamp", foot, arm, revolved("Shade", cone, (x + 0.17, y - 0.1, z + 0.34), **BRASS))
    lamp("Bulb", 25, (x + 0.17, y - 0.1, z + 0.33), colour=(1, 0.75, 0.45), size=0.03)


def _vice(x, y):
    back = [((0.1, 0.12, 0.08), (0, 0.05, 0.04)), ((0.14, 0.04, 0.07), (0, 0, 0.115))]
    front = [((0.1, 0.04, 0.08), (0, -0.07, 0.06)), ((0.14, 0.04, 0.07), (0, -0.07, 0.115))]
    screw = cylinder("Screw", 0.014, 0.12, (x, y - 0.14, TOP + 0.08), turn=FRONT, **STEEL)
    lever = cylinder("Lever", 0.008, 0.16, (x, y - 0.2, TOP + 0.08), turn=SIDE, **STEEL)
    joined("Steel vice", boxes("Jaws", [*back, *front], (x, y, TOP), **STEEL), screw, lever)


def _magnifier(x, y):
    rim = ring("Rim", 0.05, 0.006, (x, y, TOP + 0.006), **BRASS)
    lens = cylinder(
        "Lens", 0.047, 0.006, (x, y, TOP + 0.006), colour=(0.8, 0.9, 0.95), roughness=0.05, clear=0.9
    )
    grip = cylinder("Grip", 0.008, 0.11, (x + 0.1, y, TOP + 0.008), turn=SIDE, **OAK)
    joined("Magnifying glass", rim, lens, grip)


def _anvil(at):
    x, y, z = at
    foot, waist, face = (
        ((0.14, 0.09, 0.03), (0, 0, 0.015)),
        ((0.06, 0.05, 0.05), (0, 0, 0.055)),
        ((0.14, 0.07, 0.045), (0, 0, 0.1)),
    )
    horn = cylinder("Horn", 0.022, 0.09, (x + 0.115, y, z + 0.1), turn=SIDE, top=0.004, **IRON)
    joined("Small anvil", boxes("Block", [foot, waist, face], at, **IRON), horn)


def _ledger(at):
    x, y, z = at
    covers = [((0.24, 0.32, 0.006), (0, 0, up)) for up in (0.003, 0.049)]
    leather = boxes(
        "Cover", [*covers, ((0.006, 0.32, 0.052), (-0.12, 0, 0.026))], at, colour=(0.3, 0.1, 0.06)
    )
    joined("Leather-bound ledger", leather, box("Pages", (0.225, 0.3, 0.04), (x, y, z + 0.026), **CREAM))


def _tray(x, y):
    long = [((0.4, 0.01, 0.03), (0, side, 0.015)) for side in (-0.125, 0.125)]
    short = [((0.01, 0.26, 0.03), (side, 0, 0.015)) for side in (-0.195, 0.195)]
    boxes("Wooden tray", [((0.4, 0.26, 0.008), (0, 0, 0.004)), *long, *short], (x, y, TOP), **OAK)
    for right, back in ((-0.1, 0.05), (0.08, 0.06), (-0.07, -0.06), (0.1, -0.05)):
        at = (x + right, y + back, TOP + 0.014)
        dial = cylinder("Dial", 0.027, 0.002, (x + right, y + back, TOP + 0.021), **CREAM)
        crown = cylinder(
            "Crown", 0.006, 0.014, (x + right, y + back + 0.038, TOP + 0.014), turn=FRONT, **BRASS
        )
        joined("Pocket watch", cylinder("Case", 0.032, 0.012, at, **BRASS), dial, crown)


def _stool(at):
    x, y, z = at
    ways = [[(*low, 0.02), (*high, 0.52)] for low, high in zip(around(0.17, 3), around(0.09, 3), strict=True)]
    feet = [tube("Leg", way, 0.018, at, **OAK) for way in ways]
    joined("Three-legged stool", cylinder("Seat", 0.18, 0.04, (x, y, z + 0.53), **OAK), *feet)


def _longcase(x, y):
    foot, trunk = ((0.5, 0.3, 0.25), (0, 0, 0.125)), ((0.36, 0.24, 1.1), (0, 0, 0.8))
    hood, crown = ((0.46, 0.28, 0.5), (0, 0, 1.6)), ((0.52, 0.32, 0.05), (0, 0, 1.875))
    case = boxes("Case", [foot, trunk, hood, crown], (x, y, 0), **WALNUT)
    dial = cylinder("Dial", 0.17, 0.02, (x, y - 0.15, 1.62), turn=FRONT, **CREAM)
    pointers = [((0.015, 0.01, 0.14), (0, 0, 0.06)), ((0.1, 0.01, 0.015), (-0.04, 0, 0))]
    joined("Longcase clock", case, dial, boxes("Hands", pointers, (x, y - 0.165, 1.62), **BLACK))


def _cuckoo(x):
    gable = [(-0.14, 0), (0.14, 0), (0.14, 0.24), (0, 0.38), (-0.14, 0.24)]
    house = prism("House", gable, 0.14, (x, WALL - 0.07, 1.75), **OAK)
    face = cylinder("Face", 0.08, 0.02, (x, WALL - 0.15, 1.87), turn=FRONT, **CREAM)
    hung = []
    for aside, low in ((-0.06, 1.45), (0.06, 1.35)):
        place = (x + aside, WALL - 0.07)
        hung.append(cylinder("Weight", 0.022, 0.1, (*place, low), **BRASS))
        hung.append(cylinder("Chain", 0.004, 1.76 - low, (*place, (1.76 + low) / 2), **BRASS))
    joined("Cuckoo clock", house, face, *hung)


def _pegboard(x):
    box("Pegboard", (0.8, 0.02, 0.6), (x, WALL - 0.01, 1.75), colour=(0.7, 0.58, 0.4))
    for aside, size in ((-0.22, 0.8), (0, 1.0), (0.22, 1.2)):
        handle = cylinder("Handle", 0.012, 0.24 * size, (x + aside, WALL - 0.035, 1.75), **OAK)
        head = box("Head", (0.1 * size, 0.028, 0.03), (x + aside, WALL - 0.035, 1.75 + 0.12 * size), **STEEL)
        joined("Hammer", handle, head)


def _safe(at):
    x, y, z = at
    chest, door = ((0.6, 0.55, 0.7), (0, 0, 0.38)), ((0.5, 0.02, 0.58), (0, -0.28, 0.38))
    body = boxes("Body", [chest, door, *legs(0.25, 0.22, 0.03)], at, colour=(0.08, 0.14, 0.12), metal=0.5)
    dial = cylinder("Dial", 0.06, 0.03, (x, y - 0.3, z + 0.42), turn=FRONT, **BRASS)
    joined("Iron safe", body, dial, cylinder("Bolt", 0.01, 0.16, (x + 0.15, y - 0.31, z + 0.42), **BRASS))


def _cat(at):
    x, y, z = at
    glaze = {"colour": (0.75, 0.55, 0.35), "roughness": 0.1}
    trunk = [(0.09, 0, 0.02, 0.085), (0.07, 0, 0, 0.17), (0.06, 0, -0.02, 0.27)]  # radius, place
    paws = [(0.03, side, -0.06, 0.03) for side in (-0.05, 0.05)]
    parts = [ball("Part", radius, (x + a, y + b, z + c), **glaze) for radius, a, b, c in (*trunk, *paws)]
    ears = [
        cylinder("Ear", 0.022, 0.05, (x + side, y - 0.01, z + 0.33), top=0, **glaze)
        for side in (-0.035, 0.035)
    ]
    tail = tube("Tail", [(0.06, 0.06, 0.02), (0.13, 0, 0.02), (0.11, -0.08, 0.02)], 0.018, at, **glaze)
    joined("Porcelain cat", *parts, *ears, tail)
