# SPDX-License-Identifier: GPL-3.0-or-later
"""An inner tube drops upright onto asphalt, squashes to an oval, springs up and rolls over onto its side."""

import math

from ..props import box
from ..round_shapes import ring
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, soft
from ..soft_body_struts import braced


def build():
    """Builds the scene."""
    begin(96)
    track = box("Hot asphalt", (8, 8, 0.4), (0, 0, -0.2), colour=(0.33, 0.33, 0.34), roughness=0.9)
    collider(track, thickness=0.02, inner=0.1, damping=0.02)
    tube = ring(
        "Rubber inner tube", 0.42, 0.11, (0, 0, 0.95), sides=40, colour=(0.03, 0.03, 0.035), roughness=0.4
    )
    tube.rotation_euler = (
        math.radians(84),
        0,
        math.radians(20),
    )  # leans a little, and so falls over in the end
    soft(braced(tube), stiffness=0.9, bending=0, damping=1).settings.friction = 0.1
    camera((2.4, -2.6, 1.3), (0, 0, 0.55), lens=38)
    light(elevation=65)
