# SPDX-License-Identifier: GPL-3.0-or-later
"""A watchmaker's attic workshop by the light of a desk lamp."""

import math

from stage import begin, camera, lamp, light
from things import ball, box, boxes, cylinder, joined, legs, prism, revolved, tube

WALNUT, OAK = (0.25, 0.14, 0.07), (0.42, 0.27, 0.13)
BRASS = {"colour": (0.75, 0.55, 0.2), "metal": 1.0, "roughness": 0.3}
STEEL = {"colour": (0.5, 0.52, 0.55), "metal": 1.0, "roughness": 0.4}
TOP = 0.85  # of the workbench
WALL = 1.5  # where the wall's face is


def build():
    """Builds the scene."""
    begin(1)
    box("Plank floor", (4.6, 3.4, 0.1), (0, -0.2, -0.05), colour=(0.38, 0.25, 0.14))
    box("Brick wall", (4.6, 0.12, 2.7), (0, WALL + 0.06, 1.35), colour=(0.5, 0.24, 0.16), roughness=0.9)
    _window()
    bench = [
        *legs(0.82, 0.3, TOP - 0.06, 0.08),
        ((1.8, 0.75, 0.06), (0, 0, TOP - 0.03)),
        ((1.7, 0.03, 0.14), (0, -0.3, TOP - 0.13)),
    ]
    boxes("Walnut workbench", bench, (0, 1.1, 0), colour=WALNUT)
    _tools()
    _tray()
    _stool()
    _clocks()
    _pegboard()
    _safe()
    camera((0.3, -3.9, 2.0), (0, 0.9, 1.05), lens=28)
    light(sun=0.4, elevation=35, azimuth=20, sky=(0.16, 0.18, 0.26), colour=(0.7, 0.8, 1))


def _window():
    turns = [math.pi * side / 4 for side in range(9)]
    ring = [(0.4 + 0.04 * math.cos(turn), 0.04 * math.sin(turn)) for turn in turns]
    at, wood = (0, WALL - 0.03, 1.95), {"colour": (0.8, 0.78, 0.72)}
    frame = revolved("Frame", ring, at, **wood)
    pane = cylinder("Pane", 0.39, 0.02, at, colour=(0.12, 0.16, 0.35), roughness=0.1)
    bars = boxes("Bars", [((0.76, 0.03, 0.04), (0, 0, 0)), ((0.03, 0.76, 0.04), (0, 0, 0))], at, **wood)
    joined("Round dormer window", frame, pane, bars).rotation_euler = (math.pi / 2, 0, 0)


def _tools():
    foot = revolved(
        "Foot", [(0, 0), (0.09, 0), (0.08, 0.02), (0.015, 0.03), (0, 0.03)], (-0.62, 1.25, TOP), **BRASS
    )
    arm = tube(
        "Arm",
        [(0, 0, 0.02), (0, 0, 0.3), (0.08, -0.05, 0.42), (0.16, -0.1, 0.42)],
        0.01,
        (-0.62, 1.25, TOP),
        **BRASS,
    )
    shade = revolved(
        "Shade", [(0, 0.1), (0.03, 0.1), (0.1, 0), (0.09, 0), (0, 0.085)], (-0.45, 1.15, TOP + 0.34), **BRASS
    )
    joined("Brass desk lamp", foot, arm, shade)
    lamp("Bulb", 25, (-0.45, 1.15, TOP + 0.33), colour=(1, 0.75, 0.45), size=0.03)
    jaws = [
        ((0.1, 0.12, 0.08), (0, 0.05, 0.04)),
        ((0.14, 0.04, 0.07), (0, 0, 0.115)),
        ((0.14, 0.04, 0.07), (0, -0.07, 0.115)),
        ((0.1, 0.04, 0.08), (0, -0.07, 0.06)),
    ]
    vice = boxes("Jaws", jaws, (0.72, 0.88, TOP), **STEEL)
    screw = cylinder("Screw", 0.014, 0.12, (0.72, 0.74, TOP + 0.08), turn=(90, 0, 0), **STEEL)
    joined(
        "Steel vice",
        vice,
        screw,
        cylinder("Lever", 0.008, 0.16, (0.72, 0.68, TOP + 0.08), turn=(0, 90, 0), **STEEL),
    )
    turns = [math.pi * side / 4 for side in range(9)]
    rim = revolved(
        "Rim",
        [(0.05 + 0.006 * math.cos(turn), 0.006 + 0.006 * math.sin(turn)) for turn in turns],
        (0.4, 0.9, TOP),
        **BRASS,
    )
    lens = cylinder(
        "Lens", 0.047, 0.006, (0.4, 0.9, TOP + 0.006), colour=(0.8, 0.9, 0.95), roughness=0.05, clear=0.9
    )
    joined(
        "Magnifying glass",
        rim,
        lens,
        cylinder("Grip", 0.008, 0.11, (0.5, 0.9, TOP + 0.008), turn=(0, 90, 0), colour=OAK),
    )
    base = [
        ((0.14, 0.09, 0.03), (0, 0, 0.015)),
        ((0.06, 0.05, 0.05), (0, 0, 0.055)),
        ((0.14, 0.07, 0.045), (0, 0, 0.1)),
    ]
    anvil = boxes("Block", base, (0.55, 1.22, TOP), colour=(0.12, 0.12, 0.13), metal=0.8)
    horn = cylinder(
        "Horn",
        0.022,
        0.09,
        (0.665, 1.22, TOP + 0.1),
        turn=(0, 90, 0),
        top=0.004,
        colour=(0.12, 0.12, 0.13),
        metal=0.8,
    )
    joined("Small anvil", anvil, horn)
    cover = boxes(
        "Cover",
        [((0.24, 0.32, 0.006), (0, 0, z)) for z in (0.003, 0.049)]
        + [((0.006, 0.32, 0.052), (-0.12, 0, 0.026))],
        (0.1, 1.25, TOP),
        colour=(0.3, 0.1, 0.06),
    )
    joined(
        "Leather-bound ledger",
        cover,
        box("Pages", (0.225, 0.3, 0.04), (0.1, 1.25, TOP + 0.026), colour=(0.85, 0.8, 0.68)),
    )


def _tray():
    rims = [((0.4, 0.01, 0.03), (0, y, 0.015)) for y in (-0.125, 0.125)] + [
        ((0.01, 0.26, 0.03), (x, 0, 0.015)) for x in (-0.195, 0.195)
    ]
    boxes("Wooden tray", [((0.4, 0.26, 0.008), (0, 0, 0.004)), *rims], (-0.15, 0.92, TOP), colour=OAK)
    for x, y in ((-0.1, 0.05), (0.08, 0.06), (-0.07, -0.06), (0.1, -0.05)):
        at = (x - 0.15, 0.92 + y, TOP + 0.014)
        case = cylinder("Case", 0.032, 0.012, at, **BRASS)
        dial = cylinder("Dial", 0.027, 0.002, (*at[:2], TOP + 0.021), colour=(0.92, 0.9, 0.85))
        joined(
            "Pocket watch",
            case,
            dial,
            cylinder("Crown", 0.006, 0.014, (at[0], at[1] + 0.038, at[2]), turn=(90, 0, 0), **BRASS),
        )


def _stool():
    seat = cylinder("Seat", 0.18, 0.04, (0.15, 0.35, 0.53), colour=OAK)
    spread = [2 * math.pi * leg / 3 for leg in range(3)]
    feet = [
        tube(
            "Leg",
            [(0.17 * math.cos(t), 0.17 * math.sin(t), 0.02), (0.09 * math.cos(t), 0.09 * math.sin(t), 0.52)],
            0.018,
            (0.15, 0.35, 0),
            colour=OAK,
        )
        for t in spread
    ]
    joined("Three-legged stool", seat, *feet)


def _clocks():
    case = [
        ((0.5, 0.3, 0.25), (0, 0, 0.125)),
        ((0.36, 0.24, 1.1), (0, 0, 0.8)),
        ((0.46, 0.28, 0.5), (0, 0, 1.6)),
        ((0.52, 0.32, 0.05), (0, 0, 1.875)),
    ]
    tall = boxes("Case", case, (-1.5, 1.3, 0), colour=WALNUT)
    dial = cylinder("Dial", 0.17, 0.02, (-1.5, 1.15, 1.62), turn=(90, 0, 0), colour=(0.9, 0.87, 0.78))
    hands = boxes(
        "Hands",
        [((0.015, 0.01, 0.14), (0, 0, 0.06)), ((0.1, 0.01, 0.015), (-0.04, 0, 0))],
        (-1.5, 1.135, 1.62),
        colour=(0, 0, 0),
    )
    joined("Longcase clock", tall, dial, hands)
    house = prism(
        "House",
        [(-0.14, 0), (0.14, 0), (0.14, 0.24), (0, 0.38), (-0.14, 0.24)],
        0.14,
        (1.75, WALL - 0.07, 1.75),
        colour=OAK,
    )
    face = cylinder("Face", 0.08, 0.02, (1.75, WALL - 0.15, 1.87), turn=(90, 0, 0), colour=(0.9, 0.87, 0.78))
    cones = [
        cylinder("Weight", 0.022, 0.1, (1.75 + x, WALL - 0.07, z), **BRASS)
        for x, z in ((-0.06, 1.45), (0.06, 1.35))
    ]
    chains = [
        cylinder("Chain", 0.004, 1.76 - z, (1.75 + x, WALL - 0.07, (1.76 + z) / 2), **BRASS)
        for x, z in ((-0.06, 1.45), (0.06, 1.35))
    ]
    joined("Cuckoo clock", house, face, *cones, *chains)


def _pegboard():
    box("Pegboard", (0.8, 0.02, 0.6), (1.05, WALL - 0.01, 1.75), colour=(0.7, 0.58, 0.4))
    for x, size in ((-0.22, 0.8), (0, 1.0), (0.22, 1.2)):
        handle = cylinder("Handle", 0.012, 0.24 * size, (1.05 + x, WALL - 0.035, 1.75), colour=OAK)
        joined(
            "Hammer",
            handle,
            box("Head", (0.1 * size, 0.028, 0.03), (1.05 + x, WALL - 0.035, 1.75 + 0.12 * size), **STEEL),
        )


def _safe():
    at, green = (1.35, 1.15, 0), {"colour": (0.08, 0.14, 0.12), "metal": 0.5}
    body = boxes(
        "Body",
        [((0.6, 0.55, 0.7), (0, 0, 0.38)), *legs(0.25, 0.22, 0.03), ((0.5, 0.02, 0.58), (0, -0.28, 0.38))],
        at,
        **green,
    )
    dial = cylinder("Dial", 0.06, 0.03, (1.35, 0.85, 0.42), turn=(90, 0, 0), **BRASS)
    joined("Iron safe", body, dial, cylinder("Bolt", 0.01, 0.16, (1.5, 0.84, 0.42), **BRASS))
    glaze = {"colour": (0.75, 0.55, 0.35), "roughness": 0.1}
    cat = [
        (0.09, (0, 0.02, 0.085)),
        (0.07, (0, 0, 0.17)),
        (0.06, (0, -0.02, 0.27)),
        (0.03, (0.05, -0.06, 0.03)),
        (0.03, (-0.05, -0.06, 0.03)),
    ]
    parts = [ball("Part", radius, (1.35 + x, 1.15 + y, 0.73 + z), **glaze) for radius, (x, y, z) in cat]
    ears = [cylinder("Ear", 0.022, 0.05, (1.35 + x, 1.14, 1.06), top=0, **glaze) for x in (-0.035, 0.035)]
    tail = tube(
        "Tail", [(0.06, 0.06, 0.02), (0.13, 0, 0.02), (0.11, -0.08, 0.02)], 0.018, (1.35, 1.15, 0.73), **glaze
    )
    joined("Porcelain cat", *parts, *ears, tail)
    coil = [(turn * 0.006, turn) for turn in [0.4 * step for step in range(10, 80)]]
    spiral = [(out * math.cos(turn), out * math.sin(turn), 0.018) for out, turn in coil]
    tube("Coiled hemp rope", spiral, 0.018, (1.3, 0.45, 0), colour=(0.62, 0.5, 0.32))
