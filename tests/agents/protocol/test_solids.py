"""Distances and depths between evaluated surfaces, against what geometry says they are."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

import pytest
from scenes import SOON, build, measured, measures
from whole import IS_WHOLE

from agents.protocol.measures.geometry import (
    CrossingsRequest,
    ExtentsRequest,
    GapRequest,
    PiecesRequest,
    SurfaceRequest,
)
from agents.protocol.measures.requests import Unmeasured
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

ALONE = "def add(one):\n    scene.collection.objects.link(one)\n    return one\n"
R2, R3 = 2**0.5, 3**0.5
ON_ITS_CORNER = math.degrees(math.atan(1 / R2))


def made(session: LiveSession, script: str) -> None:
    build(session, ALONE + script)


def gap(session: LiveSession, a: str = "A", b: str = "B") -> float:
    return measured(session, GapRequest((a,), (b,))).distance


def depth(session: LiveSession, *names: str) -> float | None:
    """How deep the deepest pair is in each other; None if none shares space."""
    pairs = measured(session, CrossingsRequest(names or ("A", "B"))).pairs
    assert all(pair.undecided == "" for pair in pairs)
    return max((pair.depth for pair in pairs if pair.depth is not None), default=None)


# Distances

APART = {
    "faces": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0.3, 0.3, 1.005), (0.6, 0.6, 2)))', 0.005),
    "a corner and a face": (
        'add(box("A", (-3, -3, -1), (3, 3, 0)))\n'
        f'add(box("B", (-1, -1, -1), (1, 1, 1), at=(0.2, 0.1, {R3 + 0.01}), turn=(45, {ON_ITS_CORNER}, 0)))',
        0.01,
    ),
    "crossed edges": (
        'add(box("A", (-2, -1, -1), (2, 1, 1), turn=(45, 0, 0)))\n'
        f'add(box("B", (-1, -2, -1), (1, 2, 1), at=(0.3, 0.4, {2 * R2 + 0.003}), turn=(0, 45, 0)))',
        0.003,
    ),
    "edges at a small angle": (
        'add(box("A", (-5, -1, -1), (5, 1, 1), turn=(45, 0, 0)))\n'
        f'add(box("B", (-5, -1, -1), (5, 1, 1), at=(0, 0, {2 * R2 + 0.003}), turn=(45, 0, 2)))',
        0.003,
    ),
    "far edges": (
        'add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (4, 5, -0.5), (6, 6, 1.5)))',
        5.0,
    ),
    "diagonal corners": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (2, 3, 3), (4, 4, 4)))', 3.0),
    "a ball over a floor": ('add(ball("A", 0.5, at=(0, 0, 0.507)))\nadd(plane("B", (-9, -9), (9, 9)))', 0.007),
    "a box in a box": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0.4, 0.4, 0.4), (0.5, 0.5, 0.5)))', 0.4),
    "two sheets": (
        'add(plane("A", (-1, -1), (1, 1)))\nadd(plane("B", (-1, -1), (1, 1), at=(1.5, 0, 0.004), turn=(0, 0, 30)))',
        0.004,
    ),
    "sheets side by side": ('add(plane("A", (0, 0), (1, 1)))\nadd(plane("B", (1.002, 0), (2, 1)))', 0.002),
    "a hundred metres away": (
        'add(box("A", (0, 0, 0), (1, 1, 1), at=(100, 100, 0)))\n'
        'add(box("B", (0, 0, 1.005), (1, 1, 2), at=(100, 100, 0)))',
        0.005,
    ),
    "very small": (
        'add(box("A", (0, 0, 0), (1e-3, 1e-3, 1e-3)))\nadd(box("B", (0, 0, 2e-3), (1e-3, 1e-3, 3e-3)))', 1e-3,
    ),
    "very large": ('add(box("A", (-500, -500, -1), (500, 500, 0)))\nadd(box("B", (0, 0, 0.02), (0.1, 0.1, 1)))', 0.02),
    "crossing": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0.5, 0.5, 0.5), (2, 2, 2)))', 0.0),
}  # fmt: skip


@pytest.mark.parametrize(("script", "distance"), APART.values(), ids=APART)
def test_distances_are_exact(session: LiveSession, script: str, distance: float) -> None:
    made(session, script)
    found = measured(session, GapRequest(("A",), ("B",)))
    back = measured(session, GapRequest(("B",), ("A",)))
    assert found.distance == pytest.approx(distance, abs=2e-6)
    assert back.distance == pytest.approx(found.distance, abs=1e-6)
    assert math.dist(found.here, found.there) == pytest.approx(distance, abs=1e-5)


def test_of_several_surfaces_the_nearest_two_count(session: LiveSession) -> None:
    made(
        session,
        'for k in range(5):\n    add(box(f"L{k}", (k, 0, 0), (k + 0.1, 1, 1)))\n'
        '    add(box(f"R{k}", (k, 2 + k / 10, 0), (k + 0.1, 3, 1)))',
    )
    lefts, rights = (tuple(f"{side}{k}" for k in range(5)) for side in "LR")
    found = measured(session, GapRequest(lefts, rights))
    assert found.distance == pytest.approx(1, abs=1e-6)
    assert (found.here[1], found.there[1]) == (pytest.approx(1), pytest.approx(2))


# Depths

FLOOR = 'add(box("A", (-3, -3, -0.2), (3, 3, 0)))\n'
SHEET = 'add(plane("A", (-2, -2), (2, 2)))\n'
FINE = """
def fine(name, half, cuts=40, **where):
    shape = bmesh.new()
    bmesh.ops.create_grid(shape, x_segments=cuts, y_segments=cuts, size=half)
    data = bpy.data.meshes.new(name)
    shape.to_mesh(data)
    made = mesh(name, [], [], **where)
    made.data = data
    return add(made)
"""
TABLE = """
parts = [box("Top", (-0.6, -0.6, 0.7), (0.6, 0.6, 0.74))]
parts += [box("Leg", (x - 0.03, y - 0.03, -0.005), (x + 0.03, y + 0.03, 0.7)) for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
shape = bmesh.new()
for part in parts:
    shape.from_mesh(part.data)
data = bpy.data.meshes.new("B")
shape.to_mesh(data)
add(bpy.data.objects.new("B", data))
"""
DEEP = {
    "a box in a slab": (FLOOR + 'add(box("B", (-0.5, -0.5, -0.005), (0.5, 0.5, 1)))', 0.005),
    "a box in a sheet": (SHEET + 'add(box("B", (-0.5, -0.5, -0.005), (0.5, 0.5, 1)))', 0.005),
    "the legs of a table in a slab": (FLOOR + TABLE, 0.005),
    "the legs of a table in a sheet": (SHEET + TABLE, 0.005),
    "two balls": ('add(ball("A", 0.5))\nadd(ball("B", 0.5, at=(0, 0, 0.9)))', 0.1),
    "a ball in a slab": (FLOOR + 'add(ball("B", 0.5, at=(0, 0, 0.46)))', 0.04),
    "a ball through a sheet": (SHEET + 'add(ball("B", 0.5))', 0.5),
    "a ball through a fine sheet": (FINE + 'fine("A", 2)\nadd(ball("B", 0.5, at=(0.01, 0.02, 0.45)))', 0.05),
    "a ball through paper": ('add(box("A", (-2, -2, -0.0005), (2, 2, 0.0005)))\nadd(ball("B", 0.3))', 0.3),
    "a beam through a wall": (
        'add(box("A", (-2, -0.1, -2), (2, 0.1, 2)))\nadd(box("B", (-0.05, -1, -0.05), (0.05, 1, 0.05)))', 0.1,
    ),
    "crossed beams": (
        'add(box("A", (-10, -0.05, -0.05), (1, 0.05, 0.05)))\n'
        'add(box("B", (-0.05, -1, -0.147), (0.05, 7, -0.047)))', 0.003,
    ),
    "crossed edges": (  # below the edge of the one, and from there to the nearest face of the other
        'add(box("A", (-2, -1, -1), (2, 1, 1), turn=(45, 0, 0)))\n'
        f'add(box("B", (-1, -2, -1), (1, 2, 1), at=(0, 0, {2 * R2 - 0.02}), turn=(0, 45, 0)))', 0.02 / R2,
    ),
    "a box in a box": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0.4, 0.4, 0.4), (0.6, 0.6, 0.6)))', 0.6),
    "the same box twice": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0, 0, 0), (1, 1, 1)))', 1.0),
    "boxes with faces in common": ('add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0.3, 0, 0), (1.3, 1, 1)))', 0.7),
    "a drawer flush with its cabinet": (
        'add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (0, 0.4, 0.4), (0.2, 0.6, 0.6)))', 0.2,
    ),
    "a plug that is too wide": (
        'add(lathe("A", [(0.3, 0), (0.6, 0), (0.6, 0.2), (0.3, 0.2), (0.3, 0)]))\n'
        'add(lathe("B", [(0, -0.1), (0.302, -0.1), (0.302, 0.3), (0, 0.3)]))', 0.002,
    ),
    "sheets that cross in their middles": (
        FINE + 'fine("A", 1)\nfine("B", 0.5, turn=(90, 0, 0))', 0.5,
    ),
    "a sheet that dips into another one": (
        'add(plane("A", (-0.1, -1), (0.1, 1)))\n'
        'add(plane("B", (-1, -0.5), (1, 0.5), at=(0, 0, 0.497), turn=(90, 0, 0)))', 0.003,
    ),
    "a cloth over a table": (  # its middle lies 4 mm too low
        FINE + 'fine("A", 0.8)\nfor point in bpy.data.objects["A"].data.vertices:\n'
        '    out = max(abs(point.co.x), abs(point.co.y)) - 0.53\n    point.co.z = -out if out > 0 else -0.004\n'
        'add(box("B", (-0.5, -0.5, -0.04), (0.5, 0.5, 0)))', 0.004,
    ),
    "a box turned inside out": (
        FLOOR + 'add(box("B", (-0.5, -0.5, -0.005), (0.5, 0.5, 1))).data.flip_normals()', 0.005,
    ),
    "normals every way": (
        FLOOR + 'odd = add(box("B", (-0.5, -0.5, -0.005), (0.5, 0.5, 1)))\n'
        'for face in list(odd.data.polygons)[::2]:\n    face.flip()\nodd.data.update()', 0.005,
    ),
    "a mirrored box": (FLOOR + 'add(box("B", (-0.5, -0.5, -1), (0.5, 0.5, 0.005))).scale.z = -1', 0.005),
    "a box that hangs together at an edge only": (
        FLOOR + 'shape = bmesh.new()\nshape.from_mesh(box("One", (-0.5, -0.5, -0.005), (0, 0, 1)).data)\n'
        'shape.from_mesh(box("Two", (0, 0, -0.005), (0.5, 0.5, 1)).data)\n'
        'bmesh.ops.remove_doubles(shape, verts=shape.verts, dist=1e-5)\ndata = bpy.data.meshes.new("B")\n'
        'shape.to_mesh(data)\nadd(bpy.data.objects.new("B", data))', 0.005,
    ),
    "a solid with a loose face": (
        FLOOR + 'points = [(-1, -1, -0.005), (1, -1, -0.005), (0, 1, -0.005), (0, 0, 2)]\n'
        'points += [(5, 5, 5), (6, 5, 5), (5, 6, 5)]\n'
        'add(mesh("B", points, [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3), (4, 5, 6)]))', 0.005,
    ),
}  # fmt: skip


@pytest.mark.parametrize(("script", "expected"), DEEP.values(), ids=DEEP)
def test_depths_are_what_geometry_says(session: LiveSession, script: str, expected: float) -> None:
    made(session, script)
    found, back = depth(session), depth(session, "B", "A")
    assert found == pytest.approx(expected, rel=0.02, abs=3e-5)
    assert back == pytest.approx(expected, rel=0.02, abs=3e-5)


TOUCHING = {
    "a box on a slab": FLOOR + 'add(box("B", (-0.5, -0.5, 0), (0.5, 0.5, 1), turn=(0, 0, 33)))',
    "a box at the edge of a slab": FLOOR + 'add(box("B", (2.5, -0.5, 0), (3.5, 0.5, 1)))',
    "boxes face to face": 'add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (1, 0, 0), (2, 1, 1)))',
    "boxes edge to edge": 'add(box("A", (0, 0, 0), (1, 1, 1)))\nadd(box("B", (1, 1, 0), (2, 2, 1)))',
    "a chair under a table": 'add(box("A", (-0.2, -0.2, 0), (0.2, 0.2, 0.45)))\n' + TABLE,
    "a ball in a bowl": (
        'add(lathe("A", [(0, 0), (0.3, 0.2), (0.29, 0.2), (0, 0.02)]))\nadd(ball("B", 0.05, at=(0, 0, 0.09)))'
    ),
    "a plug that fits": (
        'add(lathe("A", [(0.3, 0), (0.6, 0), (0.6, 0.2), (0.3, 0.2), (0.3, 0)]))\n'
        'add(lathe("B", [(0, -0.1), (0.3, -0.1), (0.3, 0.3), (0, 0.3)]))'
    ),
    "a ring around a ball": (
        'add(lathe("A", [(0.3, 0), (0.6, 0), (0.6, 0.2), (0.3, 0.2), (0.3, 0)]))\nadd(ball("B", 0.1))'
    ),
    "a sheet on its rim": SHEET + 'add(plane("B", (-1, -0.5), (1, 0.5), at=(0, 0, 0.5), turn=(90, 0, 20)))',
    "a cloth on a table": FINE + 'fine("A", 0.4)\nadd(box("B", (-0.5, -0.5, -0.04), (0.5, 0.5, 0)))',
    "something in an open bin": (
        'add(mesh("A", [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))],'
        " [(0, 3, 2, 1), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]))\n"
        'add(box("B", (0.2, 0.2, 0), (0.4, 0.4, 0.5)))'
    ),
    "turned boxes face to face": (
        'add(box("A", (0, 0, 0), (1, 1, 1), at=(3, 7, 1), turn=(12, 34, 56)))\n'
        'add(box("B", (1, 0.2, -0.5), (2, 0.9, 0.6), at=(3, 7, 1), turn=(12, 34, 56)))'
    ),
}  # fmt: skip


@pytest.mark.parametrize("script", TOUCHING.values(), ids=TOUCHING)
def test_what_touches_or_is_beside_each_other_shares_no_space(session: LiveSession, script: str) -> None:
    made(session, script)
    assert (depth(session) or 0.0) < 5e-5


# What is evaluated

NODES = """
def nodes(name, build):
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    build(tree, tree.nodes.new("NodeGroupInput").outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    return tree

def scattered(tree, given, out):
    made, cube = tree.nodes.new("GeometryNodeInstanceOnPoints"), tree.nodes.new("GeometryNodeMeshCube")
    cube.inputs["Size"].default_value = (0.2, 0.2, 0.2)
    tree.links.new(given, made.inputs["Points"])
    tree.links.new(cube.outputs[0], made.inputs["Instance"])
    tree.links.new(made.outputs[0], out)

def beside(tree, given, out):
    joined = tree.nodes.new("GeometryNodeJoinGeometry")
    scattered(tree, given, joined.inputs[0])
    tree.links.new(given, joined.inputs[0])
    tree.links.new(joined.outputs[0], out)

def realised(tree, given, out):
    real = tree.nodes.new("GeometryNodeRealizeInstances")
    scattered(tree, given, real.inputs[0])
    tree.links.new(real.outputs[0], out)
"""
CUBE = 'cube = box("Cube", (-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))\n'
CURVE = """
bent = bpy.data.curves.new("B", "CURVE")
bent.dimensions = "3D"
line = bent.splines.new("POLY")
line.points.add(1)
line.points[0].co, line.points[1].co = (-1, 0, 0, 1), (1, 0, 0, 1)
"""
# What reaches from -0.5 to 0.5 (text: not below 0), in every way that Blender has of showing it.
SEEN = {
    "a mesh": CUBE + 'add(cube).name = "B"',
    "a linked duplicate": CUBE + 'add(cube).location.x = 5\nadd(bpy.data.objects.new("B", cube.data))',
    "a scaled parent": CUBE + 'add(cube).name, cube.scale = "B", (0.1, 0.1, 0.1)\n'
    'cube.parent = add(bpy.data.objects.new("P", None))\ncube.parent.scale = (10, 10, 10)',
    "a mirrored parent": CUBE + 'add(cube).name = "B"\ncube.parent = add(bpy.data.objects.new("P", None))\n'
    "cube.parent.scale = (-1, 1, 1)",
    "a collection's instance": CUBE + 'kept = bpy.data.collections.new("Kept")\nkept.objects.link(cube)\n'
    'maker = add(bpy.data.objects.new("B", None))\nmaker.instance_type, maker.instance_collection = "COLLECTION", kept',
    "an instance of an instance": CUBE + 'inner, outer = map(bpy.data.collections.new, ("Inner", "Outer"))\n'
    'inner.objects.link(cube)\nfirst = bpy.data.objects.new("First", None)\nouter.objects.link(first)\n'
    'first.instance_type, first.instance_collection, first.scale = "COLLECTION", inner, (0.5, 0.5, 0.5)\n'
    'maker = add(bpy.data.objects.new("B", None))\nmaker.scale = (2, 2, 2)\n'
    'maker.instance_type, maker.instance_collection = "COLLECTION", outer',
    "instances of vertices": CUBE + 'cube.data.transform(Matrix.Scale(0.8, 4))\nadd(cube).name = "B"\n'
    'cube.instance_type = "VERTS"\nadd(box("C", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1))).parent = cube',
    "nodes that make instances": NODES + CUBE + 'cube.data.transform(Matrix.Scale(0.8, 4))\nadd(cube).name = "B"\n'
    'cube.modifiers.new("N", "NODES").node_group = nodes("N", scattered)',
    "nodes that add instances": NODES + CUBE + 'cube.data.transform(Matrix.Scale(0.8, 4))\nadd(cube).name = "B"\n'
    'cube.modifiers.new("N", "NODES").node_group = nodes("N", beside)',
    "nodes that realise instances": NODES + CUBE + 'cube.data.transform(Matrix.Scale(0.8, 4))\nadd(cube).name = "B"\n'
    'cube.modifiers.new("N", "NODES").node_group = nodes("N", realised)',
    "a modifier": CUBE + 'cube.data.transform(Matrix.Scale(0.5, 4, (0, 0, 1)))\n'
    "cube.data.transform(Matrix.Translation((0, 0, 0.25)))\n"
    'add(cube).name = "B"\ncube.modifiers.new("M", "MIRROR").use_axis = (False, False, True)',
    "a curve": CURVE + 'bent.bevel_depth, bent.use_fill_caps = 0.5, True\nadd(bpy.data.objects.new("B", bent))',
    "an extruded curve": CURVE + 'bent.extrude = 0.5\nadd(bpy.data.objects.new("B", bent))',
    "a surface": "bpy.ops.surface.primitive_nurbs_surface_torus_add(radius=1)\nmade = bpy.context.object\n"
    'made.name = "B"\nmade.scale.z = 0.5 / max(point.co.z for point in made.to_mesh().vertices)',
    "a meta ball": 'balls = bpy.data.metaballs.new("B")\nballs.elements.new()\nballs.resolution = 0.05\n'
    'made = add(bpy.data.objects.new("B", balls))\nbpy.context.view_layer.update()\n'
    "shown = made.evaluated_get(bpy.context.evaluated_depsgraph_get())\n"
    "high = max(point.co.z for point in shown.to_mesh().vertices)\nmade.scale = (0.5 / high,) * 3",
    "text": 'text = bpy.data.curves.new("B", "FONT")\ntext.body, text.extrude = "I", 0.5\n'
    'add(bpy.data.objects.new("B", text))',
}  # fmt: skip


@pytest.mark.parametrize("script", SEEN.values(), ids=SEEN)
def test_what_is_seen_is_measured_and_told_in_the_facts(session: LiveSession, script: str) -> None:
    made(session, FLOOR + 'bpy.data.objects["A"].location.z = -0.51\n' + script)
    assert gap(session) == pytest.approx(0.01, abs=2e-4)
    high = measured(session, ExtentsRequest(("B",))).high
    assert high[2] == pytest.approx(0.5, abs=2e-4)
    told = session.blender.call("scene_facts", {}, unread, timeout=60).value["objects"]
    facts = next(one for one in told if one["name"] == "B")
    assert facts["surface"]
    assert facts["polygons"] > 0
    assert facts["box"]["high"] == pytest.approx(high, abs=1e-5)


def test_text_is_there_once(session: LiveSession) -> None:
    made(session, SEEN["text"])
    found = measured(session, SurfaceRequest("B"))
    assert (found.open_edges, found.parts) == (0, 1)
    size = measured(session, ExtentsRequest(("B",))).size
    assert found.volume == pytest.approx(size[0] * size[1] * size[2], rel=1e-3)


@pytest.mark.parametrize(
    "script",
    [
        'add(bpy.data.objects.new("B", None))',
        'add(bpy.data.objects.new("B", bpy.data.lights.new("B", "POINT")))',
        'add(bpy.data.objects.new("B", bpy.data.meshes.new("B")))',
        'add(mesh("B", [(0, 0, 0), (0, 0, 1)], []))',
        CURVE + 'add(bpy.data.objects.new("B", bent))',
        'add(bpy.data.objects.new("B", bpy.data.hair_curves.new("B")))',
        'add(bpy.data.objects.new("B", bpy.data.volumes.new("B")))',
        'for name in "CB":\n    add(bpy.data.objects.new(name, bpy.data.metaballs.new(name)))',
    ],
)
def test_what_has_no_faces_has_no_surface(session: LiveSession, script: str) -> None:
    made(session, FLOOR + script)
    with pytest.raises(Unmeasured, match="'B' has no surface"):
        gap(session)
    assert measured(session, CrossingsRequest(("A", "B"))).pairs == ()
    told = session.blender.call("scene_facts", {}, unread, timeout=60).value["objects"]
    assert not next(one for one in told if one["name"] == "B")["surface"]


@pytest.mark.parametrize(
    ("hide", "rendered", "evaluated"),
    [
        ("", True, True),
        ("cube.hide_set(True)", True, True),  # the eye in the outliner: renders show it
        ("cube.hide_viewport = True", True, False),
        ("cube.hide_render = True", False, True),
        ("kept.hide_viewport = True", True, False),
        ("kept.hide_render = True", False, True),
        ("layer.exclude = True", False, False),
        # In another collection, it is still shown.
        ("kept.hide_render = True\nscene.collection.objects.link(cube)", True, True),
        ("layer.exclude = True\nscene.collection.objects.link(cube)", True, True),
        ('scene.view_layers.new("Other")\nlayer.exclude = True', True, False),
        ('scene.view_layers.new("Other").use = False\nlayer.exclude = True', False, False),
        ("kept.children.link(inner)\ninner.objects.link(cube)\nkept.objects.unlink(cube)\nkept.hide_render = True",
         False, True),
    ],
)  # fmt: skip
def test_what_is_hidden_is_told_apart(
    session: LiveSession, hide: str, rendered: bool, evaluated: bool
) -> None:
    script = 'kept, inner = bpy.data.collections.new("Kept"), bpy.data.collections.new("Inner")\n'
    script += "scene.collection.children.link(kept)\nkept.objects.link(cube)\n"
    script += 'layer = bpy.context.view_layer.layer_collection.children["Kept"]\n'
    made(session, CUBE + script + hide)
    told = session.blender.call("scene_facts", {}, unread, timeout=60).value["objects"]
    facts = next(one for one in told if one["name"] == "Cube")
    assert (facts["rendered"], facts["evaluated"]) == (rendered, evaluated)
    assert facts["surface"]
    if evaluated:
        assert measured(session, SurfaceRequest("Cube")).polygons == 12
    else:
        with pytest.raises(Unmeasured, match="not evaluated"):
            measured(session, SurfaceRequest("Cube"))


def test_objects_of_other_scenes_are_not_there(session: LiveSession) -> None:
    made(session, FLOOR + CUBE + 'bpy.data.scenes.new("Other").collection.objects.link(cube)')
    with pytest.raises(Unmeasured, match="no object 'Cube' in the scene"):
        gap(session, "A", "Cube")


# Meshes as such


@pytest.mark.parametrize(
    ("script", "open_edges", "volume", "area", "parts"),
    [
        ('add(box("B", (0, 0, 0), (1, 2, 3)))', 0, 6, 22, 1),
        ('add(box("B", (0, 0, 0), (1, 2, 3))).scale = (-2, 1, 1)', 0, 12, 32, 1),
        ('add(plane("B", (0, 0), (1, 2)))', 4, 0, 2, 1),
        (TABLE, 0, 1.2 * 1.2 * 0.04 + 4 * 0.06**2 * 0.705, None, 5),
        ('add(mesh("B", [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, -1)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)]))',
         7, 0, 1.5, 1),
    ],
)  # fmt: skip
def test_a_mesh_is_told_as_it_is(
    session: LiveSession, script: str, open_edges: int, volume: float, area: float | None, parts: int
) -> None:
    made(session, script)
    found = measured(session, SurfaceRequest("B"))
    assert (found.finite, found.open_edges, found.parts) == (True, open_edges, parts)
    assert found.volume == pytest.approx(volume, rel=1e-5)
    assert area is None or found.area == pytest.approx(area, rel=1e-5)


# Much of it


@pytest.mark.parametrize(
    ("levels", "vertices"), [(3, 250_000), pytest.param(4, 1_000_000, marks=pytest.mark.whole)]
)
def test_meshes_of_a_million_vertices_are_measured_in_seconds(
    session: LiveSession, levels: int, vertices: int
) -> None:
    made(
        session,
        FINE + 'dense = fine("A", 1, 63).modifiers.new("S", "SUBSURF")\n'
        f'dense.subdivision_type, dense.levels = "SIMPLE", {levels}\n'
        'add(ball("B", 0.3, at=(0.1, 0.2, 0.31)))\nadd(ball("C", 0.3, at=(0.1, 0.2, -0.295)))',
    )
    surface, apart, crossing = (
        SurfaceRequest("A"),
        GapRequest(("A",), ("B",)),
        CrossingsRequest(("A", "B", "C")),
    )
    began = time.perf_counter()
    found = measures(session, surface, apart, crossing)
    assert time.perf_counter() - began < SOON
    assert found[surface].vertices > vertices
    assert found[apart].distance == pytest.approx(0.01, abs=1e-6)
    assert [{pair.a, pair.b} for pair in found[crossing].pairs] == [{"A", "C"}]
    assert found[crossing].pairs[0].depth == pytest.approx(0.005, rel=0.02)


def test_the_same_dense_mesh_twice_is_no_trouble(session: LiveSession) -> None:
    levels = 4 if IS_WHOLE else 3
    made(
        session,
        'for name in "AB":\n    dense = add(ball(name, 0.5)).modifiers.new("S", "SUBSURF")\n'
        f"    dense.levels = {levels}",
    )
    found = depth(session)
    assert found is not None
    assert 0.9 < found <= 1


def test_thousands_of_parts_are_looked_at_in_seconds(session: LiveSession) -> None:
    made(
        session,
        'cube = box("Cube", (0, 0, 0), (1, 1, 1))\nfor k in range(2500):\n'
        '    add(bpy.data.objects.new(f"P{k}", cube.data)).location = (k % 50, k // 50, 0)',
    )
    names = tuple(f"P{k}" for k in range(2500))
    began = time.perf_counter()
    assert len(measured(session, PiecesRequest(names, 0.002, 0.005, 0.01)).pieces) == 1
    assert depth(session, *names) is None
    assert time.perf_counter() - began < SOON
