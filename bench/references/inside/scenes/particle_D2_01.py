# SPDX-License-Identifier: GPL-3.0-or-later
"""Grass on a dune bends in a gusty wind and sways, around a post with a sign."""

from math import exp, hypot

from mathutils import Vector

from ..props import box, boxes, joined, sheet, tube, weigh
from ..scene_setup import begin, camera, keys, light, paint
from ..simulation_parts import field, hair

POST = (0.3, -0.5)
GUSTS = (3, 20, 8, 26, 9, 22, 6, 24)  # every half second
FREE = 0.3  # metres around the post where no grass grows: it would blow through it


def build():
    """Builds the scene."""
    begin(96)
    dune = sheet("Sand dune", (9, 7), (60, 48))
    for point in dune.data.vertices:
        point.co.z = _height(point.co.x, point.co.y)
    dune.data.update()
    _grass(dune)
    wind = field("Sea wind", "WIND", GUSTS[0], (-4, 0, 1.5), turn=(0, 1.45, 0), noise=2.0)
    keys(wind, "field.strength", dict(zip(range(1, 97, 12), GUSTS, strict=True)))
    _sign(_height(*POST))
    camera((1.0, -4.9, 1.6), (0.1, 0, 1.25), lens=35)
    light(sun=3, elevation=8, azimuth=60, sky=(0.8, 0.55, 0.45), colour=(1, 0.7, 0.45))


def _height(x, y):
    """Of the dune: a hump, which falls off to all sides."""
    return 0.9 * exp(-(hypot(x / 3.2, (y - 0.6) / 2.2) ** 2))


def _grass(dune):
    """Long blades of a green of their own, that bend in the wind."""
    (green,) = paint(dune, colour=(0.2, 0.28, 0.08)).data.materials
    paint(dune, colour=(0.6, 0.48, 0.32), roughness=1.0)
    dune.data.materials.append(green)
    settings = hair(dune, "Marram grass", 600, length=0.6)
    settings.material = 2
    settings.use_advanced_hair, settings.factor_random, settings.hair_step = True, 0.08, 4
    settings.child_type, settings.rendered_child_count, settings.child_percent = "INTERPOLATED", 4, 4
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.1, 0.012
    settings.effector_weights.gravity = 0.1  # dry blades hardly weigh
    blades = dune.particle_systems[0]
    blades.vertex_group_density = weigh(dune, "grown", lambda at: (at.xy - Vector(POST)).length > FREE)
    blades.cloth.settings.bending_stiffness, blades.cloth.settings.air_damping = 2.0, 1.0


def _sign(foot):
    """Nailed to its post, which stands a little askew."""
    x, y = POST
    tilt = [(0, 0, -0.4), (0.01, 0, 0.6), (0.05, 0.01, 1.7)]
    tube("Driftwood post", tilt, 0.07, (x, y, foot), sides=9, colour=(0.42, 0.37, 0.32), roughness=1.0)
    plate = box("Plate", (0.7, 0.015, 0.4), (x + 0.03, y - 0.077, foot + 1.4), colour=(0.85, 0.87, 0.9))
    letters = [((0.5, 0.004, 0.05), (0, 0, z)) for z in (-0.08, 0.08)]
    lines = boxes("Lines", letters, (x + 0.03, y - 0.086, foot + 1.4), colour=(0.05, 0.12, 0.4))
    joined("Enamel sign", plate, lines)
