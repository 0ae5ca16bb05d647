# SPDX-License-Identifier: GPL-3.0-or-later
"""Incense smoke rises from a burner, and is led aside over the altar by a fan that sweeps past."""

from ..props import box, cylinder, joined, revolved, tube
from ..scene_setup import begin, camera, keys, lamp, light, vapour
from ..simulation_parts import domain, effector, flow

TOP = 0.9
BURNER = [(0, 0), (0.07, 0), (0.05, 0.03), (0.1, 0.08), (0.1, 0.13), (0.07, 0.13), (0.07, 0.1), (0, 0.1)]


def build():
    """Builds the scene."""
    begin(48)
    box("Temple floor", (8, 6, 0.1), (0, 0.5, -0.05), colour=(0.16, 0.1, 0.07))
    box("Temple wall", (8, 0.2, 4), (0, 2.5, 2), colour=(0.2, 0.07, 0.05))
    box("Altar stone", (2.2, 0.9, TOP), (0, 0, TOP / 2), colour=(0.3, 0.3, 0.32), roughness=0.8)
    clay = revolved("Clay burner", BURNER, (-0.5, 0, TOP), colour=(0.55, 0.25, 0.13), roughness=0.9)
    flow(clay, "SMOKE").density = 2.0
    fan = _fan()
    # A hand sweeps it past the burner and on, over the stone.
    keys(fan, "location", {8: fan.location.copy(), 38: (0.5, 0, TOP + 0.36)}, even=True)
    keys(fan, "rotation_euler", {8: (0, 0.3, 0), 38: (0, -0.3, 0)})
    effector(fan, "GUIDE", thickness=5.0)
    smoke = box("Incense smoke", (1.7, 0.7, 1.4), (0, 0, TOP + 0.7))
    air = domain(vapour(smoke, colour=(0.9, 0.9, 0.92), density=8.0), "GAS", resolution=32)
    air.use_guide, air.guide_source = True, "EFFECTOR"
    # A fan of so few cells must pull harder than it goes, and not be blurred away.
    air.guide_vel_factor, air.guide_beta = 4.0, 2
    air.timesteps_max = 2
    lamp("Altar candle", 40, (-1.5, -1.2, 2.0), colour=(1, 0.7, 0.4), size=0.2)
    camera((0.4, -3.0, 1.7), (0.0, 0, 1.3), lens=36)
    light(sun=0.5, sky=(0.02, 0.02, 0.04), colour=(0.7, 0.8, 1))


def _fan():
    """A round leaf of lacquer, its face along the sweep, on a handle."""
    lacquer = {"colour": (0.6, 0.03, 0.03), "roughness": 0.2}
    middle = (-0.75, 0, TOP + 0.36)
    leaf = tube("Leaf", [(-0.008, 0, 0), (0.008, 0, 0)], 0.22, middle, sides=32, **lacquer)
    handle = cylinder("Handle", 0.014, 0.3, (-0.75, -0.32, TOP + 0.36), turn=(90, 0, 0), **lacquer)
    return joined("Lacquered fan", leaf, handle)
