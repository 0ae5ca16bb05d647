# SPDX-License-Identifier: GPL-3.0-or-later
"""A slab of Turkish delight flops onto a counter; sugar bursts off its skin each time it wobbles."""

from ..props import ball, block, box, weigh
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, particles, soft
from ..soft_body_struts import braced

TOP = 0.9
WOBBLES = (11, 19, 28)  # frames in which the slab lands, swells up again, and once more


def build():
    """Builds the scene."""
    begin(60)
    box("Shop floor", (6, 6, 0.1), (0, 0, -0.05), colour=(0.6, 0.5, 0.4))
    counter = box(
        "Black marble counter", (2.0, 1.0, TOP), (0, 0, TOP / 2), colour=(0.03, 0.03, 0.035), roughness=0.15
    )
    collider(counter, thickness=0.01, damping=0.3)
    slab = block(
        "Slab of Turkish delight",
        (0.56, 0.4, 0.14),
        (10, 7, 3),
        (0, 0, TOP + 0.72),
        turn=(6, 14, 15),
        colour=(0.9, 0.5, 0.58),
    )
    skin = weigh(slab, "Skin", lambda point: point.z > -0.03)
    soft(braced(slab), stiffness=0.12, bending=0, damping=0).settings.friction = 0.3
    grain = ball("Grain of sugar", 1.0, (0, 0, -2), detail=1, colour=(1, 1, 1), roughness=1.0)
    for number, frame in enumerate(WOBBLES):
        puff = particles(
            slab, f"Puff {number + 1}", 500 - 120 * number, first=frame, until=frame + 3, lifetime=40, size=0.006,
            shown=grain, speed=1.2 - 0.3 * number,
        )  # fmt: skip
        puff.factor_random, puff.lifetime_random, puff.size_random = 0.8, 0.5, 0.6
        puff.damping, puff.brownian_factor = 0.12, 0.5
        puff.effector_weights.gravity = 0.08  # so fine that it hangs in the air
        slab.particle_systems[number].vertex_group_density = skin
        slab.particle_systems[number].seed = number
    camera((0.7, -1.7, 1.55), (0, 0, 1.1), lens=38)
    light(sun=4, elevation=65, sky=(0.6, 0.58, 0.55))
