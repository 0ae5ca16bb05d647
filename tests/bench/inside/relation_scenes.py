"""Makes scenes of things that stand to each other in many ways, and judges what was asked of each, in one Blender.

``asked.json`` in the folder given: {scene: [spec as JSON, …]}. The result: {scene: [relations as JSON, …]}.
"""

import json
import math
import os
from dataclasses import asdict

import bpy
from making import PLACE, add, bake, body, empty, finish, get, into, new, read, save
from mathutils import Euler
from pydantic import TypeAdapter

from bench.audit.actors import find_actors
from bench.audit.facts import Scene
from bench.audit.inside import measure
from bench.audit.spr import judge_relations, spr_of
from bench.scenes.spec import Spec


class Here:
    """This Blender, asked as if it were another."""

    def ask(self, job, *, doing, **arguments):
        assert (job, doing) == ("measure", "measuring it")
        return json.loads(json.dumps(measure.measure(**json.loads(json.dumps(arguments)))))


def block(name, location, size, turned=(0, 0, 0)):
    """A box of a size; ``location`` is the middle of its underside."""
    x, y, z = location
    thing = add("cube", name, (x, y, z + size[2] / 2), size=1)
    thing.scale, thing.rotation_euler = size, Euler(turned)
    return thing


def specimens():
    """Pairs of things, each pair in a place of its own along x, on one floor at height 0."""
    new()
    add("plane", "Floor", (50, 0, 0), size=200)
    for place, (name, height) in enumerate(
        [
            ("Plate", 0),
            ("Saucer", 0.019),
            ("Tray", 0.021),
            ("Brick", -0.019),
            ("Stone", -0.021),
            ("Kite", 0.5),
        ]
    ):
        block(name, (2 * place, 0, height), (0.4, 0.4, 0.2))
    block("Table", (14, 0, 0), (1, 1, 0.75))
    cloth = add("grid", "Cloth", (14, 0, 0.76), size=1.6, x_subdivisions=48, y_subdivisions=48)
    for vertex in cloth.data.vertices:
        over = max(abs(vertex.co.x), abs(vertex.co.y)) - 0.51
        if over > 0:
            vertex.co.z -= over
            vertex.co.x, vertex.co.y = (max(-0.51, min(0.51, each)) for each in vertex.co.xy)
    block("Vase", (15, 0, 0.55), (0.3, 0.3, 0.4))
    block("Ramp", (17, 0, 0), (2, 1, 0.1), (0, math.radians(-45), 0))
    bpy.context.view_layer.update()
    slope = get("Ramp").matrix_world
    touching = slope.translation + slope.col[2].xyz.normalized() * (0.05 + 0.1)
    add("uv_sphere", "Ball", touching, radius=0.1, segments=48, ring_count=24)
    block("Stool", (20, 0, -0.1), (0.4, 0.4, 0.05))
    for number, (x, y) in enumerate([(-0.17, -0.17), (0.17, -0.17), (-0.17, 0.17), (0.17, 0.17)]):
        block(f"Stool leg {number}", (20 + x, y, -0.1), (0.03, 0.03, 0.5))
    get("Stool").location.z = 0.4
    block("Post", (22, 0, -0.3), (0.1, 0.1, 2))
    bowl("Bowl", (24, 0, 0.3), 0.3)
    add("uv_sphere", "Marble", (24, 0, 0.1), radius=0.05)
    add("uv_sphere", "Pebble", (24.5, 0, 0.1), radius=0.05)
    block("Spoon", (24, 0, 0.06), (0.02, 0.02, 0.6))
    block("Pencil", (24.1, 0, 0.08), (0.02, 0.02, 0.36))
    block("Wall", (28, 2, 0), (4, 0.2, 2.5))
    block("Sofa", (27, 1.495, 0), (1.2, 0.8, 0.8))
    block("Bench", (29, 1.7, 0), (1.2, 0.8, 0.8))
    block("Crown", (28, 2, 2.5), (0.3, 0.2, 0.3))
    block("Sack", (32, 0, 0), (1, 1, 1))
    add("uv_sphere", "Coin", (32, 0, 0.5), radius=0.1)
    add("torus", "Ring", (34, 0, 1), major_radius=0.3, minor_radius=0.02)
    block("Peg", (34.3, 0, 0.99), (0.1, 0.01, 0.01))
    block("Hook", (34.45, 0, 0.99), (0.05, 0.01, 0.01))
    block("Basin", (36, 0, 0), (1, 1, 0.5))
    block("Spout", (36, 0.65, 0.8), (0.2, 0.2, 0.2))
    block("Lantern", (36, 3, 0.8), (0.2, 0.2, 0.2))
    text = bpy.data.curves.new("Label", "FONT")
    text.body = "Open"
    label = bpy.data.objects.new("Label", text)
    label.rotation_euler, label.location = (math.pi / 2, 0, 0), (36.2 - 0.6, -0.51, 0.05)
    bpy.context.scene.collection.objects.link(label)
    line = bpy.data.curves.new("Rope", "CURVE")
    line.dimensions, line.bevel_depth = "3D", 0.01
    spline = line.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (36, 3, 1.005, 1), (36, 3, 3, 1)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Rope", line))


def bowl(name, location, radius):
    """The lower half of a sphere, thick, open above."""
    thing = add("uv_sphere", name, location, radius=radius, segments=32, ring_count=16)
    mesh = thing.data
    kept = [face.index for face in mesh.polygons if face.center.z < 0]
    corners = [tuple(vertex.co) for vertex in mesh.vertices]
    faces = [tuple(mesh.polygons[index].vertices) for index in kept]
    mesh.clear_geometry()
    mesh.from_pydata(corners, [], faces)
    thing.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.02


def seen_from_behind():
    """A cup on the right of a jug for who looks along y, and on its left for the camera, which looks the other way."""
    new()
    block("Cup", (1, 0, 0), (0.2, 0.2, 0.2))
    block("Jug", (0, 1, 0), (0.2, 0.2, 0.3))
    bpy.ops.object.camera_add(location=(0, 10, 1), rotation=(math.pi / 2, 0, math.pi))
    bpy.context.scene.camera = bpy.context.object


def seen_by_nobody():
    seen_from_behind()
    bpy.data.objects.remove(bpy.context.scene.camera)


# One kitchen in many guises


def kitchen(scale=1.0, lift=0.0, names=None, build=None):
    """A table of five boxes with a plate, a shelf board at the wall; ``lift``: how high the table hovers."""
    new()
    called = dict.fromkeys(KITCHEN) if names is None else names
    called = {part: called.get(part) or part for part in KITCHEN}

    def put(part, location, size):
        at, extent = [scale * each for each in location], [scale * each for each in size]
        block(called[part], at, extent)

    put("Floor", (0, 0, -0.1), (8, 8, 0.1))
    put("Board", (0, 0, 0.7 + lift), (1.2, 0.8, 0.05))
    for leg, (x, y) in zip(LEGS, [(-0.55, -0.35), (0.55, -0.35), (-0.55, 0.35), (0.55, 0.35)], strict=True):
        put(leg, (x, y, lift), (0.05, 0.05, 0.7))
    put("Plate", (0.2, 0.1, 0.75 + lift), (0.2, 0.2, 0.02))
    put("Wall", (0, 2, 0), (8, 0.1, 2.5))
    if scale != 1.0:
        bpy.context.scene.unit_settings.scale_length = 1 / scale
    if build is not None:
        build()


LEGS = ("Pole 1", "Pole 2", "Pole 3", "Pole 4")
KITCHEN = ("Floor", "Board", *LEGS, "Plate", "Wall")
# Only the board has a name of the table's; its legs are called after nothing.
UNGROUPED = {"Board": "Table", **{leg: f"Cube.{number:03d}" for number, leg in enumerate(LEGS)}}


def ungrouped():
    kitchen(names=UNGROUPED)


def ungrouped_hovering():
    kitchen(names=UNGROUPED, lift=0.3)


def collected():
    kitchen(build=lambda: into("Table", *(get(name) for name in ("Board", *LEGS))))


def collected_each():
    """Every thing in a collection of its own; the table's has lost its legs."""

    def build():
        into("Table", get("Board"))
        for name in ("Floor", "Plate", "Wall"):
            into(name, get(name))

    kitchen(build=build)


def parented():
    def build():
        parent = empty("Table")
        for name in ("Board", *LEGS):
            get(name).parent = parent

    kitchen(build=build)


def joined():
    def build():
        bpy.ops.object.select_all(action="DESELECT")
        for name in ("Board", *LEGS):
            get(name).select_set(True)
        bpy.context.view_layer.objects.active = get("Board")
        bpy.ops.object.join()
        get("Board").name = "Table"

    kitchen(build=build)


def instanced():
    def build():
        parts = into("Wooden parts", *(get(name) for name in ("Board", *LEGS)))
        bpy.context.scene.collection.children.unlink(parts)
        shown = empty("Table")
        shown.instance_type, shown.instance_collection = "COLLECTION", parts

    kitchen(build=build)


def other_units():
    kitchen(scale=100.0, build=lambda: into("Table", *(get(name) for name in ("Board", *LEGS))))


def synonyms():
    others = {"Floor": "ground", "Plate": "dish.001", "Wall": "kitchen_wall", "Board": "desk board"}
    kitchen(names=others | {leg: f"desk leg {leg[-1]}" for leg in LEGS})


def turned_normals():
    """As joined, its faces looking in."""
    joined()
    get("Table").data.flip_normals()


# Motion


def falling():
    new(24)
    body(block("Floor", (0, 0, -0.5), (4, 4, 0.5)), "PASSIVE")
    for number in range(3):
        body(block(f"Crate {number}", (number - 1, 0, 0.4), (0.3, 0.3, 0.3)))
    handle = block("Handle", (0, 0.02, 0.45), (0.05, 0.05, 0.05))
    handle.parent = get("Crate 1")
    handle.matrix_parent_inverse = get("Crate 1").matrix_world.inverted()


def baked():
    falling()
    bake()


def raining():
    new(24)
    floor = add("plane", "Floor", (0, 0, 0), size=6)
    floor.modifiers.new("Collision", "COLLISION")
    floor.collision.damping_factor = 1
    cloud = add("plane", "Cloud", (0, 0, 2), size=1)
    cloud.modifiers.new("Rain", "PARTICLE_SYSTEM")
    settings = cloud.particle_systems[0].settings
    settings.count, settings.frame_end, settings.lifetime = 300, 2, 100
    settings.normal_factor, settings.object_align_factor = 0, (0, 0, -4)
    cloud.particle_systems[0].point_cache.frame_end = 24
    bake()


def dry():
    """A liquid's domain without any liquid."""
    new()
    block("Tub", (0, 0, 0), (1, 1, 0.3))
    water = block("Water", (0, 0, 0), (2, 2, 1))
    bpy.context.view_layer.objects.active = water
    water.modifiers.new("Fluid", "FLUID").fluid_type = "DOMAIN"
    water.modifiers["Fluid"].domain_settings.domain_type = "LIQUID"


def broken():
    """Two boxes, each with corners that are nowhere, or very far away; the faces that have none of these remain."""
    new()
    for name, height, nowhere in (("Lower", 0, math.nan), ("Upper", 1.01, 1e25)):
        block(name, (0, 0, height), (1, 1, 1))
        get(name).data.vertices[0 if name == "Lower" else 1].co.x = nowhere


def scattered():
    """Pebbles on a tray, that nodes instance; the tray's own mesh is not shown."""
    new()
    block("Tray", (0, 0, 0), (1, 1, 0.1))
    add("ico_sphere", "Source", (5, 0, 0), radius=0.05).hide_render = True
    line = add("plane", "Pebbles", (0, 0, 0.15), size=0.6)
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    source, sink, scatter, info = (
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "NodeGroupOutput",
            "GeometryNodeInstanceOnPoints",
            "GeometryNodeObjectInfo",
        )
    )
    info.inputs["Object"].default_value = get("Source")
    tree.links.new(source.outputs[0], scatter.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
    tree.links.new(scatter.outputs[0], sink.inputs[0])
    line.modifiers.new("Scatter", "NODES").node_group = tree


def primitives():
    """Two hundred ungrouped boxes: towers of ten on a floor."""
    new()
    block("Floor", (0, 0, -0.1), (30, 30, 0.1))
    for tower in range(20):
        for storey in range(10):
            name = f"Tower {tower}" if storey == 5 else f"Box.{10 * tower + storey:03d}"
            block(name, (1.2 * tower - 12, 0, storey), (1, 1, 1))


def main():
    with open(os.path.join(PLACE, "asked.json")) as file:
        asked = json.load(file)
    scenes = TypeAdapter(Scene)
    found = {}
    for name, specs in asked.items():
        globals()[name]()
        scene = scenes.validate_python(read(save(name)))
        found[name] = []
        for each in specs:
            spec = Spec.model_validate(each)
            related = judge_relations(spec, scene, find_actors(spec, scene), Here())
            found[name].append({"spr": spr_of(related), "relations": [asdict(one) for one in related]})
    finish(found)


main()
