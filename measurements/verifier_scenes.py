"""Scenes that the verifier is timed on: scripts for Blender whose last value, ``told``, says what is in them."""

from __future__ import annotations

import math
from typing import Any

_TAGGED = """
import math, random
import bmesh, bpy
from mathutils import Matrix, Vector

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene

def collection(name, role, above):
    made = bpy.data.collections.new(name)
    made["protocol_role"] = role
    above.children.link(made)
    return made

systems = {name: collection(name, "system", scene.collection) for name in ("ground", "set", "cameras", "lighting")}

def thing(name, system, at, *meshes):
    # meshes: (object, place below the root, name of what it touches)
    made = collection(name, "object", systems[system])
    root = bpy.data.objects.new(f"{name} root", None)
    root["is_object_root"], root.location = True, at
    made.objects.link(root)
    for one, place, touched in meshes:
        one.parent, one.location = root, place
        made.objects.link(one)
        if touched:
            one["contact_with"] = [touched]
    return made

def mesh(name, fill):
    shape, data = bmesh.new(), bpy.data.meshes.new(name)
    fill(shape)
    shape.to_mesh(data)
    shape.free()
    return bpy.data.objects.new(name, data)

def slab(name, side):
    def fill(shape):
        bmesh.ops.create_cube(shape, size=1, matrix=Matrix.Diagonal((side, side, 0.2, 1)))
    return mesh(name, fill)

camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location = (0, -20, 10)
systems["cameras"].objects.link(camera)
scene.camera = camera
systems["lighting"].objects.link(bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN")))
"""

_FURNITURE = """
COUNT, TRIANGLES = {count}, {triangles}
side = math.ceil(math.sqrt(COUNT))
thing("Floor", "ground", (0, 0, 0), (slab("Slab", 2.0 * side + 4), (0, 0, -0.1), ""))
turned = Matrix.Rotation(math.radians(30), 4, "Z")

def chest(shape):
    # A bar that stands askew: the boxes around neighbours overlap, the bars do not.
    bmesh.ops.create_cube(shape, size=1, matrix=turned @ Matrix.Diagonal((1.5, 0.4, 1, 1)))
    cuts = round(math.sqrt(TRIANGLES / 2 / 12)) - 1
    bmesh.ops.subdivide_edges(shape, edges=shape.edges[:], cuts=cuts, use_grid_fill=True)

def knob(shape):
    rings = round(math.sqrt(TRIANGLES / 2 / 4))
    bmesh.ops.create_uvsphere(shape, u_segments=2 * rings, v_segments=rings + 1, radius=0.19)

meshes = 1
triangles = 12
for number in range(COUNT - 1):
    at = (1.2 * (number % side - side / 2), 1.2 * (number // side - side / 2), 0)
    parts = mesh(f"Chest {{number}}", chest), mesh(f"Knob {{number}}", knob)
    for part in parts:
        part.data.calc_loop_triangles()
        triangles += len(part.data.loop_triangles)
    meshes += len(parts)
    thing(f"Thing {{number}}", "set", at,
          (parts[0], (0, 0, 0.5), "Slab"), (parts[1], (0, 0, 1.1895), parts[0].name))
told = dict(meshes=meshes, triangles=triangles)
"""

_MOTION = """
THIRD, FRAMES = {third}, {frames}
scene.frame_start, scene.frame_end = 1, FRAMES
bpy.ops.rigidbody.world_add()
scene.rigidbody_world.substeps_per_frame = 20
scene.rigidbody_world.point_cache.frame_end = FRAMES

def body(one, kind, **settings):
    bpy.context.view_layer.update()
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_add(type=kind)
    one.rigid_body.collision_shape = "BOX"
    one.rigid_body.use_margin, one.rigid_body.collision_margin = True, 0.0
    one.rigid_body.restitution = 0.0
    for name, value in settings.items():
        setattr(one.rigid_body, name, value)

def crate(name, at, deformation, motion):
    def fill(shape):
        bmesh.ops.create_cube(shape, size=0.4)
        bmesh.ops.subdivide_edges(shape, edges=shape.edges[:], cuts=8, use_grid_fill=True)
    made = mesh(f"{{name}} planks", fill)
    owner = thing(name, "set", at, (made, (0, 0, 0), ""))
    owner["deformation_kind"], owner["motion_kind"] = deformation, motion
    return made

floor = slab("Slab", 40)
thing("Floor", "ground", (0, 0, 0), (floor, (0, 0, -0.1), ""))
body(floor, "PASSIVE")
for number in range(THIRD):
    along = 1.5 * number
    body(crate(f"Falling {{number}}", (-2, along, 1 + number), "sim_rigid", "bake"), "ACTIVE")
    body(crate(f"Pushed {{number}}", (0.6, along, 0.2), "sim_rigid", "bake"), "ACTIVE")
    body(crate(f"Pusher {{number}}", (0, along, 0.2), "none", "keyframe"), "PASSIVE", kinematic=True)
    root = bpy.data.objects[f"Pusher {{number}} root"]
    for frame, x in ((10, 0), (34, 0.6)):
        root.location.x = x
        root.keyframe_insert("location", frame=frame)
    for curve in root.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
bpy.ops.ptcache.bake_all(bake=True)

# What was baked, for the plan: where each is at first, when it begins to move and when it has come to rest, how far.
places = dict()
for frame in range(1, FRAMES + 1):
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    for one in bpy.data.objects:
        if one.name.endswith(" planks"):
            at = one.evaluated_get(graph).matrix_world.translation.copy()
            places.setdefault(one.name.removesuffix(" planks"), []).append(at)
scene.frame_set(1)
told = dict()
for name, ways in places.items():
    steps = [(after - before).length for before, after in zip(ways, ways[1:])]
    moving = [place for place, step in enumerate(steps) if step > 0.05 * max(steps)]
    told[name] = dict(
        at=list(ways[0]), start=1 + moving[0], end=2 + moving[-1], way=list(ways[-1] - ways[0])
    )
told
"""

# What systems that know no protocol leave behind: 200 primitives in the scene's own collection, most with the names
# that Blender gave them, chairs and tables as heaps of boxes.
LOOSE = """
import math, random
import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)
random.seed(3)
bpy.ops.mesh.primitive_plane_add(size=12)
for table in range(5):
    x, y = random.uniform(-4, 4), random.uniform(-4, 4)
    bpy.ops.mesh.primitive_cube_add(size=1, location=(x, y, 0.75), scale=(1, 0.6, 0.04))
    bpy.context.object.name = f"Table_{table}_top"
    for corner in range(4):
        at = (x + (0.45 if corner % 2 else -0.45), y + (0.25 if corner // 2 else -0.25), 0.365)
        bpy.ops.mesh.primitive_cylinder_add(radius=0.03, depth=0.73, location=at)
        bpy.context.object.name = f"Table_{table}_leg"
    for chair in range(6):
        turn = chair * math.tau / 6
        cx, cy = x + 0.9 * math.cos(turn), y + 0.7 * math.sin(turn)
        for at, scale in (((cx, cy, 0.45), (0.4, 0.4, 0.05)), ((cx + 0.18, cy, 0.7), (0.04, 0.4, 0.5)),
                          ((cx, cy, 0.2), (0.3, 0.3, 0.4))):
            bpy.ops.mesh.primitive_cube_add(size=1, location=at, scale=scale)
    for fruit in range(8):
        at = (x + random.uniform(-0.4, 0.4), y + random.uniform(-0.25, 0.25), 0.8)
        bpy.ops.mesh.primitive_uv_sphere_add(radius=0.05, location=at)
while len(bpy.data.objects) < 200:
    at = (random.uniform(-6, 6), random.uniform(-6, 6), random.uniform(0, 2))
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.2, location=at)
bpy.ops.object.light_add(type="SUN")
bpy.ops.object.camera_add(location=(8, -8, 6), rotation=(1.1, 0, 0.8))
bpy.context.scene.camera = bpy.context.object
told = {}
"""


def furniture(count: int, triangles: int) -> str:
    """A valid scene of ``count`` objects with a floor, each of two meshes with about so many triangles."""
    return _TAGGED + _FURNITURE.format(count=count, triangles=triangles)


def motion(actors: int, frames: int) -> str:
    """Baked crates: a third falls, a third is pushed by the last third, which is keyed."""
    return _TAGGED + _MOTION.format(third=actors // 3, frames=frames)


def motion_plan(frames: int, facts: dict[str, Any]) -> dict[str, Any]:
    """The plan of :func:`motion`, from the facts of its scene: crates fall, push or are pushed, then rest."""
    crates: list[dict[str, Any]] = []
    phases: list[dict[str, Any]] = []
    for name, crate in facts.items():
        kind, _, number = name.partition(" ")
        extent = math.hypot(*crate["way"])
        role = "keyframed" if kind == "Pusher" else "rigid"
        crates.append(
            {"name": name, "systems": ["set"], "dimensions": [0.4] * 3, "position": crate["at"], "role": role}
        )
        phases += [
            {
                "name": name,
                "actor": name,
                "kind": "fall" if kind == "Falling" else "translate",
                "start": crate["start"],
                "end": crate["end"],
                "direction": crate["way"],
                "extent": extent,
                "cause": f"Pusher {number}" if kind == "Pushed" else None,
            },
            {"name": f"{name} rests", "actor": name, "kind": "settle", "start": crate["end"], "end": frames},
        ]
    floor = {
        "name": "Floor",
        "systems": ["ground"],
        "dimensions": [40, 40, 0.2],
        "position": [0, 0, 0],
        "role": "ground",
    }
    return {
        "title": "Crates that fall and are pushed",
        "frame_end": frames,
        "systems": ["ground", "set", "cameras", "lighting"],
        "objects": [floor, *crates],
        "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
        "camera": {"position": [0, -20, 10], "target": [0, 0, 0]},
        "render": {"kind": "animation"},
        "motion": {"phases": phases},
    }
