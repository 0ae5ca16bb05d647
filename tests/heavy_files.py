"""Files that would take hours or all memory to evaluate, each made in a real Blender within milliseconds."""

from __future__ import annotations

import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from simworlds.installed import installed_bpy
from simworlds.sandbox.runtime import clean_environment

if TYPE_CHECKING:
    from pathlib import Path

# Name → a part of what every refusal of it says.
HEAVY = {
    "subdivision": "modifier 'Sub.002' (number 3 of its stack) with 6 levels",
    "multires": "modifier 'Sub' (number 2 of its stack) with 11 levels",
    "array": "modifier 'Array' with count 1,000,000,000",
    "long_array": "modifier 'Array' with length 1e+09 in steps of 1",
    "remesh": "modifier 'Remesh' with voxel size 1e-06",
    "blocks": "modifier 'Remesh' with octree depth 24",
    "screw": "modifier 'Screw' with 10,000 steps, 10,000 iterations",
    "ocean": "modifier 'Ocean' with resolution 1024",
    "fluid": "modifier 'Fluid' with 10000 divisions",
    "keyed": "modifier 'Array' with count 100,000,000",
    "later": "modifier 'Array' with count 100,000,000",
    "numbered": "modifier 'Array' with count 100,000,000",
    "driven": "modifier 'Array' with count 1,000,000,000",
    "text": "object 'Text' with bevel resolution 32, resolution 64",
    "metaball": "object 'Ball' with resolution 0.005",
    "together": "all objects together",
    "objects": "the file would come to 20,001 objects; the limit is 20,000",
    "instances": "what its instances show (most by object 'All')",
    "corners": "what its instances show (most by object 'Sheet')",
    "particles": "object 'Sheet', would come to 10,000,000 particles",
    "children": "particles; the limit is 2,000,000",
    "frames": "the clip of scene 'Heavy' would come to 1,000,000 frames",
    "image": "image 'Huge' (60000 × 60000) would come to 3,600,000,000 pixels",
    "packed": "image 'Packed' (60000 × 60000) would come to 3,600,000,000 pixels",
    "grid": "modifier 'Nodes' with node 'Grid'",
    "realized": "modifier 'Nodes' with node 'Realize Instances'",
}
# Like heavy ones, but within the limits.
LIGHT = ("fine", "driven_little", "switched_off", "simplified", "shared", "rendered")

_SCRIPT = r'''
import os, struct, sys, zlib
import bpy

folder = sys.argv[1]
nothing = bpy.context.scene


def made(name, data):
    obj = bpy.data.objects.new(name, data)
    scene.collection.objects.link(obj)
    return obj


def sheet(name="Sheet", across=1):
    mesh = bpy.data.meshes.new(name)
    points = [(x, y, 0) for x in range(across + 1) for y in range(across + 1)]
    step = across + 1
    corners = [(x * step + y, (x + 1) * step + y, (x + 1) * step + y + 1, x * step + y + 1)
               for x in range(across) for y in range(across)]
    mesh.from_pydata(points, [], corners)
    return made(name, mesh)


def modifier(obj, kind, name, **settings):
    new = obj.modifiers.new(name, kind)
    for key, value in settings.items():
        setattr(new, key, value)
    return new


def _subdivisions(obj, *levels):
    for level in levels:
        modifier(obj, "SUBSURF", "Sub", levels=level)


def subdivision():
    _subdivisions(sheet(), 6, 6, 6)


def multires():
    obj = sheet(across=10)
    modifier(obj, "MULTIRES", "Multires")
    _subdivisions(obj, 11)


def array():
    obj = sheet()
    for _ in range(2):
        modifier(obj, "ARRAY", "Array", count=10**9)


def long_array():
    modifier(sheet(), "ARRAY", "Array", fit_type="FIT_LENGTH", fit_length=1e9)


def remesh():
    modifier(sheet(), "REMESH", "Remesh", mode="VOXEL", voxel_size=1e-6)


def blocks():
    modifier(sheet(), "REMESH", "Remesh", mode="BLOCKS", octree_depth=24)


def screw():
    modifier(sheet(), "SCREW", "Screw", steps=10000, iterations=10000)


def ocean():
    modifier(sheet(), "OCEAN", "Ocean", viewport_resolution=1024)


def fluid():
    mesh = bpy.data.meshes.new("Box")
    mesh.from_pydata([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], [], [(0, 1, 3, 2), (4, 5, 7, 6)])
    domain = modifier(made("Box", mesh), "FLUID", "Fluid", fluid_type="DOMAIN").domain_settings
    domain.resolution_max = 10000


def keyed():
    new = modifier(sheet(), "ARRAY", "Array")
    for frame, count in ((1, 1), (20, 10**8), (40, 1)):
        new.count = count
        new.keyframe_insert("count", frame=frame)


def later():
    new = modifier(sheet(), "ARRAY", "Array", count=10**8)
    for frame, shown in ((1, False), (20, True), (1, False)):
        new.show_viewport = shown
        new.keyframe_insert("show_viewport", frame=frame)


def numbered():
    """The curve's path names the modifier by its number."""
    keyed()
    action = scene.objects[0].animation_data.action
    bags = action.layers[0].strips[0].channelbags if hasattr(action, "layers") else [action]
    bags[0].fcurves[0].data_path = "modifiers[0].count"


def driven():
    obj = sheet()
    obj["times"] = 1000.0
    driver = modifier(obj, "ARRAY", "Array").driver_add("count").driver
    variable = driver.variables.new()
    variable.name, variable.targets[0].id, variable.targets[0].data_path = "times", obj, '["times"]'
    driver.expression = "max(1, times * 10**6)"


def text():
    curve = bpy.data.curves.new("Text", "FONT")
    curve.body, curve.bevel_depth, curve.bevel_resolution, curve.resolution_u = "m" * 20000, 0.1, 32, 64
    made("Text", curve)


def metaball():
    ball = bpy.data.metaballs.new("Ball")
    ball.elements.new().radius = 1000
    ball.resolution = 0.005
    made("Ball", ball)


def together():
    for number in range(30):
        _subdivisions(sheet(f"Sheet {number}"), 6, 4)


def objects():
    mesh = sheet().data
    for number in range(20000):
        made(f"Object {number}", mesh)


def instances():
    inner = bpy.data.collections.new("Inner")
    inner.objects.link(bpy.data.objects.new("Brick", sheet().data))
    for storey in range(7):
        outer = bpy.data.collections.new(f"Storey {storey}")
        for number in range(10):
            empty = bpy.data.objects.new(f"Empty {storey} {number}", None)
            empty.instance_type, empty.instance_collection = "COLLECTION", inner
            outer.objects.link(empty)
        inner = outer
    everything = made("All", None)
    everything.instance_type, everything.instance_collection = "COLLECTION", inner


def corners():
    parent = sheet(across=2)
    _subdivisions(parent, 6, 5)
    parent.instance_type = "VERTS"
    sheet("Child").parent = parent


def particles():
    obj = sheet()
    obj.modifiers.new("Particles", "PARTICLE_SYSTEM")
    obj.particle_systems[0].settings.count = 10**7


def children():
    obj = sheet()
    obj.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = obj.particle_systems[0].settings
    settings.count, settings.child_type, settings.child_percent = 1000, "SIMPLE", 100000


def frames():
    scene.frame_end = 10**6


def _huge(name):
    image = bpy.data.images.new(name, 4, 4)
    scene.world = bpy.data.worlds.new("World")
    scene.world["image"] = image
    return image


def image():
    huge = _huge("Huge")
    huge.generated_width = huge.generated_height = 60000


def packed():
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 60000, 60000, 1, 0, 0, 0, 0))
    png += chunk(b"IDAT", zlib.compress(bytes(100))) + chunk(b"IEND", b"")
    huge = _huge("Packed")
    huge.source = "FILE"
    huge.pack(data=png, data_len=len(png))


def _tree(*kinds):
    """A tree of nodes whose geometry goes from one to the next, and to the output."""
    tree = bpy.data.node_groups.new("Tree", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    output = tree.nodes.new("NodeGroupOutput")
    nodes = [tree.nodes.new(kind) for kind in kinds]
    for before, after in zip(nodes, [*nodes[1:], output]):
        start = next(socket for socket in before.outputs if socket.type == "GEOMETRY")
        end = next(socket for socket in after.inputs if socket.type == "GEOMETRY")
        tree.links.new(start, end)
    modifier(sheet(), "NODES", "Nodes", node_group=tree)
    return tree, nodes


def _grid(node, across):
    node.inputs["Vertices X"].default_value = node.inputs["Vertices Y"].default_value = across


def grid():
    _, nodes = _tree("GeometryNodeMeshGrid")
    _grid(nodes[0], 100000)


def realized():
    tree, nodes = _tree("GeometryNodeMeshGrid", "GeometryNodeInstanceOnPoints", "GeometryNodeRealizeInstances")
    brick = tree.nodes.new("GeometryNodeMeshGrid")
    _grid(nodes[0], 1000)
    _grid(brick, 1000)
    tree.links.new(brick.outputs["Mesh"], nodes[1].inputs["Instance"])


def fine():
    obj = sheet()
    _subdivisions(obj, 4)
    modifier(obj, "ARRAY", "Array", count=50)
    tree, nodes = _tree("GeometryNodeMeshGrid", "GeometryNodeSubdivideMesh")
    _grid(nodes[0], 10)


def driven_little():
    obj = sheet()
    obj["quality"] = 2
    driver = modifier(obj, "SUBSURF", "Sub").driver_add("levels").driver
    driver.type = "MAX"
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = obj, '["quality"]'


def switched_off():
    modifier(sheet(), "ARRAY", "Array", count=10**9).show_viewport = False


def simplified():
    _subdivisions(sheet(), 6, 6, 6)
    scene.render.use_simplify, scene.render.simplify_subdivision = True, 1


def rendered():
    obj = sheet()
    for _ in range(2):
        modifier(obj, "SUBSURF", "Sub", levels=1, render_levels=11)


def shared():
    mesh = sheet(across=300).data
    for number in range(300):
        made(f"Copy {number}", mesh)


for name in sys.argv[2:]:
    scene = bpy.data.scenes.new("Heavy")
    globals()[name]()
    # Writing only the scene, which no window shows, evaluates nothing.
    bpy.data.libraries.write(os.path.join(folder, f"{name}.blend"), {scene})
    bpy.ops.wm.read_factory_settings(use_empty=True)
'''


def make_heavy_files(folder: Path) -> Path:
    """Makes all files in ``folder``; skips the test where there is no Blender."""
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    done = subprocess.run(
        [sys.executable, "-P", "-c", _SCRIPT, str(folder), *HEAVY, *LIGHT],
        env=clean_environment(folder / "settings") | {"PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, (done.stdout + done.stderr)[-3000:]
    return folder
