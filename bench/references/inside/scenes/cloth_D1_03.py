# SPDX-License-Identifier: GPL-3.0-or-later
"""A striped blanket slides down a shed's roof, over the eave, and crumples on the lawn."""

from ..props import box, joined, prism, sheet
from ..scene_setup import begin, camera, light
from ..simulation_parts import cloth, collider

PITCH = 28  # degrees
# The roof in the plane of its fall, from ridge to eave (x, z): a slab 0.12 m thick, over walls that follow it.
ROOF = [(-1.2, 2.64), (1.2, 1.36), (1.2, 1.24), (-1.2, 2.52)]
WALL = [(-1.0, 0), (-1.0, 2.44), (1.0, 1.38), (1.0, 0)]


def build():
    """Builds the scene."""
    begin(84)
    collider(box("Lawn", (9, 7, 0.1), (1, 0, -0.05), colour=(0.12, 0.35, 0.08)), friction=60)
    walls = prism("Walls", WALL, 1.8, colour=(0.4, 0.25, 0.14))
    slates = prism("Slates", ROOF, 2.1, colour=(0.2, 0.22, 0.26), roughness=0.2)
    collider(joined("Garden shed", walls, slates), friction=4)  # wet slate
    wool = sheet(
        "Striped wool blanket",
        (1.2, 1.5),
        (32, 40),
        (-0.38, 0, 2.24),
        turn=(0, PITCH, 0),
        colour=(0.75, 0.7, 0.6),
    )
    _stripe(wool, (0.6, 0.1, 0.1))
    cloth(wool, mass=0.4, self_collision=True)
    camera((5.6, -3.9, 2.0), (0.9, 0, 0.9), lens=31)
    light(sun=2.5, elevation=15, azimuth=60, sky=(0.8, 0.6, 0.5), colour=(1, 0.8, 0.6))


def _stripe(thing, colour):
    """Every other hand's breadth of it, along y, in another colour."""
    other = thing.data.materials[0].copy()
    other.diffuse_color = (*colour, 1)
    next(n for n in other.node_tree.nodes if n.type == "BSDF_PRINCIPLED").inputs[
        "Base Color"
    ].default_value = (*colour, 1)
    thing.data.materials.append(other)
    for face in thing.data.polygons:
        face.material_index = int(face.center.y // 0.1) % 2
