# SPDX-License-Identifier: GPL-3.0-or-later
"""A napkin floats down over a pudding that wobbles on its plate, clings to it and trembles with it."""

from ..props import box, revolved, sheet
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, collider, soft
from ..soft_body_struts import braced

TOP = 0.9
PLATE = [(0, 0), (0.2, 0), (0.28, 0.012), (0.28, 0.018), (0.2, 0.012), (0, 0.012)]
DOME = [
    (0.07, 0),
    (0.12, 0),
    (0.124, 0.02),
    (0.12, 0.045),
    (0.112, 0.07),
    (0.1, 0.092),
    (0.08, 0.112),
    (0.05, 0.127),
]


def build():
    """Builds the scene."""
    begin(72)
    box("Kitchen worktop", (1.2, 0.8, TOP), (0, 0, TOP / 2), colour=(0.55, 0.5, 0.45))
    plate = revolved("Pewter plate", PLATE, (0, 0, TOP), colour=(0.5, 0.5, 0.53), metal=1.0, roughness=0.4)
    collider(plate, thickness=0.004, inner=0.006, damping=0.2)
    dome = [(0, 0), *DOME, (0.025, 0.133), (0, 0.135)]
    # Set down a little aslant: that is what it wobbles of.
    pudding = revolved(
        "Caramel pudding", dome, (0, 0, TOP + 0.045), sides=24, colour=(0.75, 0.45, 0.12), roughness=0.3
    )
    pudding.rotation_euler = (0.06, 0.2, 0)
    soft(braced(pudding), stiffness=0.05, bending=0, damping=0).settings.friction = 0.1
    collider(pudding, thickness=0.004, friction=30)
    napkin = sheet(
        "Cotton napkin", (0.46, 0.46), (46, 46), (0, 0, TOP + 0.3), turn=(4, 3, 30), colour=(0.9, 0.7, 0.08)
    )
    falls = cloth(napkin, mass=0.04, stiffness=10, distance=0.004)
    falls.settings.air_damping = 2  # floats
    camera((0.5, -0.85, 1.4), (0, 0, 1.0), lens=40)
    light(elevation=35, azimuth=-60, sky=(0.7, 0.62, 0.55))
