# SPDX-License-Identifier: GPL-3.0-or-later
"""A rubber frog slides off a ledge, plops into a tray of water and is flattened on its bottom."""

import math

import bpy
from mathutils import Euler, Matrix, Vector

from ..props import ball, box, boxes, joined, mesh, smooth
from ..scene_setup import begin, camera, light
from ..simulation_parts import collider, domain, effector, flow, soft
from ..soft_body_struts import braced

LONG, WIDE, DEEP, FLOOR = 0.9, 0.7, 0.24, 0.08  # of the tray, inside; how thick its bottom is
WATER = 0.11
STEEP = math.radians(28)  # of the ledge's top
BRINK = (-LONG / 2 - 0.04, 0.5)  # where it ends: x, z
# Body, head, eyes and legs of the frog: where, how long along x, y and z (half sides).
PARTS = [
    ((0, 0, 0), (0.11, 0.085, 0.06)), ((0.09, 0, 0.03), (0.065, 0.07, 0.045)),
    *(((0.1, y, 0.075), (0.024, 0.024, 0.024)) for y in (-0.04, 0.04)),
    *(((-0.06, y, -0.03), (0.075, 0.04, 0.035)) for y in (-0.09, 0.09)),
    *(((0.06, y, -0.035), (0.04, 0.03, 0.03)) for y in (-0.09, 0.09)),
]  # fmt: skip


def build():
    """Builds the scene."""
    begin(60)
    box("Greenhouse bench", (2.6, 1.4, 0.06), (-0.3, 0, -0.03), colour=(0.45, 0.35, 0.25))
    walls = [((0.02, WIDE + 0.04, DEEP), (i * (LONG + 0.02) / 2, 0, FLOOR + DEEP / 2)) for i in (-1, 1)]
    walls += [((LONG, 0.02, DEEP), (0, j * (WIDE + 0.02) / 2, FLOOR + DEEP / 2)) for j in (-1, 1)]
    bottom = ((LONG + 0.04, WIDE + 0.04, FLOOR), (0, 0, FLOOR / 2))
    tray = boxes("Zinc tray", [bottom, *walls], colour=(0.6, 0.62, 0.65), metal=0.9, roughness=0.4)
    collider(tray, thickness=0.012, inner=0.04)
    collider(_ledge(), thickness=0.012, inner=0.1, damping=0.0)
    frog = _frog()
    soft(frog, mass=0.2, stiffness=0.04, bending=0, damping=3).settings.friction = 0.05
    effector(frog).subframes = 2
    _water()
    camera((0.75, -1.75, 1.15), (-0.1, 0, 0.3), lens=34)
    light(sun=2, elevation=65, sky=(0.4, 0.48, 0.44))


def _ledge():
    """Its top comes down to the brink."""
    x, z = BRINK
    back = x - 0.7
    profile = [(back, z + 0.7 * math.tan(STEEP)), (x, z), (x, 0), (back, 0)]
    points = [(i, y, k) for y in (-0.35, 0.35) for i, k in profile]
    faces = [(i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4) for i in range(4)] + [(3, 2, 1, 0), (4, 5, 6, 7)]
    return mesh("Granite ledge", points, faces, colour=(0.42, 0.4, 0.4), roughness=0.9)


def _frog():
    """Balls, melted into one skin; sits on the ledge and looks down."""
    green = {"colour": (0.15, 0.55, 0.1), "roughness": 0.35}
    balls = []
    for at, half in PARTS:
        balls.append(ball("Part", 1, detail=2, **green))
        balls[-1].data.transform(Matrix.LocRotScale(Vector(at), None, Vector(half)))
    frog = joined("Rubber frog", *balls)
    frog.data.remesh_voxel_size = 0.03
    bpy.context.view_layer.objects.active = frog
    bpy.ops.object.voxel_remesh()
    turn = Euler((0, STEEP, 0))
    down, up = turn.to_matrix() @ Vector((1, 0, 0)), turn.to_matrix() @ Vector((0, 0, 1))
    frog.location = Vector((BRINK[0], 0, BRINK[1])) - 0.17 * down + 0.082 * up
    frog.rotation_euler = turn
    return braced(smooth(frog))


def _water():
    """The domain's walls are the tray's: nothing leaks."""
    blue = {"colour": (0.6, 0.8, 0.85), "clear": 0.9, "roughness": 0.05}
    flow(box("Water at rest", (LONG, WIDE, WATER), (0, 0, FLOOR + WATER / 2)), behavior="GEOMETRY")
    water = box("Clear water", (LONG, WIDE, 0.48), (0, 0, FLOOR + 0.24), **blue)
    domain(water, resolution=42)
