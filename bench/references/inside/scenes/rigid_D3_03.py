# SPDX-License-Identifier: GPL-3.0-or-later
"""A burning torch tumbles down cellar steps, trailing flame and smoke, until it lies on the flagstones."""

from ..props import ball, box, boxes, cylinder, joined
from ..scene_setup import begin, camera, lamp, light, under, vapour
from ..simulation_parts import body, domain, effector, flow, thrown

STEPS, DEEP, HIGH, WIDE = 4, 0.27, 0.2, 1.6
LONG, HEAD = 0.5, 0.05  # of the torch's handle; the radius of its head


def build():
    """Builds the scene."""
    begin(72)
    floor = box("Flagstones", (6, 4, 0.1), (1.0, 0, -0.05), colour=(0.24, 0.23, 0.22), roughness=0.9)
    body(floor, "PASSIVE", shape="BOX", friction=0.9, bounce=0.4)
    treads = [((DEEP, WIDE, n * HIGH), (-n * DEEP, 0, n * HIGH / 2)) for n in range(1, STEPS)]
    landing = ((1.0, WIDE, STEPS * HIGH), (-(STEPS - 0.5) * DEEP - 0.5, 0, STEPS * HIGH / 2))
    steps = boxes("Limestone steps", [*treads, landing], colour=(0.55, 0.51, 0.42), roughness=0.9)
    body(steps, "PASSIVE", shape="MESH", friction=0.7, bounce=0.7)
    effector(steps)
    torch = _torch()
    torch.location, torch.rotation_euler = (-STEPS * DEEP - 0.22, 0, STEPS * HIGH + 0.3), (0.3, 0.4, 0)
    body(torch, mass=1.2, friction=0.5, bounce=0.6).angular_damping = 0.7
    thrown(torch, (1.5, 0, 0), (0, 4, 0))
    _smoke()
    lamp("Moonlit window", 25, (0.6, -2.2, 2.4), colour=(0.55, 0.65, 1), size=0.3)
    camera((1.5, -2.5, 1.25), (-0.35, 0, 0.6), lens=32)
    light(sun=0.1, sky=(0.02, 0.02, 0.03))


def _torch():
    """Its origin is its centre of mass; what burns is at the upper end of the handle."""
    wood = cylinder("Handle", 0.018, LONG, (0, 0, -0.1), top=0.024, sides=12, colour=(0.3, 0.18, 0.09))
    pitch = cylinder(
        "Pitch", HEAD, 0.16, (0, 0, LONG / 2 - 0.12), top=0.035, sides=16, colour=(0.04, 0.03, 0.03)
    )
    torch = joined("Torch", wood, pitch)
    flame = ball("Torch flame", HEAD + 0.01, (0, 0, LONG / 2 - 0.09), detail=2)
    under(torch, flame)
    fire = flow(flame, "BOTH")
    flame.hide_render = True
    fire.surface_distance, fire.subframes, fire.fuel_amount = 1.0, 2, 1.2
    fire.smoke_color = (0.03, 0.03, 0.03)
    return torch


def _smoke():
    air = vapour(
        box("Dark smoke", (2.5, 1.1, 1.7), (-0.35, 0, 0.85)), colour=(0.05, 0.05, 0.05), density=8, fire=20
    )
    settings = domain(air, "GAS", resolution=44)
    settings.burning_rate, settings.flame_smoke, settings.vorticity = 0.9, 1.2, 0.2
