"""Two small scenes, each as its plan and the code that builds it: a crate that stands, and one that falls."""

from __future__ import annotations

from typing import Any

Plan = dict[str, Any]

OUTSIDE = ("uv", "texture", "deformation_setup", "motion")

TOOLS = """\
import bpy
from mathutils import Vector

scene = bpy.context.scene


def system(name):
    made = bpy.data.collections.get(name)
    if made is None:
        made = bpy.data.collections.new(name)
        made["protocol_role"] = "system"
        scene.collection.children.link(made)
    return made


def box(name, low, high):
    points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    data = bpy.data.meshes.new(name)
    data.from_pydata([Vector(point) for point in points], [], faces)
    return bpy.data.objects.new(name, data)


def thing(name, mesh, where, at):
    made = bpy.data.collections.new(name)
    made["protocol_role"] = "object"
    system(where).children.link(made)
    root = bpy.data.objects.new(name + " root", None)
    root["is_object_root"] = True
    root.location = at
    made.objects.link(root)
    made.objects.link(mesh)
    mesh.parent = root
    return made
"""

# The crate's mesh is centred on its origin, as a body that is to fall wants it.
MODELING = f"""\
{TOOLS}
thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), "ground", (0, 0, 0))
planks = box("Planks", (-0.25, -0.25, -0.25), (0.25, 0.25, 0.25))
planks.location.z = 0.25
thing("Crate", planks, "set", (0, 0, HEIGHT))
"""
STANDING = MODELING.replace("HEIGHT", "0")
FLOATING = MODELING.replace("HEIGHT", "0.2")

CAMERA = f"""\
{TOOLS}
camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
camera.location = (3, -3, 2)
camera.rotation_euler = (Vector((0, 0, 0.25)) - camera.location).to_track_quat("-Z", "Y").to_euler()
system("cameras").objects.link(camera)
scene.camera = camera
scene.render.engine = "BLENDER_WORKBENCH"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 36, 50
"""

LIGHT = f"""\
{TOOLS}
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
sun.data.energy = 3
system("lighting").objects.link(sun)
"""

CODE = {"modeling": STANDING, "camera": CAMERA, "light": LIGHT}

# Changes that put right, or wrong, what the code above has built.
LOWER = 'import bpy\nbpy.data.objects["Crate root"].location.z = 0'
LIFT = 'import bpy\nbpy.data.objects["Crate root"].location.z = 0.3'


def an_object(name: str, size: Any, at: Any, where: str = "set", **more: Any) -> dict[str, Any]:
    return {"name": name, "systems": [where], "dimensions": size, "position": at, **more}


def standing(**changes: Any) -> Plan:
    """The plan of a crate that stands on a floor, seen in a still."""
    return {
        "title": "A crate on a floor",
        "systems": ["ground", "set"],
        "objects": [
            an_object("Floor", [4, 4, 0.1], [0, 0, 0], "ground", role="ground"),
            an_object("Crate", [0.5, 0.5, 0.5], [0, 0, 0]),
        ],
        "relations": [{"kind": "SupportedBy", "child": "Crate", "parents": ["Floor"]}],
        "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
        "camera": {"position": [3, -3, 2], "target": "Crate", "subjects": ["Crate"]},
        "render": {"kind": "still", "engine": "BLENDER_WORKBENCH", "resolution": [64, 36], "samples": 1},
        "opt_out": list(OUTSIDE),
        **changes,
    }


# The crate that falls

HIGH = MODELING.replace("HEIGHT", "0.4") + "\nscene.frame_end = 20\n"

_TAGS = """\
import bpy
from mathutils import Vector

scene = bpy.context.scene
planks = bpy.data.objects["Planks"]
crate = bpy.data.collections["Crate"]
crate["deformation_kind"], crate["motion_kind"] = "sim_rigid", "bake"
"""
# As it would fall, but by keyframes alone.
FAKED = f"""\
{_TAGS}
for frame in range(1, 21):
    fallen = min(0.4, 9.81 / 2 * ((frame - 1) / 24) ** 2)
    planks.location.z = 0.25 - fallen
    planks.keyframe_insert("location", frame=frame)
"""
BODIES = f"""\
{_TAGS}
planks.animation_data_clear()
planks.location.z = 0.25
bpy.ops.rigidbody.world_add()
scene.rigidbody_world.substeps_per_frame = 60
for one, kind in ((planks, "ACTIVE"), (bpy.data.objects["Slab"], "PASSIVE")):
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_add(type=kind)
    one.rigid_body.collision_shape = "CONVEX_HULL"
    one.rigid_body.restitution = 0
    one.rigid_body.use_margin, one.rigid_body.collision_margin = True, 0
"""


def falling() -> Plan:
    """The plan of a crate that falls onto a floor, seen in twenty frames."""
    return standing(
        title="A falling crate",
        frame_end=20,
        objects=[
            an_object("Floor", [4, 4, 0.1], [0, 0, 0], "ground", role="ground"),
            an_object("Crate", [0.5, 0.5, 0.5], [0, 0, 0.4], role="rigid"),
        ],
        relations=[{"kind": "Above", "a": "Crate", "b": "Floor"}],
        render={"kind": "animation", "engine": "BLENDER_WORKBENCH", "resolution": [64, 36], "samples": 1},
        motion={
            "phases": [
                {
                    "name": "falls",
                    "actor": "Crate",
                    "kind": "fall",
                    "start": 1,
                    "end": 10,
                    "direction": [0, 0, -1],
                    "extent": 0.4,
                },
                {
                    "name": "lies",
                    "actor": "Crate",
                    "kind": "settle",
                    "start": 12,
                    "end": 20,
                    "cause": "falls",
                },
            ]
        },
        opt_out=["uv", "texture", "deformation_setup"],
    )
