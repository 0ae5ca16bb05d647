# SPDX-License-Identifier: GPL-3.0-or-later
"""A toy barge lurches forward in a channel, and ploughs up a wave; the crates on its deck topple."""

from ..props import box, boxes, mesh
from ..scene_setup import begin, camera, keys, light
from ..simulation_parts import body, domain, effector, flow

STONE = (0.45, 0.43, 0.4)
PINE = (0.75, 0.52, 0.28)
# Half of the deck's outline, from the stern to the bow; the other half mirrors it.
OUTLINE = [(-0.4, -0.17), (0.2, -0.17), (0.36, -0.1), (0.45, 0.0)]


def build():
    """Builds the scene."""
    begin(60)
    sides = [((3.0, 0.12, 0.4), (0, 0.46 * side, 0.15)) for side in (-1, 1)]
    ends = [((0.12, 0.8, 0.4), (1.44 * side, 0, 0.15)) for side in (-1, 1)]
    boxes("Stone channel", [((3.0, 1.04, 0.1), (0, 0, -0.1)), *sides, *ends], colour=STONE)
    box("Lawn", (12, 12, 0.1), (0, 0, -0.2), colour=(0.12, 0.3, 0.08))
    barge = hull("Tin barge", (-0.85, 0, 0.14), colour=(0.55, 0.12, 0.1), metal=0.6, roughness=0.4)
    keys(barge, "location", {6: (-0.85, 0, 0.14), 36: (0.75, 0, 0.14)})
    body(barge, "PASSIVE", shape="MESH", friction=1.0, moved=True)
    effector(barge).subframes = 1  # it is fast for the cells
    for number, x in enumerate((-1.0, -0.72)):
        crate = box(f"Pine crate {number + 1}", (0.07, 0.1, 0.24), (x, 0, 0.5), colour=PINE)
        body(crate, shape="BOX", mass=0.5, friction=1.0)  # they topple before they slide far
    flow(box("Water at rest", (3.0, 1.0, 0.5), (0, 0, -0.05)), behavior="GEOMETRY")
    water = box(
        "Channel water", (2.8, 0.84, 0.7), (0, 0, 0.27), colour=(0.12, 0.32, 0.36), clear=0.4, roughness=0.05
    )
    domain(water, resolution=80)
    camera((1.5, -2.0, 1.35), (0.0, 0, 0.2), lens=30)
    light(sun=4, elevation=35)


def hull(name, at, **look):
    """A flat-bottomed hull whose deck lies below its rim, as rings of points from the keel to the deck."""
    line = [*OUTLINE, *((x, -y) for x, y in OUTLINE[-2::-1])]
    levels = [(0.9, -0.1), (1.0, 0.26), (0.95, 0.26), (0.95, 0.24)]
    points = [(x * scale, y * scale, z) for scale, z in levels for x, y in line]
    count = len(line)
    faces = [tuple(reversed(range(count))), tuple(range(3 * count, 4 * count))]
    for level in range(3):
        for one in range(count):
            two = (one + 1) % count
            low, high = level * count, (level + 1) * count
            faces.append((low + one, low + two, high + two, high + one))
    return mesh(name, points, faces, at, **look)
