"""``blender_scene_state``: what it reads in real scenes, that it fits, and that it leaves no trace."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest
from places import REPO

from agents.blender.inside.readout_sections import SECTIONS
from agents.blender.tools.base import Result, parse
from agents.blender.tools.scene_fit import tokens
from agents.blender.tools.scene_order import words_of
from agents.blender.tools.scene_state import TOOL, SceneStateArguments, readout
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

CUBE = "bpy.ops.mesh.primitive_cube_add({0})\no = bpy.context.object\n"


def read(session: LiveSession, code: str = "", **arguments: Any) -> Result:
    """What the tool reads after some code."""
    if code:
        session.run(code)
    found = session.use(TOOL, **arguments)
    json.dumps(found.data, allow_nan=False)
    assert tokens(found.text) <= arguments.get("max_tokens", 4000)
    return found


def entry(found: Result, section: str, name: str, **having: Any) -> dict[str, Any]:
    """The one entry of this name, and with these values."""
    entries = [
        one
        for one in found.data[section]
        if one["name"] == name and all(one.get(key) == item for key, item in having.items())
    ]
    assert len(entries) == 1, (name, having, found.text)
    return entries[0]


# Objects


def test_an_extent_is_that_of_evaluated_geometry_in_the_world(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("location=(1, 2, 3), rotation=(0, 0, 0.7853981633974483)")
        + "m = o.modifiers.new('Row', 'ARRAY')\nm.count = 3\no.scale.z = 2",
    )
    told = entry(found, "objects", "Cube")
    # Three cubes of edge 2 in a row, turned by 45°: corners at 1 ± √2 and 4√2·cos 45° further on.
    half = math.sqrt(2)
    assert told["extent"]["min"] == pytest.approx([1 - half, 2 - half, 1], abs=1e-3)
    assert told["extent"]["max"] == pytest.approx([1 + half + 2 * half, 2 + half + 2 * half, 5], abs=1e-3)
    assert told["rotation"] == [0, 0, 45]
    assert told["scale"] == [1, 1, 2]
    assert (told["vertices"], told["evaluated_vertices"]) == (8, 24)
    assert "at 1 2 3; rotation 0 0 45°; scale 1 1 2" in found.text


def test_a_turned_sphere_is_measured_by_its_vertices_not_by_its_box(session: LiveSession) -> None:
    found = read(session, "bpy.ops.mesh.primitive_uv_sphere_add(rotation=(0.5, 0.6, 0.7))")
    assert max(entry(found, "objects", "Sphere")["extent"]["size"]) <= 2.0001


@pytest.mark.parametrize("bevel", [0, 0.1])
def test_an_extent_of_a_curve_is_not_that_of_the_radius_of_its_points(
    session: LiveSession, bevel: float
) -> None:
    code = f"""
line = bpy.data.curves.new("Line", "CURVE")
line.dimensions, line.bevel_depth = "3D", {bevel}
spline = line.splines.new("POLY")
spline.points.add(1)
spline.points[0].co, spline.points[1].co = (0, 0, 0, 1), (2, 0, 0, 1)
bpy.context.scene.collection.objects.link(bpy.data.objects.new("Line", line))
"""
    size = entry(read(session, code), "objects", "Line")["extent"]["size"]
    assert size == pytest.approx([2, 2 * bevel, 2 * bevel], abs=0.02)


@pytest.mark.parametrize("scale", [(-1, 1, 1), (-2, -1, 3), (-1, -1, -1)])
@pytest.mark.parametrize("turn", [0, 30])
def test_a_mirrored_object_has_its_own_rotation_and_scale(
    session: LiveSession, scale: tuple[float, ...], turn: float
) -> None:
    code = f"{CUBE}o.scale = {scale}\no.rotation_euler.z = {math.radians(turn)}"
    found = entry(read(session, code.replace("{0}", "")), "objects", "Cube")
    assert found["scale"] == pytest.approx(scale)
    assert found.get("rotation", [0, 0, 0]) == pytest.approx([0, 0, turn])


def test_a_marker_says_which_camera_it_switches_to(session: LiveSession) -> None:
    code = """
close = bpy.data.objects.new("Close", bpy.data.cameras.new("Close"))
bpy.context.scene.timeline_markers.new("wide", frame=1)
bpy.context.scene.timeline_markers.new("near", frame=20).camera = close
"""
    assert "markers: wide 1, near 20 (camera Close from here)" in read(session, code).text


def test_instances_belong_to_the_extent_of_what_makes_them(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("location=(0, 0, 0)")
        + """
c = bpy.data.collections.new('Kit')
c.objects.link(o)
e = bpy.data.objects.new('Maker', None)
bpy.context.scene.collection.objects.link(e)
e.instance_type, e.instance_collection, e.location = 'COLLECTION', c, (10, 0, 0)
""",
    )
    told = entry(found, "objects", "Maker")
    assert (told["extent"]["min"], told["extent"]["max"], told["instances"]) == ([9, -1, -1], [11, 1, 1], 1)
    assert told["instancing"] == "COLLECTION Kit"


def test_modifiers_stand_in_order_with_the_settings_that_differ(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
o.modifiers.new('Edge', 'BEVEL').segments = 4
s = o.modifiers.new('Smooth', 'SUBSURF')
s.levels, s.show_render = 2, False
o.modifiers.new('Plain', 'SOLIDIFY')
m = o.modifiers.new('Copy', 'MIRROR')
m.mirror_object = bpy.data.objects.new('Middle', None)
m.use_axis = (True, True, False)
""",
    )
    assert entry(found, "objects", "Cube")["modifiers"] == [
        {"name": "Edge", "type": "BEVEL", "settings": {"segments": 4}},
        {"name": "Smooth", "type": "SUBSURF", "off": ["render"], "settings": {"levels": 2}},
        {"name": "Plain", "type": "SOLIDIFY"},
        {
            "name": "Copy",
            "type": "MIRROR",
            "settings": {"use_axis": [True, True, False], "mirror_object": "Middle"},
        },
    ]
    assert "modifier Smooth SUBSURF off in render: levels=2" in found.text


def test_what_blender_makes_has_no_settings_that_differ(session: LiveSession) -> None:
    """Each default is compared with a fresh modifier, constraint, field or body of this Blender."""
    found = read(
        session,
        """
def made():
    bpy.ops.mesh.primitive_cube_add()
    return bpy.context.object
for kind in bpy.types.Modifier.bl_rna.properties['type'].enum_items:
    o = made()
    o.name = 'Modified ' + kind.identifier
    try:
        o.modifiers.new(kind.identifier, kind.identifier)
    except Exception:
        pass
o = made()
o.name = 'Constrained'
for kind in bpy.types.Constraint.bl_rna.properties['type'].enum_items:
    o.constraints.new(kind.identifier).name = kind.identifier
for kind in ('FORCE', 'WIND', 'VORTEX', 'TURBULENCE', 'DRAG', 'HARMONIC', 'MAGNET', 'CHARGE', 'BOID', 'TEXTURE'):
    bpy.ops.object.effector_add(type=kind)
bpy.ops.rigidbody.world_add()
made()
bpy.ops.rigidbody.object_add()
bpy.ops.object.camera_add()
for kind in ('POINT', 'SUN', 'SPOT', 'AREA'):
    bpy.ops.object.light_add(type=kind)
""",
        max_tokens=50_000,
    )
    odd: list[Any] = []
    for one in found.data["objects"]:
        for part in (*one.get("modifiers", ()), *one.get("constraints", ())):
            if settings := {key: item for key, item in part.get("settings", {}).items() if item is not None}:
                odd.append((part["type"], settings))
    for one in (*found.data["physics"], *found.data["view"]):
        if one["kind"] not in {"rigid_body_world", "render"} and "settings" in one:
            odd.append((one["kind"], one.get("type"), one["settings"]))
    assert [one for one in odd if one[0] not in {"SOLVER", "FOLLOW_TRACK"}] == []
    assert len(found.data["objects"]) > 50
    assert len(entry(found, "objects", "Constrained")["constraints"]) > 25


def test_a_node_group_is_told_with_the_inputs_that_differ(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
g = bpy.data.node_groups.new('Scatter', 'GeometryNodeTree')
for name, kind in (('Geometry', 'Geometry'), ('Count', 'Int'), ('Size', 'Float'), ('On', 'Object')):
    s = g.interface.new_socket(name, in_out='INPUT', socket_type='NodeSocket' + kind)
    if name == 'Size':
        s.default_value = 0.5
g.interface.new_socket('Geometry', in_out='OUTPUT', socket_type='NodeSocketGeometry')
g.links.new(g.nodes.new('NodeGroupInput').outputs[0], g.nodes.new('NodeGroupOutput').inputs[0])
m = o.modifiers.new('Nodes', 'NODES')
m.node_group = g
names = {i.name: i.identifier for i in g.interface.items_tree if i.in_out == 'INPUT'}
m[names['Count']], m[names['On']] = 7, o
""",
    )
    settings = entry(found, "objects", "Cube")["modifiers"][0]["settings"]
    assert settings == {"node_group": "Scatter", "Count": 7, "On": "Cube"}


def test_the_protocols_tags_are_told_where_they_stand(session: LiveSession) -> None:
    found = read(
        session,
        """
scene = bpy.context.scene
scene['strict_grounding'] = True
ground = bpy.data.collections.new('ground')
floor = bpy.data.collections.new('Floor')
ground['protocol_role'], floor['protocol_role'] = 'system', 'object'
floor['deformation_kind'], floor['motion_kind'], floor['allows_disconnected'] = 'none', 'none', True
scene.collection.children.link(ground)
ground.children.link(floor)
root = bpy.data.objects.new('Floor.root', None)
root['is_object_root'] = True
bpy.ops.mesh.primitive_plane_add()
mesh = bpy.context.object
mesh['contact_with'] = ['Ball', 'Tower']
mesh.parent = root
floor.objects.link(root)
floor.objects.link(mesh)
scene.collection.objects.unlink(mesh)
""",
    )
    assert found.data["scene"]["tags"] == {"strict_grounding": True}
    tree = [(one["name"], one["depth"], one.get("tags")) for one in found.data["collections"]]
    assert tree == [
        ("Scene Collection", 0, None),
        ("ground", 1, {"protocol_role": "system"}),
        (
            "Floor",
            2,
            {
                "protocol_role": "object",
                "deformation_kind": "none",
                "motion_kind": "none",
                "allows_disconnected": True,
            },
        ),
    ]
    assert entry(found, "objects", "Plane")["tags"] == {"contact_with": ["Ball", "Tower"]}
    assert entry(found, "objects", "Plane")["parent"] == "Floor.root"
    assert entry(found, "objects", "Floor.root")["tags"] == {"is_object_root": True}
    assert "    - Floor; 1 EMPTY, 1 MESH; protocol_role=object" in found.text


def test_constraints_are_told_and_those_that_cannot_work_are_marked(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
t = bpy.data.objects.new('Aim', None)
bpy.context.scene.collection.objects.link(t)
a = o.constraints.new('DAMPED_TRACK')
a.target, a.influence = t, 0.5
o.constraints.new('COPY_LOCATION')
""",
    )
    assert entry(found, "objects", "Cube")["constraints"] == [
        {"name": "Damped Track", "type": "DAMPED_TRACK", "settings": {"influence": 0.5, "target": "Aim"}},
        {"name": "Copy Location", "type": "COPY_LOCATION", "invalid": True},
    ]


def test_what_is_hidden_or_outside_the_view_layer_says_so(session: LiveSession) -> None:
    found = read(
        session,
        """
for name in ('Seen', 'Off', 'Eye', 'Out'):
    bpy.ops.mesh.primitive_cube_add(location=(4, 0, 0))
    bpy.context.object.name = name
bpy.data.objects['Off'].hide_viewport = bpy.data.objects['Off'].hide_render = True
bpy.data.objects['Eye'].hide_set(True)
c = bpy.data.collections.new('Attic')
bpy.context.scene.collection.children.link(c)
c.objects.link(bpy.data.objects['Out'])
bpy.context.scene.collection.objects.unlink(bpy.data.objects['Out'])
bpy.context.view_layer.layer_collection.children['Attic'].exclude = True
""",
    )
    assert {tuple(one["extent"]["min"]) for one in found.data["objects"]} == {(3, -1, -1)}
    hidden = {one["name"]: one.get("hidden") for one in found.data["objects"]}
    assert hidden == {"Seen": None, "Off": ["viewport", "render"], "Eye": ["layer"], "Out": ["layer"]}
    assert entry(found, "collections", "Attic")["hidden"] == ["excluded"]


# Physics

FALLING = """
scene = bpy.context.scene
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8, location=(0, 0, 2))
flag = bpy.context.object
flag.name = 'Flag'
cloth = flag.modifiers.new('Cloth', 'CLOTH')
cloth.settings.quality, cloth.settings.mass = 9, 0.2
cloth.collision_settings.use_self_collision = True
cloth.settings.effector_weights.gravity = 0.5
cloth.point_cache.frame_end = 6
bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(3, 0, 2))
ball = bpy.context.object
ball.name = 'Ball'
ball.modifiers.new('Softbody', 'SOFT_BODY').settings.goal_default = 0.1
ball.modifiers['Softbody'].point_cache.frame_end = 6
bpy.ops.mesh.primitive_plane_add(location=(-3, 0, 4))
rain = bpy.context.object
rain.name = 'Rain'
rain.modifiers.new('Drops', 'PARTICLE_SYSTEM')
drops = rain.particle_systems[0].settings
drops.count, drops.frame_start, drops.frame_end, drops.normal_factor = 50, 1, 2, 0
drops.effector_weights.wind = 0
rain.particle_systems[0].point_cache.frame_end = 6
bpy.ops.object.effector_add(type='WIND', location=(-5, 0, 1))
bpy.context.object.field.strength = 20
bpy.ops.rigidbody.world_add()
scene.rigidbody_world.point_cache.frame_end = 6
for i in range(5):
    bpy.ops.mesh.primitive_cube_add(size=0.4, location=(0, 3, 0.2 + 0.5 * i))
    b = bpy.context.object
    b.name = 'Brick.%03d' % (i + 1)
    bpy.ops.rigidbody.object_add()
    b.rigid_body.collision_shape = 'BOX'
    b.rigid_body.mass = 1 + i
bpy.ops.object.empty_add()
hinge = bpy.context.object
hinge.name = 'Hinge'
bpy.ops.rigidbody.constraint_add(type='HINGE')
hinge.rigid_body_constraint.object1 = bpy.data.objects['Brick.001']
bpy.ops.mesh.primitive_plane_add(size=20)
bpy.context.object.name = 'Floor'
bpy.ops.rigidbody.object_add(type='PASSIVE')
bpy.context.object.rigid_body.collision_shape = 'BOX'  # of a mesh with Collision, Blender crashes once in 500 times
bpy.context.object.modifiers.new('Collision', 'COLLISION').settings.friction_factor = 0.5
"""


def test_everything_that_simulates_is_told_with_what_differs(session: LiveSession) -> None:
    found = read(session, FALLING)
    cloth = entry(found, "physics", "Flag")
    assert cloth["kind"] == "cloth"
    assert cloth["settings"] == {
        "mass": 0.2,
        "quality": 9,
        "effector_weights.gravity": 0.5,
        "collision_settings.use_self_collision": True,
    }
    assert cloth["cache"]["state"] == "unbaked"
    assert cloth["cache"]["range"] == [1, 6]
    assert entry(found, "physics", "Ball")["settings"] == {"goal_default": 0.1}
    drops = entry(found, "physics", "Rain")
    assert (drops["particles"], drops["emission"], drops["type"]) == (50, [1, 2], "EMITTER")
    assert entry(found, "physics", "Wind") == {
        "kind": "force_field",
        "name": "Wind",
        "type": "WIND",
        "strength": 20,
    }
    bricks = entry(found, "physics", "Brick.001 … Brick.005")
    assert (bricks["count"], bricks["shape"], bricks["mass"]) == (5, "BOX", {"from": 1, "to": 5})
    assert entry(found, "physics", "Floor", kind="rigid_body")["type"] == "PASSIVE"
    assert entry(found, "physics", "Floor", kind="collision")["settings"] == {"friction_factor": 0.5}
    assert entry(found, "physics", "Hinge")["objects"] == ["Brick.001", None]
    world = entry(found, "physics", "Scene", kind="rigid_body_world")
    assert (world["bodies"], world["cache"]["range"]) == (6, [1, 6])
    assert "rigid_body Brick.001 … Brick.005 (5); type=ACTIVE, shape=BOX, mass=1…5" in found.text


def test_a_cache_says_whether_it_is_baked_and_what_it_holds(session: LiveSession) -> None:
    session.run(FALLING + "bpy.ops.ptcache.bake_all(bake=True)\nscene.frame_set(5)")
    found = read(session, sections=["physics", "objects"])
    for name, kind in (("Flag", "cloth"), ("Ball", "soft_body"), ("Scene", "rigid_body_world")):
        cache = entry(found, "physics", name, kind=kind)["cache"]
        assert (cache["state"], cache["frames"]) == ("baked", 6), (name, cache)
        assert cache["bytes"] > 500
    drops = entry(found, "physics", "Rain")
    assert drops["alive"] == 50
    # At most four frames of free fall from z = 4: 9.81 · t² / 2 is 0.14.
    low, high = drops["between"]
    assert 3.8 < low[2] < high[2] <= 4
    assert re.search(r"cloth Flag;.*\n  cache BAKED, frames 1–6, holds 6 in memory, \d", found.text)
    stale = read(
        session,
        "bpy.ops.ptcache.free_bake_all()\n"
        "bpy.data.objects['Flag'].modifiers['Cloth'].settings.quality = 4\n"
        "bpy.context.view_layer.update()",
    )
    cache = entry(stale, "physics", "Flag")["cache"]
    assert (cache["state"], cache["outdated"]) == ("unbaked", True)
    assert "  cache UNBAKED, simulates again, frames 1–6" in stale.text
    assert not any("Outdated" in note for note in stale.data["notes"]), "a bake that was freed is not old"


def test_a_cache_on_disk_is_counted_and_weighed(own_session: LiveSession) -> None:
    found = read(
        own_session,
        """
import os
bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath('scene.blend'))
bpy.ops.mesh.primitive_grid_add(x_subdivisions=8, y_subdivisions=8)
c = bpy.context.object.modifiers.new('Cloth', 'CLOTH')
c.point_cache.use_disk_cache = True
c.point_cache.frame_end = 4
bpy.ops.ptcache.bake_all(bake=True)
""",
    )
    cache = entry(found, "physics", "Grid")["cache"]
    assert (cache["state"], cache["frames"], cache["on_disk"]) == ("baked", 4, True)
    weighed = own_session.run(
        "import os\nd = bpy.path.abspath('//blendcache_scene')\n"
        "sum(os.path.getsize(os.path.join(d, n)) for n in os.listdir(d))"
    )
    assert cache["bytes"] == weighed > 1000


def test_a_fluid_domain_tells_its_type_resolution_and_frames_on_disk(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
import os
o.name = 'Tank'
m = o.modifiers.new('Fluid', 'FLUID')
m.fluid_type = 'DOMAIN'
m.show_viewport = False
d = m.domain_settings
d.resolution_max, d.cache_type, d.cache_directory, d.cache_frame_end = 48, 'MODULAR', '//cache_tank', 30
for part, frames in (('data', range(1, 13)), ('noise', (3, 4))):
    folder = bpy.path.abspath('//cache_tank/' + part)
    os.makedirs(folder, exist_ok=True)
    for frame in frames:
        with open(os.path.join(folder, 'fluid_data_%04d.vdb' % frame), 'wb') as file:
            file.write(b'x' * 100)
bpy.ops.mesh.primitive_cube_add(size=0.5)
m = bpy.context.object.modifiers.new('Fluid', 'FLUID')
m.fluid_type = 'FLOW'
m.flow_settings.flow_behavior = 'INFLOW'
""",
    )
    tank = entry(found, "physics", "Tank")
    assert (tank["kind"], tank["type"], tank["resolution"]) == ("fluid_domain", "GAS", 48)
    assert "settings" not in tank
    assert tank["off"] == ["viewport"]
    cache = tank["cache"]
    assert (cache["type"], cache["range"], cache["state"], cache["bytes"]) == (
        "MODULAR",
        [1, 30],
        "unbaked",
        1400,
    )
    assert cache["on_disk"] == {
        "data": {"first": 1, "last": 12, "frames": 12},
        "noise": {"first": 3, "last": 4, "frames": 2},
    }
    assert entry(found, "physics", "Cube")["settings"] == {"flow_behavior": "INFLOW"}
    assert "on disk: data 1–12 (12), noise 3–4 (2)" in found.text


# Animation

MOVER = (
    CUBE.format("")
    + """
o.name = 'Mover'
o.keyframe_insert('location', frame=1)
o.location = (3, 0, -1)
o.keyframe_insert('location', frame=41)
for frame in range(10, 31):
    o.scale.x = frame / 10
    o.keyframe_insert('scale', index=0, frame=frame)
curve = o.animation_data.action.layers[0].strips[0].channelbags[0].fcurves[0]
curve.modifiers.new('CYCLES')
for key in curve.keyframe_points:
    key.interpolation = 'LINEAR'
o.shape_key_add(name='Basis')
tall = o.shape_key_add(name='Tall')
tall.slider_max = 2
tall.value = 0.5
tall.keyframe_insert('value', frame=7)
aim = bpy.data.objects.new('Aim', None)
bpy.context.scene.collection.objects.link(aim)
driver = o.driver_add('rotation_euler', 2).driver
driver.expression = 'x * 2'
variable = driver.variables.new()
variable.name = 'x'
variable.targets[0].id, variable.targets[0].data_path = aim, 'location.x'
"""
)


def test_a_layered_action_tells_its_channels_keys_and_ranges(session: LiveSession) -> None:
    found = read(session, MOVER)
    moves = entry(found, "animation", "Mover", action="MoverAction", slot="OBMover")
    assert (moves["curves"], moves["keys"], moves["range"]) == (4, 27, [1, 41])
    assert moves["channels"] == [
        {
            "path": "location",
            "keys": 6,
            "axes": [0, 1, 2],
            "frames": [1, 41],
            "values": [[0, 3], [0, 0], [-1, 0]],
            "modifiers": ["CYCLES"],
            "interpolation": ["BEZIER", "LINEAR"],
        },
        {"path": "scale", "keys": 21, "frames": [10, 30], "values": [1, 3], "every_frame": True},
    ]
    shape = entry(found, "animation", "Mover", of="shape keys", slot="KEKey")
    assert shape["channels"][0]["path"] == 'key_blocks["Tall"].value'
    assert moves["points"] == {"location": [[1, 0, 0, 0], [41, 3, 0, -1]]}
    assert "location[0,1,2]: 6 keys, at frame 1: 0 0 0; 41: 3 0 -1, interpolation" in found.text
    assert "scale: 21 keys, frames 10–30, values 1 to 3, a key on every frame" in found.text
    assert "points" not in entry(read(session, detail="summary"), "animation", "Mover", slot="OBMover")


def test_similar_things_are_one_entry_however_many_keys_each_has(session: LiveSession) -> None:
    found = read(
        session,
        "for number in range(8):\n    one = bpy.data.objects.new(f'Lamp.{number:03}', None)\n"
        "    bpy.context.scene.collection.objects.link(one)\n"
        "    for key in range(3 + number % 2):\n"
        "        one.location.x = key\n        one.keyframe_insert('location', index=0, frame=10 * key + 1)\n",
    )
    (lamps,) = [one for one in found.data["animation"] if "channels" in one]
    assert lamps["count"] == 8
    assert "location: 3…4 keys, frames 1–21…31" in found.text


def test_drivers_and_shape_keys_are_told(session: LiveSession) -> None:
    found = read(session, MOVER)
    (driven,) = [one for one in found.data["animation"] if "drivers" in one]
    assert driven["drivers"] == [
        {
            "path": "rotation_euler",
            "type": "SCRIPTED",
            "axis": 2,
            "expression": "x * 2",
            "variables": [{"name": "x", "targets": ["Aim.location.x"]}],
        }
    ]
    (shaped,) = [one for one in found.data["animation"] if "blocks" in one]
    assert shaped["blocks"][1] == {"name": "Tall", "value": 0.5, "range": [0, 2]}
    short = read(session, detail="summary")
    assert "- Mover, 1 drivers" in short.text
    assert "- Mover (shape keys), 2 shape keys" in short.text
    broken = read(
        session, "bpy.data.objects['Mover'].animation_data.drivers[0].driver.expression = 'nobody + 1'"
    )
    assert broken.data["notes"] == ["Broken drivers or animation channels: Mover.rotation_euler."]


def test_an_action_without_a_slot_and_one_without_users_are_named(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("") + "o.keyframe_insert('location', frame=1)\no.animation_data.action_slot = None\n"
        "bpy.data.actions.new('Idle')",
    )
    assert entry(found, "animation", "Cube")["slot"] is None
    assert found.data["notes"] == ["An action is assigned without a slot, so nothing plays: Cube."]
    assert entry(found, "animation", "unused actions")["actions"] == ["Idle"]


def test_ten_thousand_keys_are_one_line(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
import array
o.keyframe_insert('location', frame=1)
curves = o.animation_data.action.layers[0].strips[0].channelbags[0].fcurves
for curve in curves:
    curve.keyframe_points.add(9999)
    curve.keyframe_points.foreach_set('co', array.array('f', [x for i in range(10000) for x in (i + 1, i % 7)]))
for i in range(500):
    curves.new('["p%d"]' % i).keyframe_points.add(2)
""",
        sections=["animation"],
    )
    (moves,) = found.data["animation"]
    assert moves["keys"] == 31_000
    assert moves["channels"][0]["frames"] == [1, 10_000]
    assert moves["channels"][1]["count"] == 500
    assert len(found.text.splitlines()) < 12


# Materials, cameras, lights, world, render


def test_materials_cameras_lights_world_and_render_settings(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
scene = bpy.context.scene
red = bpy.data.materials.new('Red')
shader = red.node_tree.nodes['Principled BSDF']
shader.inputs['Base Color'].default_value = (0.8, 0.1, 0.1, 1)
shader.inputs['Metallic'].default_value = 0.25
noise = red.node_tree.nodes.new('ShaderNodeTexNoise')
red.node_tree.links.new(noise.outputs[0], shader.inputs['Roughness'])
o.data.materials.append(red)
bpy.ops.object.camera_add(location=(0, -5, 0), rotation=(1.5707963267948966, 0, 0))
scene.camera = bpy.context.object
scene.camera.data.lens = 35
bpy.ops.object.light_add(type='AREA', location=(0, 0, 4))
bpy.context.object.data.energy, bpy.context.object.data.size = 200, 2
scene.world = bpy.data.worlds.new('Sky')
scene.world.node_tree.nodes['Background'].inputs['Strength'].default_value = 0.4
scene.render.engine = 'CYCLES'
scene.cycles.samples = 32
scene.render.resolution_x, scene.render.resolution_y = 640, 360
scene.frame_end, scene.render.fps = 96, 30
scene.view_settings.exposure = 0.5
""",
    )
    assert entry(found, "materials", "Red")["surface"] == {
        "shader": "Principled BSDF",
        "inputs": {"Base Color": [0.8, 0.1, 0.1, 1], "Metallic": 0.25, "Roughness": "<- Noise Texture"},
    }
    camera = entry(found, "view", "Camera")
    assert camera["active"]
    assert (camera["lens"], camera["direction"]) == (35, [0, 1, 0])
    area = entry(found, "view", "Area")
    assert (area["energy"], area["direction"], area["size"]) == (200, [0, 0, -1], 2)
    assert entry(found, "view", "Sky")["surface"]["inputs"]["Strength"] == 0.4
    assert entry(found, "view", "Scene")["settings"]["view_settings.exposure"] == 0.5
    scene = found.data["scene"]
    assert (scene["engine"], scene["samples"], scene["resolution"]) == ("CYCLES", 32, [640, 360, 100])
    assert (scene["frame"]["end"], scene["frame"]["fps"], scene["camera"]) == (96, 30, "Camera")
    full = read(session, detail="full", sections=["materials"])
    assert "node Noise Texture" in full.text


def test_nodes_tell_what_differs_from_a_new_one_every_socket_and_the_stops_of_ramps(
    session: LiveSession,
) -> None:
    session.run(
        CUBE.format("")
        + """
paint = bpy.data.materials.new('Paint')
o.data.materials.append(paint)
tree = paint.node_tree
new, link = tree.nodes.new, tree.links.new
maths, ramp, curve, mix, glass = (
    new('ShaderNode' + kind) for kind in ('Math', 'ValToRGB', 'RGBCurve', 'MixShader', 'BsdfGlass')
)
maths.operation = 'MULTIPLY'
maths.inputs[0].default_value, maths.inputs[1].default_value = 3, 4
ramp.color_ramp.elements.new(0.4).color = (1, 0, 0, 1)
curve.mapping.curves[3].points.new(0.5, 0.7)
link(tree.nodes['Principled BSDF'].outputs[0], mix.inputs[1])
link(glass.outputs[0], mix.inputs[2])
link(mix.outputs[0], tree.nodes['Material Output'].inputs['Surface'])
tree.nodes['Principled BSDF'].inputs['Roughness'].default_value = 0.2
"""
    )
    before = session.run("len(bpy.data.node_groups)")
    found = read(session, detail="full", sections=["materials"])
    paint = entry(found, "materials", "Paint")
    nodes = {node["name"]: node for node in paint["tree"]}
    assert nodes["Math"]["inputs"] == {"Value[0]": 3, "Value[1]": 4}
    assert nodes["Color Ramp"]["settings"]["color_ramp"]["stops"] == [
        [0, [0, 0, 0, 1]],
        [0.4, [1, 0, 0, 1]],
        [1, [1, 1, 1, 1]],
    ]
    assert nodes["RGB Curves"]["settings"]["curves"] == {"3": [[0, 0], [0.5, 0.7], [1, 1]]}
    assert nodes["Principled BSDF"]["inputs"] == {"Roughness": 0.2}
    assert paint["surface"]["inputs"] == {"Shader[1]": "<- Principled BSDF", "Shader[2]": "<- Glass BSDF"}
    principled, glass = paint["surface"]["mixed"]
    assert principled["inputs"]["Roughness"] == 0.2
    assert glass["shader"] == "Glass BSDF"
    assert "Principled BSDF = Principled BSDF Base Color=" in read(session, sections=["materials"]).text
    assert session.run("len(bpy.data.node_groups)") == before


def test_chosen_objects_keep_the_view(session: LiveSession) -> None:
    session.run(CUBE.format("") + "bpy.ops.object.camera_add()\nbpy.ops.object.light_add(type='SUN')")
    assert [one["name"] for one in read(session, objects=["Cube"]).data["view"]] == ["Camera", "Sun", "Scene"]
    assert [one["name"] for one in read(session, objects=["Sun"]).data["view"]] == ["Sun", "Scene"]


def test_an_object_and_a_collection_of_one_name_are_both_read(session: LiveSession) -> None:
    session.run(
        """
chair = bpy.data.collections.new('Chair')
bpy.context.scene.collection.children.link(chair)
for name in ('Chair', 'Leg'):
    chair.objects.link(bpy.data.objects.new(name, None))
bpy.data.objects['Chair']['is_object_root'] = True
bpy.context.scene.collection.objects.link(bpy.data.objects.new('Else', None))
"""
    )
    found = read(session, objects=["Chair"])
    assert [one["name"] for one in found.data["objects"]] == ["Chair", "Leg"]
    assert "- Chair root of Chair; at 0 0 0\n" in found.text


def test_a_collision_shape_off_its_mesh_is_marked_and_its_collections_are_numbered(
    session: LiveSession,
) -> None:
    session.run(
        CUBE.format("")
        + """
bpy.ops.rigidbody.object_add()
o.rigid_body.collision_shape = 'BOX'
o.rigid_body.collision_collections = [number in (0, 3) for number in range(20)]
"""
    )
    found = read(session)
    assert "!" not in found.text
    assert entry(found, "physics", "Cube")["settings"]["collision_collections"] == [0, 3]
    session.run("for vertex in bpy.data.objects['Cube'].data.vertices: vertex.co.z += 0.25")
    marked = read(session).text
    assert "BOX of 'Cube' by 0.25 m" in marked
    session.run("bpy.data.objects['Cube'].rigid_body.collision_shape = 'CONVEX_HULL'")
    assert "BOX of" not in read(session).text


# What fits, and how to ask for more

CROWD = """
import random
random.seed(7)
scene = bpy.context.scene
bpy.ops.mesh.primitive_cube_add(size=0.2)
data = bpy.context.object.data
bpy.data.objects.remove(bpy.context.object)
wall = bpy.data.collections.new('Wall')
scene.collection.children.link(wall)
for i in range(1200):
    o = bpy.data.objects.new('Brick.%03d' % (i + 1), data)
    o.location, o.rotation_euler.z = (i % 40, 0, i // 40), i % 3
    wall.objects.link(o)
    if i % 2:
        o.modifiers.new('Bevel', 'BEVEL').width = 0.01 + i / 1e5
for i in range(200):
    tree = bpy.data.collections.new('Tree.%03d' % i)
    tree['protocol_role'] = 'object'
    scene.collection.children.link(tree)
    root = bpy.data.objects.new('Tree.%03d.root' % i, None)
    root['is_object_root'] = True
    mesh = bpy.data.objects.new('Tree.%03d.mesh' % i, data)
    mesh.parent = root
    tree.objects.link(root)
    tree.objects.link(mesh)
for i in range(400):
    o = bpy.data.objects.new(''.join(random.choice('abcdefgh') for _ in range(9)), data)
    o.location.x = i
    scene.collection.objects.link(o)
"""


# Of the same kinds, but fewer; it still is too much for a readout.
SMALL_CROWD = (
    CROWD.replace("1200", "500").replace("range(200)", "range(60)").replace("range(400)", "range(100)")
)


@pytest.mark.parametrize("detail", ["summary", "normal", pytest.param("full", marks=pytest.mark.whole)])
def test_two_thousand_objects_fit_folded(session: LiveSession, detail: str) -> None:
    found = read(session, CROWD, detail=detail)
    assert sum(found.data["scene"]["counts"].values()) == 2000
    assert len(json.dumps(found.data)) < 12 * 4000
    trees = entry(found, "collections", "Tree.000 … Tree.199")
    assert (trees["count"], trees["objects"]) == (200, {"EMPTY": 1, "MESH": 1})
    if detail != "summary":
        even = entry(found, "objects", "Brick.001 … Brick.1199")
        assert (even["count"], even["pattern"]) == (600, "Brick.*")
        assert even["extent"]["max"][2] == pytest.approx(29.1, abs=1e-3)
        assert sum(one.get("count", 1) for one in found.data["objects"]) == 2000
    else:
        assert "Brick.001 … Brick.1200 (1200)" in found.text


def test_left_out_entries_are_counted_and_the_named_call_shows_them(session: LiveSession) -> None:
    session.run(SMALL_CROWD)
    seen: list[str] = []
    call: dict[str, Any] = {"objects": ["Brick.*"], "sections": ["objects"], "max_tokens": 5_000}
    for _ in range(40):
        found = read(session, **call)
        seen += [one["name"] for one in found.data["objects"]]
        left = found.data["left_out"].get("objects")
        if left is None:
            break
        assert left["count"] == 500 - len(seen)
        assert left["call"] in found.text
        call = named(left["call"])
    assert len(seen) == len(set(seen)) == 500


def named(call: str) -> dict[str, Any]:
    """The arguments of a call as the readout names it."""
    assert call.startswith("blender_scene_state(")
    return eval(f"dict({call.removeprefix('blender_scene_state(')}")


def test_no_readout_is_longer_than_asked_for(session: LiveSession) -> None:
    session.run(SMALL_CROWD + FALLING)
    for detail in ("summary", "normal", "full"):
        for objects in (None, ["Wall", "Flag", "Ball"]):
            given = {"detail": detail, "objects": objects}
            facts = session.blender.call(
                "scene_state", {**given, "sections": SECTIONS}, unread, timeout=60
            ).value
            for room in (500, 1000, 4000, 12_000):
                found = readout(facts, SceneStateArguments(**given, max_tokens=room))
                assert tokens(found.text) <= room
                assert len(found.text.encode()) <= 3 * room
                assert len(json.dumps(found.data)) < 12 * room + 4000
                assert objects is None or detail == "summary" or tokens(found.text) > 0.7 * room


def test_copies_are_of_one_series_with_what_they_are_copies_of(session: LiveSession) -> None:
    code = "for i in range(6):\n    bpy.ops.mesh.primitive_cube_add(location=(3 * i, 0, 0))"
    cubes = entry(read(session, code), "objects", "Cube … Cube.005")
    assert (cubes["count"], cubes["pattern"], cubes["location"]) == (
        6,
        "Cube*",
        [{"from": 0, "to": 15}, 0, 0],
    )
    assert len(read(session, objects=[cubes["pattern"]]).data["objects"]) == 6


def test_folding_hides_no_setting_that_only_some_have(session: LiveSession) -> None:
    code = """
for i in range(10):
    bpy.ops.mesh.primitive_cube_add(location=(3 * i, 0, 0))
    o = bpy.context.object
    o['box'] = {'min': i, 'max': 'x', 'size': 2, 'from': 1, 'to': [i]}
    w = o.modifiers.new('Wave', 'WAVE')
    if i % 2:
        w.height, w.narrowness, w.use_cyclic = 1 + i, 3, False
"""
    told = read(session, code, detail="full").data["objects"]
    assert [one["count"] for one in told] == [5, 5]
    assert "settings" not in told[0]["modifiers"][0]
    assert told[1]["modifiers"][0]["settings"] == {
        "use_cyclic": False,
        "height": {"from": 2, "to": 10},
        "narrowness": 3,
    }
    box = {"min": {"from": 0, "to": 8}, "max": "x", "size": 2, "from": 1, "to": [{"from": 0, "to": 8}]}
    assert told[0]["custom"]["box"] == box


def test_objects_are_chosen_by_name_pattern_and_collection(session: LiveSession) -> None:
    session.run(SMALL_CROWD + "o = bpy.data.objects.new('odd[1]', None)\nscene.collection.objects.link(o)")
    found = read(session, objects=["Brick.00[12]", "Tree.007", "odd[1]"])
    names = [one["name"] for one in found.data["objects"]]
    assert names == ["odd[1]", "Brick.001", "Brick.002", "Tree.007.root", "Tree.007.mesh"]
    assert [one["name"] for one in found.data["collections"]] == ["Scene Collection", "Wall", "Tree.007"]


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ("Brik.001", "Brick.001"),
        ("brick.001", "'Brick.001'"),
        ("Stone*", "No object fits 'Stone*'"),
        ("x" * 255, "other names"),
    ],
)
def test_a_name_that_is_not_there_is_refused_with_the_nearest(
    session: LiveSession, asked: str, told: str
) -> None:
    session.run(SMALL_CROWD)
    with pytest.raises(Refusal, match=re.escape(told)):
        session.use(TOOL, objects=[asked])


def test_an_object_of_another_scene_and_an_empty_scene_are_told_apart(session: LiveSession) -> None:
    with pytest.raises(Refusal, match="has no objects"):
        session.use(TOOL, objects=["Cube"])
    session.run(
        "s = bpy.data.scenes.new('Other')\ns.collection.objects.link(bpy.data.objects.new('Away', None))"
    )
    session.run("bpy.context.scene.collection.objects.link(bpy.data.objects.new('Here', None))")
    with pytest.raises(Refusal, match="not in the scene 'Scene'"):
        session.use(TOOL, objects=["Away"])


@pytest.mark.parametrize(
    "arguments",
    [
        {"detail": "all"},
        {"sections": ["everything"]},
        {"sections": []},
        {"objects": [""]},
        {"start": -1},
        {"max_tokens": 10},
        {"frame": 3},
    ],
)
def test_arguments_that_do_not_fit_are_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(Refusal, match=next(iter(arguments))):
        parse(TOOL, arguments)


# What must not break it


def test_nan_and_infinity_are_reported_as_json(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
o.name, o.location.x = 'Lost', float('nan')
bpy.ops.mesh.primitive_cube_add(rotation=(1, 1, 0))
bpy.context.object.data.vertices[0].co.x = float('inf')
bpy.context.object['weight'] = float('nan')
m = bpy.context.object.modifiers.new('Push', 'DISPLACE')
m.strength = float('nan')
""",
        detail="full",
    )
    assert entry(found, "objects", "Lost")["location"] == ["nan", 0, 0]
    assert entry(found, "objects", "Cube")["custom"] == {"weight": "nan"}
    assert found.data["notes"][0] == "Transforms with values that are not finite: Lost."
    assert found.data["notes"][1].startswith("Geometry with coordinates that are not finite")


def test_names_and_properties_of_any_kind_stay_in_their_line(session: LiveSession) -> None:
    found = read(
        session,
        CUBE.format("")
        + """
o.name = 'two\\nlines # head'
o['contact_with'] = ['Thing %d' % i for i in range(100)]
o['many'] = {'k%d' % i: [1.0] * 50 for i in range(200)}
o['long'] = 'x' * 100_000
o['array'] = [0.5] * 500_000
o['owner'] = o
""",
        detail="full",
    )
    told = entry(found, "objects", r"two\nlines # head")
    assert len(told["tags"]["contact_with"]) == 17
    assert told["tags"]["contact_with"][-1] == "… 84 more"
    assert told["custom"]["array"] == "float[500000]"
    assert told["custom"]["owner"] == r"two\nlines # head"
    assert len(told["custom"]["many"]) == 25
    assert len(told["custom"]["long"]) == 120
    assert "\nlines" not in found.text


def test_a_linked_library_that_is_gone_is_named(session: LiveSession) -> None:
    found = read(
        session,
        """
import os
path = bpy.path.abspath('//shelf.blend')
bpy.ops.mesh.primitive_cube_add()
bpy.data.objects['Cube'].name = 'Lamp'
bpy.data.libraries.write(path, {bpy.data.objects['Lamp']})
bpy.ops.wm.read_factory_settings(use_empty=True)
with bpy.data.libraries.load(path, link=True) as (there, here):
    here.objects = ['Lamp']
bpy.context.scene.collection.objects.link(here.objects[0])
os.remove(path)
""",
    )
    assert entry(found, "objects", "Lamp")["linked"].endswith("shelf.blend")
    assert found.data["notes"][0].startswith("A linked library is missing: ")


def test_collections_in_a_ring_of_parents_are_told_once(session: LiveSession) -> None:
    found = read(
        session,
        """
row = [bpy.context.scene.collection]
for i in range(6):
    pair = [bpy.data.collections.new(name + 'abcdef'[i]) for name in ('left ', 'right ')]
    for above in row:
        for below in pair:
            above.children.link(below)
    row = pair
row[0].objects.link(bpy.data.objects.new('Deep', None))
""",
    )
    again = [one for one in found.data["collections"] if one.get("again")]
    assert len(found.data["collections"]) - len(again) == 13
    assert entry(found, "objects", "Deep")["in"] == ["left f"]


def test_every_type_of_object_and_edit_mode_can_be_read(session: LiveSession) -> None:
    found = read(
        session,
        """
for made in ('metaball_add()', 'armature_add()', 'volume_add()', 'speaker_add()', 'lightprobe_add()',
             'pointcloud_random_add()', 'curves_random_add()', 'grease_pencil_add(type="MONKEY")',
             'text_add(rotation=(1, 0, 0))', 'add(type="LATTICE")', 'add(type="CURVE")', 'add(type="MESH")'):
    eval('bpy.ops.object.' + made)
bpy.ops.mesh.primitive_cube_add()
bpy.ops.object.mode_set(mode='EDIT')
""",
    )
    assert len(found.data["scene"]["counts"]) == 12
    assert entry(found, "objects", "Mesh")["vertices"] == "no"
    assert entry(found, "objects", "Text")["extent"]["size"][1] < 1e-3 + 0.7 * math.cos(1)
    assert found.data["notes"] == ["Blender is in EDIT_MESH mode (Cube): edits show only after leaving it."]
    session.run("bpy.ops.object.mode_set(mode='OBJECT')")


def test_an_empty_scene_is_short(session: LiveSession) -> None:
    found = read(session)
    assert "no objects" in found.text
    assert found.data["left_out"] == {}
    assert len(found.text) < 600


# It leaves no trace, and is quick

STATE = """
scene = bpy.context.scene
caches = [m.point_cache for o in scene.objects for m in o.modifiers if hasattr(m, 'point_cache')]
caches += [p.point_cache for o in scene.objects for p in o.particle_systems]
caches += [scene.rigidbody_world.point_cache]
graph = bpy.context.view_layer.depsgraph
repr((
    scene.frame_current, len(updates), bpy.context.view_layer.objects.active.name,
    [(c.info, c.is_baked, c.is_outdated, c.frame_start, c.frame_end) for c in caches],
    sorted((o.name, o.select_get(), [round(x, 6) for r in o.matrix_world for x in r]) for o in scene.objects),
    {k: len(getattr(bpy.data, k)) for k in dir(bpy.data) if hasattr(getattr(bpy.data, k), 'foreach_get')},
    [round(v.co.z, 6) for v in bpy.data.objects['Flag'].evaluated_get(graph).data.vertices],
))
"""


def test_reading_leaves_no_trace(session: LiveSession) -> None:
    watch = "import builtins\nupdates = bpy.app.driver_namespace.setdefault('seen', [])\n"
    session.run(
        FALLING
        + watch
        + "for f in range(1, 4): scene.frame_set(f)\n"
        + "bpy.app.handlers.depsgraph_update_post.append(lambda *a: bpy.app.driver_namespace['seen'].append(1))\n"
        + "bpy.app.handlers.frame_change_post.append(lambda *a: bpy.app.driver_namespace['seen'].append(2))"
    )
    before = session.run(watch + STATE)
    for detail in ("summary", "normal", "full"):
        read(session, detail=detail)
    assert session.run(watch + STATE) == before


def test_five_hundred_objects_take_less_than_a_third_of_a_second(session: LiveSession) -> None:
    session.run(
        CROWD.replace("1200", "500").replace("range(200)", "range(0)").replace("range(400)", "range(0)")
    )
    arguments = {"detail": "normal", "objects": None, "sections": list(SECTIONS)}
    spent = session.run(
        "import time\nfrom simworlds_worker.state.readout import scene_state\n"
        f"def spent():\n    started = time.process_time()\n    scene_state({arguments}, print)\n"
        "    return time.process_time() - started\nmin(spent() for _ in range(4))"
    )
    assert spent <= 0.3  # of the processor, not of the clock


def test_entries_keep_the_order_of_the_scene(session: LiveSession) -> None:
    found = read(
        session,
        "for n in 'zyxabc':\n bpy.context.scene.collection.objects.link(bpy.data.objects.new(n, None))",
    )
    names = [one["name"] for one in found.data["objects"]]
    assert sorted(names) == sorted("zyxabc")
    assert names == session.run("[o.name for o in bpy.context.scene.collection.objects]")
    places = [found.text.index(f"- {name} EMPTY") for name in names]
    assert all(one < other for one, other in pairwise(places))


def test_what_is_asked_for_comes_first_with_its_materials(session: LiveSession) -> None:
    session.run(
        """
for number in range(12):
    bpy.ops.mesh.primitive_cube_add(location=(3 * number, 0, 0), rotation=(0, 0, number / 10))
    made = bpy.context.object
    made.name = 'FloorLamp_Shade' if number == 9 else f'Thing {chr(65 + number)}'
    made.data.materials.append(bpy.data.materials.new(f'Paint {chr(65 + number)}'))
"""
    )
    asked = words_of("Switch the floor lamp on, so that it lights the sofa's corner.")
    assert asked == ["switch", "floor", "lamp", "light", "sofa", "corner"]
    found = read(session, first=["sofa", "lamp"])
    assert found.data["objects"][0]["name"] == "FloorLamp_Shade"
    assert found.data["materials"][0]["name"] == "Paint J"
    short = read(session, first=["sofa", "lamp"], max_tokens=500, sections=["objects"])
    assert 'first=["sofa", "lamp"], sections=["objects"], start=' in short.text
    assert "FloorLamp_Shade" in short.text


# Parts

CHAIR = """
import bmesh
mesh, made = bpy.data.meshes.new('Chair'), bmesh.new()
legs = [((x, y, 0.2), (0.05, 0.05, 0.4)) for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
for place, size in [((0, 0, 0.425), (0.5, 0.5, 0.05)), ((0, 0.24, 0.7), (0.5, 0.02, 0.5)), *legs]:
    new = bmesh.ops.create_cube(made, size=1)['verts']
    bmesh.ops.scale(made, vec=size, verts=new)
    bmesh.ops.translate(made, vec=place, verts=new)
made.to_mesh(mesh)
chair = bpy.data.objects.new('Chair', mesh)
chair.location, chair.rotation_euler.z, chair.scale = (3, 1, 0), 0.6, (1, 1, 2)
bpy.context.scene.collection.objects.link(chair)
"""


def test_the_parts_of_a_mesh_are_measured_along_its_own_axes(session: LiveSession) -> None:
    found = read(session, CHAIR, detail="full")
    told = entry(found, "objects", "Chair")
    assert told["parts"][:2] == [[[0.5, 0.02, 1.0], [0, 0.24, 0.9]], [[0.5, 0.5, 0.1], [0, 0, 0.8]]]
    assert (len(told["parts"]), told["more_parts"]) == (4, 2)
    assert "parts (size @ middle of underside, own axes): 0.5×0.02×1 @ 0 0.24 0.9, " in found.text
    assert "parts" not in entry(read(session), "objects", "Chair"), "told where a readout is full"
    assert "parts" not in entry(read(session, first=["stool"]), "objects", "Chair")
    assert entry(read(session, first=["chairs"]), "objects", "Chair")["parts"] == told["parts"]
    many = read(session, "bpy.data.objects['Chair'].modifiers.new('Row', 'ARRAY').count = 3", detail="full")
    assert entry(many, "objects", "Chair")["more_parts"] == 14
    assert ", 14 smaller ones" in many.text


def test_a_mesh_of_one_part_has_no_parts(session: LiveSession) -> None:
    assert "parts" not in entry(read(session, CUBE.format(""), detail="full"), "objects", "Cube")


WITHOUT_NUMPY = """
import sys
sys.modules["numpy"] = None
import bpy
from agents.blender.inside.state.readout import scene_state
from agents.blender.inside.readout_sections import SECTIONS
wanted = {"detail": "full", "objects": None, "sections": SECTIONS, "parts": True}
print("objects:", sum(1 for _ in scene_state(wanted, print)["objects"]))
"""


def test_a_blender_without_numpy_reads_all_but_parts() -> None:
    ran = subprocess.run(
        [sys.executable, "-c", WITHOUT_NUMPY], cwd=REPO, capture_output=True, text=True, check=True
    )
    assert "objects: 3" in ran.stdout.splitlines()  # Blender may say something of its sound at the end


# Focus

ROOM = """
def box(name, at, collection, parent=None):
    made = bpy.data.objects.new(name, bpy.data.meshes.new_from_object(unit))
    made.location, made.parent = at, parent
    collection.objects.link(made)
    paint = bpy.data.materials.new(name + ' surface')
    made.data.materials.append(paint)
    return made

scene = bpy.context.scene
bpy.ops.mesh.primitive_cube_add(size=0.1)
unit = bpy.context.object
kitchen, shelf = bpy.data.collections.new('Kitchen'), bpy.data.collections.new('Shelf')
scene.collection.children.link(kitchen)
kitchen.children.link(shelf)
mug = box('Mug', (0, 0, 0), scene.collection)
box('Handle', (0.1, 0, 0), scene.collection, mug)
box('Mug rack', (1, 0, 0), kitchen)
for n in range(30):
    box(f'Spoon.{n:03}', (n, 1, 0), kitchen)
    box(f'Plate {chr(65 + n)}', (n, 2, 0), shelf)
box('Lamp', (5, 0, 0), scene.collection)
bpy.data.objects.remove(unit)
light = bpy.data.objects.new('Bulb', bpy.data.lights.new('Bulb', 'POINT'))
scene.collection.objects.link(light)
light.keyframe_insert('location')
"""


def test_a_readout_with_a_focus_has_it_in_full_and_counts_the_rest(session: LiveSession) -> None:
    session.run(ROOM)
    old = [name for name in session.run("[o.name for o in bpy.data.objects]") if name != "Lamp"]
    found = read(session, focus=["Mug", "Jug"], old=old)
    assert [one["name"] for one in found.data["objects"]] == ["Mug", "Handle", "Lamp"], (
        "with children, and what is new"
    )
    assert {one["name"] for one in found.data["materials"]} == {
        "Mug surface",
        "Handle surface",
        "Lamp surface",
    }
    assert "## Objects (3 of 65)" in found.text
    assert "## The rest (62 objects): blender_scene_state(objects=[…]) shows more of it" in found.text
    assert "- Kitchen: 61 objects: Mug rack, Spoon.000 … Spoon.029 (30), Shelf" in found.text
    assert "- Scene Collection: 1 object: Bulb" in found.text
    assert "- animation of Bulb" in found.text
    assert "- 61 materials" in found.text
    assert "- 1 light" in found.text
    assert len(found.text.encode()) < 2_000


def test_a_focus_may_be_a_collection_a_material_or_words(session: LiveSession) -> None:
    session.run(ROOM)

    def objects(*focus: str, **more: Any) -> list[str]:
        return [one["name"] for one in read(session, focus=focus, **more).data["objects"]]

    assert objects("Shelf") == [f"Plate {chr(65 + n)}" for n in range(30)]
    assert objects("racks of mugs") == []
    assert objects("mug racks") == ["Mug rack"]
    named = read(session, focus=["Lamp surface", "Bulb"])
    assert [one["name"] for one in named.data["materials"]] == ["Lamp surface"]
    assert [one["kind"] for one in named.data["view"]][:1] == ["light"]
    assert [one["name"] for one in named.data["animation"]] == ["Bulb"]


def test_what_of_a_focus_does_not_fit_is_named_with_its_call(session: LiveSession) -> None:
    session.run(ROOM)
    found = read(session, focus=["Shelf", "Kitchen"], max_tokens=600)
    assert found.data["left_out"]["objects"]["count"] > 0
    assert found.data["left_out"]["objects"]["call"].startswith("blender_scene_state(objects=[")
