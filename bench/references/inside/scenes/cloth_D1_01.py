# SPDX-License-Identifier: GPL-3.0-or-later
"""A tablecloth falls on a round table, and drapes."""

from ..props import box, cylinder, joined, sheet
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, collider


def build():
    """Builds the scene."""
    begin(60)
    box("Floor", (6, 6, 0.1), (0, 0, -0.05), colour=(0.35, 0.22, 0.12))
    wood = (0.45, 0.26, 0.12)
    top = cylinder("Top", 0.5, 0.04, (0, 0, 0.73), colour=wood)
    post = cylinder("Post", 0.05, 0.71, (0, 0, 0.36), colour=wood)
    foot = cylinder("Foot", 0.25, 0.03, (0, 0, 0.015), colour=wood)
    collider(joined("Round table", top, post, foot))
    cloth(sheet("Tablecloth", (1.4, 1.4), (36, 36), (0, 0, 0.8), colour=(0.7, 0.03, 0.04)))
    camera((2.2, -2.2, 1.6), (0, 0, 0.55))
    light(sky=(0.5, 0.45, 0.4))
