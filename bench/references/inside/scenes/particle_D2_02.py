# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves lie on the cobbles of a courtyard; a whirlwind lifts them, and they circle upwards between bench and lamp."""

from ..props import boxes, joined, mesh, revolved, sheet, weigh
from ..scene_setup import begin, camera, light, under
from ..simulation_parts import field, particles

WIDE = 0.7  # metres, half of the ground from which leaves are lifted
# Of a maple leaf, from its stalk around its five lobes: (across, along).
LOBES = [(0, -1), (0.1, -0.35), (0.75, -0.5), (0.5, -0.1), (1, 0.3), (0.45, 0.25), (0.3, 0.4), (0, 1)]


def build():
    """Builds the scene."""
    begin(72)
    ground = _courtyard()
    leaves = particles(
        ground, "Maple leaves", 220, until=50, lifetime=200, size=0.06, shown=_leaf(), speed=0.2
    )
    leaves.show_unborn = True  # until they are lifted, they lie there
    leaves.use_rotations, leaves.rotation_factor_random, leaves.phase_factor_random = True, 0.05, 2.0
    leaves.angular_velocity_mode, leaves.angular_velocity_factor = "RAND", 4.0
    leaves.damping = 0.3  # so light are they that they soon go no faster than the air
    ground.particle_systems[0].vertex_group_density = "littered"
    _whirlwind()
    _bench()
    _lamppost()
    camera((0.8, -5.4, 1.6), (0, 0, 1.4), lens=30)
    light(sun=3, elevation=25, azimuth=-50, sky=(0.55, 0.62, 0.72), colour=(1, 0.88, 0.7))


def _courtyard():
    """Cobbles in rows; between those in their midst, the level ground that is littered."""
    stones = [
        ((0.19, 0.14, 0.06), (0.2 * x + 0.1 * (y % 2), 0.15 * y, -0.03))
        for x in range(-20, 20)
        for y in range(-24, 25)
    ]
    stones.append(((8.2, 7.4, 0.06), (0, 0, -0.04)))  # the joints
    cobbles = boxes("Cobbles", stones, colour=(0.36, 0.34, 0.33), roughness=0.9)
    litter = sheet("Litter", (2 * WIDE, 2 * WIDE), (12, 12), (0, 0, -0.006), colour=(0.36, 0.34, 0.33))
    weigh(litter, "littered", lambda _: True)
    return joined("Cobbles", cobbles, litter)


def _whirlwind():
    """Turns around its axis; its updraft, twice as strong as their weight, lifts the leaves"""
    whirl = field("Whirlwind", "VORTEX", 15.0)
    whirl.field.shape = "POINT"  # the other shapes hold what they turn back, and draw it in
    lift = field("Updraft", "WIND", 20.0)
    for one in (whirl, lift):
        one.field.falloff_type, one.field.use_radial_max, one.field.radial_max = "TUBE", True, 2.2
    under(whirl, lift)


def _bench():
    """To the left, askew."""
    seat, ends = ((1.5, 0.45, 0.1), (0, 0, 0.42)), [((0.14, 0.4, 0.37), (x, 0, 0.185)) for x in (-0.55, 0.55)]
    boxes(
        "Stone bench", [seat, *ends], (-2.2, 1.0, 0), turn=(0, 0, 40), colour=(0.6, 0.58, 0.53), roughness=0.9
    )


def _lamppost():
    """To the right."""
    post = [(0, 0), (0.2, 0), (0.2, 0.08), (0.1, 0.16), (0.07, 0.5), (0.045, 0.6), (0.04, 2.2), (0.1, 2.25)]
    lantern = [(0.17, 2.6), (0.19, 2.62), (0.03, 2.78), (0, 2.85)]
    iron = {"colour": (0.05, 0.06, 0.05), "metal": 0.8, "roughness": 0.5}
    revolved("Lamppost", [*post, *lantern], (2.2, 0.8, 0), sides=12, **iron)


def _leaf():
    """Lies flat, on the tops of the cobbles, its face along X: that is where particles look."""
    rim = [*LOBES, *((-x, y) for x, y in LOBES[-2:0:-1])]
    faces = [(0, *range(1, len(rim)))]
    return mesh(
        "Dry leaf", [(0.15 + 0.1 * x * x, x, y) for x, y in rim], faces, (0, 0, -2), colour=(0.75, 0.28, 0.05)
    )
