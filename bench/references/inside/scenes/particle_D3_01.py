# SPDX-License-Identifier: GPL-3.0-or-later
"""The sail of a burning longship billows from its yard; embers peel off the cloth and blow away over the bow."""

from ..props import ball, box, cylinder, joined, mesh, sheet, tube, weigh
from ..scene_setup import begin, camera, keys, lamp, light
from ..simulation_parts import cloth, field, particles

WOOD = (0.16, 0.09, 0.05)
YARD = 3.3
WIDE, HIGH = 2.4, 2.0
LONG, BEAM = 3.6, 0.75  # half of the hull's
GUSTS = (1500.0, 2200.0, 300.0, 2400.0, 600.0, 2000.0, 200.0, 2400.0, 800.0)


def build():
    """Builds the scene."""
    begin(72)
    box("Fjord", (80, 80, 1), (0, 0, -0.5), colour=(0.02, 0.05, 0.08), roughness=0.15)
    cylinder("Wooden yard", 0.06, WIDE + 0.4, (0.15, 0, YARD), turn=(90, 0, 0), colour=(0.3, 0.18, 0.1))
    _ship()
    sail = sheet(
        "Linen sail",
        (HIGH, WIDE),
        (25, 30),
        (0.24, 0, YARD - HIGH / 2),
        turn=(0, 90, 0),
        colour=(0.7, 0.6, 0.42),
    )
    # The upper edge is laced to the yard, ropes hold the lower corners.
    pins = weigh(
        sail,
        "Held",
        lambda at: at.x < 0.01 - HIGH / 2 or (at.x > HIGH / 2 - 0.01 and abs(at.y) > WIDE / 2 - 0.1),
    )
    cloth(sail, pins=pins, mass=0.05, stiffness=20).settings.air_damping = 1
    ember = ball("Ember", 1.0, (0, 0, -3), detail=1, colour=(1, 0.4, 0.06), glow=30.0)
    embers = particles(sail, "Embers", 500, first=4, lifetime=45, size=0.018, shown=ember, speed=0.4)
    embers.factor_random, embers.lifetime_random, embers.size_random = 0.6, 0.4, 0.5
    embers.effector_weights.gravity = -0.05  # they are carried by hot air
    embers.effector_weights.wind = 0.002  # which is meant for the sail, a thousand times heavier
    embers.brownian_factor, embers.drag_factor = 2.0, 0.05
    flame = ball("Flame", 1.0, (1, 0, -3), detail=1, colour=(1, 0.3, 0.03), glow=15.0)
    deck = sheet("Burning deck", (2.8, 0.7), (7, 2), (-0.7, 0, 0.23), colour=(0.03, 0.02, 0.02))
    fire = particles(deck, "Fire", 4000, first=-15, lifetime=14, size=0.06, shown=flame, speed=0.3)
    fire.lifetime_random, fire.size_random, fire.factor_random = 0.7, 0.8, 0.3
    fire.effector_weights.gravity, fire.effector_weights.wind = -0.3, 0.001
    gale = field("Gale", "WIND", 0.0, (-5, 0, 2.3), turn=(0, 1.57, 0.1), noise=6)
    keys(gale, "field.strength", {1 + 9 * number: force for number, force in enumerate(GUSTS)})
    lamp("Firelight", 250, (-0.4, -0.3, 0.9), colour=(1, 0.45, 0.15), size=0.3)
    camera((4.5, -7.5, 2.4), (0.9, 0, 1.75), lens=34)
    light(sun=0.3, elevation=30, azimuth=60, sky=(0.008, 0.014, 0.035), colour=(0.6, 0.7, 1))


def _ship():
    """Hull, mast and the ropes of the sail's lower corners."""
    hull = _hull()
    mast = cylinder("Mast", 0.07, YARD - 0.1, (0, 0, 0.1 + (YARD - 0.1) / 2), colour=WOOD)
    foot = YARD - HIGH
    ropes = [
        tube("Rope", [(0.24, y * WIDE / 2, foot), (-0.5, y * 0.68, 0.62)], 0.015, colour=(0.5, 0.4, 0.25))
        for y in (-1, 1)
    ]
    return joined("Burning longship", hull, mast, *ropes)


def _hull():
    """Rings of points from stern to bow: up one side, over the gunwale, along the deck and back."""
    points, faces, rings = [], [], 17
    for number in range(rings):
        along = 2 * number / (rings - 1) - 1
        half = 0.03 + BEAM * (1 - along**4) ** 1.2
        keel, rim = -0.35 + 1.2 * along**8, 0.6 + 1.5 * along**6
        deck = max(0.2, rim - 0.35)
        side = [(half * 0.6, keel + 0.25 * (rim - keel)), (half, rim), (half * 0.9, rim), (half * 0.75, deck)]
        ring = [(0, keel), *side, *((-y, z) for y, z in side[::-1])]
        points += [(LONG * along, y, z) for y, z in ring]
    count = len(ring)
    for low in range(0, count * (rings - 1), count):
        faces += [
            (low + i, low + (i + 1) % count, low + count + (i + 1) % count, low + count + i)
            for i in range(count)
        ]
    faces += [tuple(range(count))[::-1], tuple(range(len(points) - count, len(points)))]
    return mesh("Hull", points, faces, colour=WOOD)
