"""The estimate of geometry against what Blender really makes: hardly below it, and not far above it."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
from places import REPO

from simworlds.installed import installed_bpy
from simworlds.sandbox.runtime import clean_environment

pytestmark = pytest.mark.blender

_SCRIPT = r"""
import json, sys
import bpy
from simworlds.sandbox.inside.scene_estimate import _Sizes

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
found = {}


def cube(kind=None, **settings):
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    if kind:
        new = obj.modifiers.new("M", kind)
        for key, value in settings.items():
            setattr(new, key, value)
    return obj


def nodes(*kinds, **settings):
    obj = cube("NODES")
    tree = obj.modifiers[0].node_group = bpy.data.node_groups.new("T", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    made = [tree.nodes.new(kind) for kind in ("NodeGroupInput", *kinds, "NodeGroupOutput")]
    for before, after in zip(made, made[1:]):
        starts = [socket for socket in before.outputs if socket.type == "GEOMETRY"]
        ends = [socket for socket in after.inputs if socket.type == "GEOMETRY"]
        if starts and ends:
            tree.links.new(starts[0], ends[0])
    for node in made:
        for socket in node.inputs:
            if socket.name.replace(" ", "_") in settings:
                socket.default_value = settings[socket.name.replace(" ", "_")]
    return obj, tree, made


def curve(**settings):
    bpy.ops.curve.primitive_bezier_circle_add()
    for key, value in settings.items():
        setattr(bpy.context.object.data, key, value)
    return bpy.context.object


def text(**settings):
    bpy.ops.object.text_add()
    bpy.context.object.data.body = "Sphinx of black quartz" * 5
    for key, value in settings.items():
        setattr(bpy.context.object.data, key, value)
    return bpy.context.object


def ball():
    bpy.ops.object.metaball_add(type="BALL", radius=2)
    bpy.context.object.data.resolution = 0.1
    return bpy.context.object


def stack():
    obj = cube("ARRAY", count=5)
    obj.modifiers.new("S", "SUBSURF").levels = 2
    obj.modifiers.new("M", "MIRROR").use_axis = (True, True, False)
    return obj


def instanced(realize):
    kinds = ["GeometryNodeMeshGrid", "GeometryNodeInstanceOnPoints"] + ["GeometryNodeRealizeInstances"] * realize
    obj, tree, made = nodes(*kinds, Vertices_X=10, Vertices_Y=10)
    ball = tree.nodes.new("GeometryNodeMeshUVSphere")
    tree.links.new(ball.outputs["Mesh"], made[2].inputs["Instance"])
    return obj


def tube():
    obj, tree, made = nodes("GeometryNodeCurvePrimitiveCircle", "GeometryNodeCurveToMesh", Resolution=40)
    profile = tree.nodes.new("GeometryNodeCurvePrimitiveCircle")
    tree.links.new(profile.outputs["Curve"], made[2].inputs["Profile Curve"])
    return obj


def repeated():
    obj, tree, made = nodes("GeometryNodeRepeatInput", "GeometryNodeSubdivideMesh", "GeometryNodeRepeatOutput")
    made[1].pair_with_output(made[3])
    made[3].repeat_items.clear()
    made[3].repeat_items.new("GEOMETRY", "Geometry")
    for before, after in zip(made, made[1:]):
        tree.links.new(next(s for s in before.outputs if s.type == "GEOMETRY"),
                       next(s for s in after.inputs if s.type == "GEOMETRY"))
    made[1].inputs["Iterations"].default_value = 4
    return obj


def grouped():
    obj, inner, _ = nodes("GeometryNodeSubdivideMesh", Level=3)
    outer_obj, outer, made = nodes("GeometryNodeGroup")
    made[1].node_tree = inner
    outer.links.new(made[0].outputs[0], made[1].inputs[0])
    outer.links.new(made[1].outputs[0], made[2].inputs[0])
    return outer_obj


WAYS = {
    "mesh": cube,
    "subdivision": lambda: cube("SUBSURF", levels=4),
    "array": lambda: cube("ARRAY", count=30),
    "fitted array": lambda: cube("ARRAY", fit_type="FIT_LENGTH", fit_length=40),
    "mirror": lambda: cube("MIRROR", use_axis=(True, True, True)),
    "screw": lambda: cube("SCREW", steps=40, iterations=3),
    "solidify": lambda: cube("SOLIDIFY"),
    "bevel": lambda: cube("BEVEL", segments=4),
    "round bevel": lambda: cube("BEVEL", segments=12, width=0.4, limit_method="NONE"),
    "voxels": lambda: cube("REMESH", mode="VOXEL", voxel_size=0.03),
    "blocks": lambda: cube("REMESH", mode="BLOCKS", octree_depth=5),
    "wireframe": lambda: cube("WIREFRAME"),
    "ocean": lambda: cube("OCEAN", viewport_resolution=8, repeat_x=2),
    "stack": stack,
    "curve": lambda: curve(),
    "tube": lambda: curve(bevel_depth=0.1, bevel_resolution=4),
    "text": lambda: text(),
    "thick text": lambda: text(extrude=0.1, bevel_depth=0.01, bevel_resolution=2),
    "metaball": ball,
    "grid of nodes": lambda: nodes("GeometryNodeMeshGrid", Vertices_X=70, Vertices_Y=50)[0],
    "ico sphere": lambda: nodes("GeometryNodeMeshIcoSphere", Subdivisions=5)[0],
    "cylinder": lambda: nodes("GeometryNodeMeshCylinder", Vertices=50, Side_Segments=9, Fill_Segments=5)[0],
    "cuboid": lambda: nodes("GeometryNodeMeshCube", Vertices_X=9, Vertices_Y=8, Vertices_Z=7)[0],
    "subdivided": lambda: nodes("GeometryNodeSubdivideMesh", Level=5)[0],
    "duplicated": lambda: nodes("GeometryNodeDuplicateElements", Amount=50)[0],
    "extruded": lambda: nodes("GeometryNodeExtrudeMesh")[0],
    "scattered": lambda: nodes("GeometryNodeDistributePointsOnFaces", Density=50.0)[0],
    "instanced": lambda: instanced(0),
    "realized": lambda: instanced(1),
    "tube of nodes": tube,
    "repeated": repeated,
    "grouped": grouped,
}
for name, make in WAYS.items():
    obj = make()
    sizes = _Sizes(scene, False)
    sizes.add(obj)
    estimate = sizes.of[obj]
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(graph)
    whole = evaluated.evaluated_geometry()
    counts = [len(part.vertices) if hasattr(part, "vertices") else len(part.points) for part in
              (whole.mesh, whole.pointcloud, whole.curves) if part is not None]
    faces = len(whole.mesh.polygons) if whole.mesh is not None else 0
    if obj.type in {"CURVE", "FONT", "META"}:
        mesh = evaluated.to_mesh()
        counts, faces = [len(mesh.vertices)], len(mesh.polygons)
    shown = sum(one.is_instance for one in graph.object_instances)
    found[name] = (estimate.points, max([faces, *counts], default=0), estimate.instances, shown)
    bpy.data.objects.remove(obj)
    for other in list(bpy.data.objects):
        bpy.data.objects.remove(other)
sys.stdout.write(f"\nFOUND{json.dumps(found)}\n")
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[int, int, int, int]]:
    """Name → points as estimated and as made, instances as estimated and as shown."""
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    environment = clean_environment(tmp_path_factory.mktemp("settings")) | {"PYTHONPATH": str(REPO)}
    done = subprocess.run(
        [sys.executable, "-P", "-c", _SCRIPT], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    return json.loads(done.stdout.partition("\nFOUND")[2].splitlines()[0])


def test_no_estimate_is_far_from_what_is_made(found: dict[str, tuple[int, int, int, int]]) -> None:
    assert len(found) > 30
    wrong = {
        name: (estimate, made)
        for name, (estimate, made, _, _) in found.items()
        if not 0.9 * made <= estimate <= 8 * made + 100
    }
    assert wrong == {}


def test_instances_of_nodes_are_counted(found: dict[str, tuple[int, int, int, int]]) -> None:
    assert found["instanced"][2:] == [100, 100]
    assert found["realized"][2:] == [0, 0]
