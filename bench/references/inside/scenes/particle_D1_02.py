# SPDX-License-Identifier: GPL-3.0-or-later
"""A cannon shoots a burst of confetti, which flutters down and stays on the tiles."""

from math import radians

from ..air_drag import sinks
from ..props import box, boxes, cylinder, joined, revolved, sheet, weigh
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, particles

STEEP = 70  # degrees, of the barrel
BORE = 0.085
COLOURS = {"Rose": (0.85, 0.12, 0.3), "Golden": (0.95, 0.65, 0.08), "White": (0.95, 0.93, 0.9)}


def build():
    """Builds the scene."""
    begin(72)
    tiles = [((0.48, 0.48, 0.05), (0.5 * x, 0.5 * y, -0.025)) for x in range(-12, 13) for y in range(-12, 13)]
    tiles.append(((12.5, 12.5, 0.05), (0, 0, -0.035)))  # the joints
    terrace = boxes("Terracotta tiles", tiles, colour=(0.6, 0.25, 0.13), roughness=0.8)
    collider(terrace, thickness=0.005, damping=0.95).settings.friction_factor = 0.9
    cannon = _cannon()
    for number, (name, colour) in enumerate(COLOURS.items()):
        scrap = box(f"{name} scrap", (2, 1.2, 0.05), (number, 0, -2), colour=colour)
        burst = particles(
            cannon, f"{name} confetti", 250, first=4, until=7, lifetime=120, size=0.02, shown=scrap, speed=26
        )
        burst.factor_random, burst.subframes = 5.0, 4
        burst.use_rotations, burst.rotation_factor_random = True, 1.0
        burst.angular_velocity_mode, burst.angular_velocity_factor = "RAND", 6.0
        sinks(burst, 3.2, flutter=1.0)
        cannon.particle_systems[number].vertex_group_density = "charge"
        cannon.particle_systems[number].seed = number
    camera((1.3, -6.3, 1.6), (0.8, 0, 1.25), lens=34)
    light(sun=3, elevation=8, azimuth=60, sky=(0.75, 0.5, 0.4), colour=(1, 0.7, 0.45))


def _cannon():
    """A barrel on wheels and two cheeks of wood; the charge lies deep in its bore."""
    brass = {"colour": (0.75, 0.55, 0.2), "metal": 1.0, "roughness": 0.25}
    wood = {"colour": (0.3, 0.14, 0.07)}
    axle = (0, 0, 0.25)
    wheels = [cylinder("Wheel", 0.25, 0.05, (0, y, 0.25), turn=(90, 0, 0), **wood) for y in (-0.22, 0.22)]
    shaft = cylinder("Axle", 0.02, 0.5, axle, turn=(90, 0, 0), **brass)
    sides = [((0.75, 0.04, 0.1), (0, y, 0)) for y in (-0.165, 0.165)]  # from the axle down to the ground
    cheeks = boxes("Cheeks", sides, (-0.3, 0, 0.16), turn=(0, -17.5, 0), **wood)
    bore = [(0, 0), (0.13, 0), (0.15, 0.1), (0.1, 0.74), (0.13, 0.8), (BORE, 0.8), (BORE, 0.15), (0, 0.15)]
    barrel = revolved("Barrel", bore, (-0.05, 0, 0.11), **brass)
    charge = sheet("Charge", (BORE, BORE), (2, 2), (0.02, 0, 0.3), colour=(0.9, 0.9, 0.9))
    for thing in (barrel, charge):
        thing.rotation_euler.y = radians(90 - STEEP)
    weigh(charge, "charge", lambda _: True)
    return joined("Brass cannon", barrel, charge, shaft, cheeks, *wheels)
