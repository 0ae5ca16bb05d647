# SPDX-License-Identifier: GPL-3.0-or-later
"""A strip of velvet is let down end first onto a counter, and folds back and forth into a heap beside scissors."""

from ..props import box, joined, sheet, weigh
from ..round_shapes import ring
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import cloth, collider, hook

LONG, TOP = 1.5, 0.9
BRASS = {"colour": (0.75, 0.55, 0.2), "metal": 1.0, "roughness": 0.3}


def build():
    """Builds the scene."""
    begin(96)
    counter = box(
        "Marble counter", (1.8, 0.8, TOP), (0, 0, TOP / 2), colour=(0.85, 0.84, 0.82), roughness=0.2
    )
    collider(counter, friction=60)
    _scissors(0.42)
    middle = (-0.15, 0, TOP + 0.03 + LONG / 2)
    velvet = sheet("Velvet strip", (LONG, 0.16), (90, 10), middle, turn=(0, 90, 0), colour=(0.5, 0.01, 0.06))
    held = weigh(velvet, "Held", lambda point: point.x < -LONG / 2 + 0.01)
    hand = hook(velvet, "Hand", held, (-0.15, 0, TOP + 0.03 + LONG))
    keys(hand, "location", {1: hand.location.copy(), 88: (-0.15, 0, TOP + 0.08)}, even=True)
    cloth(velvet, pins=held, mass=0.15, self_collision=True, distance=0.008).settings.bending_stiffness = 30
    camera((1.5, -1.7, 1.75), (0, 0, 1.35), lens=32)
    light(elevation=30, azimuth=50, sky=(0.6, 0.52, 0.45), colour=(1, 0.85, 0.7))


def _scissors(x):
    z, parts = TOP + 0.004, []
    for side in (-1, 1):
        turn = (0, 0, 12 * side)
        blade = box("Blade", (0.13, 0.012, 0.004), (x + 0.06, side * 0.012, z), turn=turn, **BRASS)
        shank = box("Shank", (0.08, 0.008, 0.006), (x - 0.03, -side * 0.005, z), turn=turn, **BRASS)
        parts += [blade, shank, ring("Bow", 0.028, 0.004, (x - 0.095, -side * 0.035, z), sides=16, **BRASS)]
    joined("Brass scissors", *parts)
