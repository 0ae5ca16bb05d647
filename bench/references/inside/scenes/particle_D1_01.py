# SPDX-License-Identifier: GPL-3.0-or-later
"""Snow sifts down on a chapel and the meadow around it, and stays where it lands."""

from ..air_drag import sinks
from ..props import ball, box, boxes, joined, prism, sheet
from ..scene_setup import begin, camera, last, light
from ..simulation_parts import collider, particles

HIGH = 5.2
SLOW = 2.0  # metres a second
AHEAD = 20  # frames: the first flakes are about to meet the chapel when the clip begins


def build():
    """Builds the scene."""
    begin(120)
    meadow = box("Frozen meadow", (50, 50, 0.4), (0, 0, -0.2), colour=(0.62, 0.68, 0.66), roughness=0.9)
    for thing in (meadow, _chapel()):
        collider(thing, thickness=0.01, damping=1.0).settings.friction_factor = 1.0
    cloud = sheet(
        "Snow cloud", (16, 13), (8, 7), (0, 1.5, HIGH), turn=(180, 0, 0), colour=(0.7, 0.73, 0.78), glow=0.7
    )
    cloud.visible_shadow = False  # its edge would lie on the meadow
    flake = ball("Snowflake", 1.0, (0, 0, -3), detail=1, colour=(1, 1, 1), roughness=0.9)
    snow = particles(
        cloud, "Snowfall", 6000, first=1 - AHEAD, lifetime=AHEAD + last(), size=0.024, shown=flake, speed=SLOW
    )
    sinks(snow, SLOW, flutter=0.4)
    camera((4.6, -8.2, 1.6), (0, 0, 1.5), lens=37)
    light(sun=1.5, elevation=10, azimuth=-60, sky=(0.7, 0.73, 0.78), colour=(1, 0.9, 0.8))


def _chapel():
    """Walls, a steep roof of slate, and a small tower over the door."""
    stone, slate = {"colour": (0.6, 0.56, 0.5)}, {"colour": (0.13, 0.15, 0.19), "roughness": 0.4}
    gable = [(-1.3, 0), (1.3, 0), (1.3, 1.5), (0, 2.7), (-1.3, 1.5)]
    walls = prism("Walls", gable, 3.6, **stone)
    slope = [(-1.55, 1.25), (0, 2.69), (1.55, 1.25), (1.6, 1.33), (0, 2.81), (-1.6, 1.33)]
    roof = prism("Roof", slope, 4.0, **slate)
    tower = box("Tower", (0.5, 0.5, 0.9), (0, -1.35, 2.45), **stone)
    spire = prism("Spire", [(-0.35, 0), (0.35, 0), (0, 0.5)], 0.7, (0, -1.35, 2.9), **slate)
    door = [((0.6, 0.06, 1.3), (0, -1.81, 0.65))]
    windows = [((0.06, 0.35, 0.8), (1.31, y, 1.0)) for y in (-0.9, 0.0, 0.9)]
    openings = boxes("Openings", door + windows, colour=(0.16, 0.09, 0.05))
    return joined("Mountain chapel", walls, roof, tower, spire, openings)
