"""``blender_motion_sheet_preview``: how things move, measured against what physics and keyframes prescribe."""

from __future__ import annotations

import io
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from agents.blender.sheets.motion_plot import lanes_of
from agents.blender.sheets.motion_reply import MotionReply
from agents.blender.tools.base import Call
from agents.blender.tools.motion_sheet import TOOL
from simworlds.sandbox.errors import Refusal, Untrustworthy

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.blender.tools.base import Result

pytestmark = pytest.mark.blender

G = 9.81
RED = "m = bpy.data.materials.new('Red')\nm.diffuse_color = (0.8, 0.02, 0.02, 1)\nm.use_nodes = True\n" + (
    "m.node_tree.nodes['Principled BSDF'].inputs['Base Color'].default_value = (0.8, 0.02, 0.02, 1)\n"
    "o.data.materials.append(m)\n"
)
FALL = f"""
s = bpy.context.scene
s.frame_end = 60
bpy.ops.mesh.primitive_plane_add(size=20)
bpy.context.object.name = 'Floor'
bpy.ops.rigidbody.object_add(type='PASSIVE')
bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 5))
o = bpy.context.object
o.name = 'Crate'
bpy.ops.rigidbody.object_add()
o.rigid_body.collision_shape = 'BOX'
{RED}"""
SLIDE = f"""
s = bpy.context.scene
s.frame_end = 60
bpy.ops.mesh.primitive_cube_add(size=1)
o = bpy.context.object
o.name = 'Sledge'
{RED}
o.keyframe_insert('location', frame=1)
o.keyframe_insert('rotation_euler', frame=1)
o.location.x, o.rotation_euler.z = 10, 6.283185307
o.keyframe_insert('location', frame=49)
o.keyframe_insert('rotation_euler', frame=49)
from simworlds_worker.blend.fcurves import curves_of
for curve in curves_of(o):
    for key in curve.keyframe_points:
        key.interpolation = 'LINEAR'
"""
STATE = """
from simworlds_worker.digests.fingerprint import fingerprint
s = bpy.context.scene
w = s.rigidbody_world
blocks = {name: len(getattr(bpy.data, name)) for name in dir(bpy.data)
          if isinstance(getattr(bpy.data, name), bpy.types.bpy_prop_collection)}
blocks, fingerprint(s), s.frame_current, s.frame_subframe, w and (w.point_cache.is_baked, w.point_cache.is_outdated)
"""


def actor(found: Result, name: str) -> dict[str, Any]:
    return next(one for one in found.data["actors"] if one["name"] == name)


def red_places(found: Result, panels: int, height: int) -> list[tuple[float, float]]:
    """Of each panel of the first strip, which is so high, the mean place of what is red in it, in pixels."""
    picture = np.asarray(Image.open(io.BytesIO(found.pictures[0].png)).convert("RGB")).astype(int)
    strip = picture[136 : 136 + height, 12:-12]
    red = (strip[..., 0] > 100) & (strip[..., 1] < 80) & (strip[..., 2] < 80)
    places: list[tuple[float, float]] = []
    for part in np.array_split(red, panels, axis=1):
        rows, columns = np.nonzero(part)
        assert len(rows) > 20, "there is nothing red"
        places.append((float(columns.mean()), float(rows.mean())))
    return places


def test_a_falling_body_falls_as_physics_has_it_and_comes_to_rest(session: LiveSession) -> None:
    session.run(FALL)
    found = session.use(
        TOOL,
        actors=["Crate"],
        phases=[{"name": "fall", "start": 1, "end": 20}, {"name": "settle", "start": 20, "end": 60}],
    )
    crate = actor(found, "Crate")
    fall, settle = crate["phases"]
    assert fall["displacement"] == pytest.approx(G / 2 * (19 / 24) ** 2, rel=0.02)
    assert fall["displacement_vector"][2] == pytest.approx(-fall["displacement"], rel=1e-3)
    assert fall["peak_speed"] == pytest.approx(G * 18.5 / 24, rel=0.02)
    assert (fall["peak_frame"], fall["contacts"]) == (20, [])
    assert settle["end_position"][2] == pytest.approx(0.5, abs=0.02)
    assert settle["final_speed"] < 0.01
    floor = settle["contacts"][0]
    assert floor["with"] == "Floor"
    first, last = floor["frames"][-1]
    assert first == pytest.approx(1 + 24 * math.sqrt(2 * 4.5 / G), abs=1.5)
    assert last == 60
    assert crate["speed_of"] == "centre"


def test_a_ball_that_bounces_touches_the_floor_again_and_again(session: LiveSession) -> None:
    session.run(
        "s = bpy.context.scene\ns.frame_end = 90\nbpy.ops.mesh.primitive_plane_add(size=20)\n"
        "f = bpy.context.object\nf.name = 'Floor'\nbpy.ops.rigidbody.object_add(type='PASSIVE')\n"
        "bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3, radius=0.1, location=(0, 0, 2.1))\n"
        "o = bpy.context.object\no.name = 'Ball'\nbpy.ops.rigidbody.object_add()\n"
        "o.rigid_body.collision_shape = 'SPHERE'\no.rigid_body.restitution = f.rigid_body.restitution = 0.9"
    )
    ball = actor(session.use(TOOL, actors=["Ball"], frames=[1, 90]), "Ball")
    times = [first for first, _ in ball["phases"][0]["contacts"][0]["frames"]]
    # It falls 2 m in 0.64 s, bounces with 0.9 of its speed, and is in the air for 0.9 of twice that time.
    assert times[0] == pytest.approx(1 + 24 * 0.64, abs=1.5)
    assert len(times) >= 2
    assert times[1] - times[0] == pytest.approx(24 * 2 * 0.64 * 0.9, abs=2)


def test_what_is_not_baked_is_stepped_and_moves_as_when_it_is_baked(session: LiveSession) -> None:
    session.run(FALL + "o.rotation_euler = (0.5, 0.4, 0.3)\n")
    asked: dict[str, Any] = {"actors": ["Crate"], "frames": [25, 40]}
    stepped = session.use(TOOL, **asked)
    session.run("bpy.ops.ptcache.bake_all(bake=True)")
    played = session.use(TOOL, **asked)
    assert stepped.data["stepped_from"] == 1
    assert "not baked: the rigid-body world" in stepped.text
    assert "stepped_from" not in played.data
    assert [one["state"] for one in actor(stepped, "Crate")["caches"]] == ["unbaked"]
    assert [one["state"] for one in actor(played, "Crate")["caches"]] == ["baked"]
    one, other = (actor(found, "Crate") for found in (stepped, played))
    assert one["phases"] == other["phases"]
    assert one["samples"] == other["samples"]
    assert one["samples"][0]["position"][2] < 1.5, "it has fallen by frame 25"
    assert one["phases"][0]["turn"] > 5


def test_a_bake_that_is_outdated_is_told(session: LiveSession) -> None:
    session.run(
        FALL + "bpy.ops.ptcache.bake_all(bake=True)\no.location.z = 4\nbpy.context.view_layer.update()"
    )
    found = actor(session.use(TOOL, actors=["Crate"], frames=[1, 20]), "Crate")
    assert found["caches"][0]["state"] == "baked, outdated"
    assert "outdated" in found["notes"][0]


def test_keyframed_motion_has_its_exact_speeds(session: LiveSession) -> None:
    session.run(SLIDE)
    phases = [{"name": "rest", "start": 49, "end": 60}, {"name": "slide", "start": 1, "end": 49}]
    found = session.use(TOOL, actors=["Sledge"], phases=phases)
    sledge = actor(found, "Sledge")
    slide, rest = sledge["phases"]
    assert (slide["phase"], rest["phase"]) == ("slide", "rest")
    assert slide["displacement_vector"] == pytest.approx([10, 0, 0], abs=1e-4)
    assert slide["path_length"] == pytest.approx(10, abs=1e-3)
    assert (slide["peak_speed"], slide["final_speed"]) == pytest.approx((5, 5), rel=1e-3)
    assert slide["turn"] == pytest.approx(360, abs=0.5)
    assert (rest["displacement"], rest["peak_speed"], rest["turn"]) == pytest.approx((0, 0, 0), abs=1e-3)
    assert sledge["keyframes"] == [1, 49]
    assert "stepped_from" not in found.data


def test_a_flat_thing_is_seen_from_its_wide_side_however_it_is_turned(session: LiveSession) -> None:
    """A wall that is pushed a little along its normal: from where its way is seen best, it is a line."""
    seen: list[int] = []
    for turn in (0, 30, 60, 90, 120, 150):
        session.empty()
        session.run(
            f"import math\nturn = math.radians({turn})\ns = bpy.context.scene\ns.frame_end = 12\n"
            "bpy.ops.mesh.primitive_cube_add(size=1)\no = bpy.context.object\n"
            "o.name, o.scale, o.rotation_euler.z = 'Wall', (2, 0.01, 1.2), turn\n"
            f"{RED}\no.keyframe_insert('location', frame=1)\n"
            "o.location = (-0.1 * math.sin(turn), 0.1 * math.cos(turn), 0)\n"
            "o.keyframe_insert('location', frame=12)"
        )
        found = session.use(TOOL, actors=["Wall"], frames=[1, 12])
        picture = np.asarray(Image.open(io.BytesIO(found.pictures[0].png)).convert("RGB")).astype(int)
        strip = picture[136:336, 12:-12]
        seen.append(int(((strip[..., 0] > 100) & (strip[..., 1] < 80) & (strip[..., 2] < 80)).sum()))
    assert min(seen) > max(seen) / 2, seen


def test_particles_that_are_far_smaller_than_a_pixel_are_seen_and_a_lost_one_does_not_make_them_a_point(
    session: LiveSession,
) -> None:
    session.run(
        "s = bpy.context.scene\ns.frame_end = 24\ns.gravity = (0, 0, 0)\n"
        "bpy.ops.mesh.primitive_plane_add(size=4)\nbpy.context.object.name = 'Cloud'\n"
        "dust = bpy.context.object.modifiers.new('Dust', 'PARTICLE_SYSTEM').particle_system.settings\n"
        "dust.count, dust.frame_end, dust.normal_factor, dust.particle_size = 300, 1, 0.2, 0.001\n"
        "bpy.ops.mesh.primitive_plane_add(size=0.1, location=(0, 0, 0))\nbpy.context.object.parent = None\n"
        "lost = bpy.context.object\nlost.name = 'Shot'\n"
        "shot = lost.modifiers.new('Shot', 'PARTICLE_SYSTEM').particle_system.settings\n"
        "shot.count, shot.frame_end, shot.normal_factor = 3, 1, 200\n"
        "whole = bpy.data.collections.new('Whole')\ns.collection.children.link(whole)\n"
        "for part in (lost, bpy.data.objects['Cloud']):\n    whole.objects.link(part)"
    )
    found = session.use(TOOL, actors=["Whole"], frames=[6, 24])
    picture = np.asarray(Image.open(io.BytesIO(found.pictures[0].png)).convert("RGB")).astype(int)
    strip = picture[136:336, 12:620]
    orange = (strip[..., 0] > 150) & (strip[..., 1] < 130) & (strip[..., 2] < 80)
    columns = np.nonzero(orange.any(axis=0))[0]
    assert orange.sum() > 300, "the particles are not seen"
    assert columns.max() - columns.min() > 100, "most particles are in one place of the picture"


def test_many_vertices_in_one_place_weigh_no_more_than_their_surface(session: LiveSession) -> None:
    """A door's leaf, whose hinge has more vertices than all the rest."""
    session.run(
        "import math\n"
        "bpy.ops.mesh.primitive_cylinder_add(vertices=200, radius=0.01, depth=0.2)\nhinge = bpy.context.object\n"
        "bpy.ops.mesh.primitive_cube_add(size=1, location=(0.5, 0, 0))\nleaf = bpy.context.object\n"
        "leaf.name, leaf.scale = 'Leaf', (1, 0.02, 2)\nbpy.ops.object.transform_apply(location=False)\n"
        "hinge.select_set(True)\nbpy.ops.object.join()\n"
        "bpy.context.scene.cursor.location = (0, 0, 0)\nbpy.ops.object.origin_set(type='ORIGIN_CURSOR')\n"
        "leaf.keyframe_insert('rotation_euler', frame=1)\nleaf.rotation_euler.z = math.pi / 2\n"
        "leaf.keyframe_insert('rotation_euler', frame=20)\nbpy.context.scene.frame_end = 20"
    )
    (motion,) = actor(session.use(TOOL, actors=["Leaf"]), "Leaf")["phases"]
    assert motion["displacement"] == pytest.approx(0.5 * math.sqrt(2), rel=0.02)


def test_cloth_is_measured_by_its_vertices_for_its_origin_stays(session: LiveSession) -> None:
    session.run(
        "s = bpy.context.scene\ns.frame_end = 30\n"
        "bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(0, 0, 0.6))\n"
        "bpy.context.object.name = 'Ball'\nbpy.context.object.modifiers.new('C', 'COLLISION')\n"
        "bpy.ops.mesh.primitive_grid_add(x_subdivisions=16, y_subdivisions=16, size=2, location=(0, 0, 1.6))\n"
        "bpy.context.object.name = 'Sheet'\nbpy.context.object.modifiers.new('Cloth', 'CLOTH')"
    )
    sheet = actor(session.use(TOOL, actors=["Sheet"]), "Sheet")
    motion = sheet["phases"][0]
    assert session.run("tuple(bpy.data.objects['Sheet'].matrix_world.translation)") == pytest.approx(
        (0, 0, 1.6)
    )
    assert motion["start_position"] == pytest.approx([0, 0, 1.6], abs=1e-3)
    assert -1.2 < motion["displacement_vector"][2] < -0.4
    assert sheet["deforms"]
    assert sheet["speed_of"] == "vertices"
    ball = motion["contacts"][0]
    assert ball["with"] == "Ball"
    # The gap of 0.4 m takes 0.29 s to fall through.
    assert 6 <= ball["frames"][0][0] <= 12


@pytest.mark.parametrize("shown", [True, False])
def test_dead_particles_count_where_they_are_shown(session: LiveSession, shown: bool) -> None:
    session.run(
        "import bpy\nbpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, 3)); o = bpy.context.object\n"
        "o.name = 'Shower'; bpy.context.scene.frame_end = 30\n"
        "o.modifiers.new('P', 'PARTICLE_SYSTEM')\np = o.particle_systems[0].settings\n"
        f"p.count, p.frame_start, p.frame_end, p.lifetime, p.use_dead = 20, 1, 2, 10, {shown}\n"
    )
    shower = actor(session.use(TOOL, actors=["Shower"], frames=[1, 8, 28]), "Shower")
    assert (shower["phases"][0].get("there", [1, 28])[1] == 28) is shown


def test_particles_are_measured_by_their_mean_from_the_first_one_on(session: LiveSession) -> None:
    session.run(
        "s = bpy.context.scene\ns.frame_end = 40\n"
        "bpy.ops.mesh.primitive_plane_add(size=1, location=(0, 0, 4))\no = bpy.context.object\no.name = 'Shower'\n"
        "o.modifiers.new('P', 'PARTICLE_SYSTEM')\np = o.particle_systems[0].settings\n"
        "p.count, p.frame_start, p.frame_end, p.normal_factor = 300, 10, 10, 0"
    )
    shower = actor(session.use(TOOL, actors=["Shower"], frames=[1, 20, 34]), "Shower")
    motion = shower["phases"][0]
    assert shower["measured"] == "particles"
    assert 10 <= motion["there"][0] <= 11
    frames = 34 - motion["there"][0]
    # Particles leave within the frame in which they are born, and are braked a little (brownian 0, damping 0).
    assert motion["displacement"] == pytest.approx(G / 2 * (frames / 24) ** 2, rel=0.1)
    assert motion["final_speed"] == pytest.approx(G * frames / 24, rel=0.1)
    assert shower["samples"][0].get("position") is None


def test_an_object_collection_moves_as_one_and_goes_by_its_name(session: LiveSession) -> None:
    session.run(
        SLIDE
        + "bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, 3))\np = bpy.context.object\np.name = 'Runner'\n"
        "p.parent = o\nbpy.ops.mesh.primitive_cube_add(size=1, location=(11, 0, 0))\n"
        "w = bpy.context.object\nw.name = 'Bricks'\n"
        "for name, things in (('Sleigh', (o, p)), ('Wall', (w,))):\n"
        "    c = bpy.data.collections.new(name)\n    s.collection.children.link(c)\n    c['protocol_role'] = 'object'\n"
        "    for thing in things:\n        s.collection.objects.unlink(thing)\n        c.objects.link(thing)"
    )
    sleigh = actor(session.use(TOOL, actors=["Sleigh"]), "Sleigh")
    assert (sleigh["kind"], sleigh["objects"]) == ("object collection", ["Runner", "Sledge"])
    motion = sleigh["phases"][0]
    assert motion["start_position"] == pytest.approx([0, 0, 1.5], abs=1e-3)
    assert motion["turn"] == pytest.approx(360, abs=0.5)
    assert not sleigh["deforms"]
    assert [one["with"] for one in motion["contacts"]] == ["Wall"]
    assert motion["contacts"][0]["frames"][0][0] >= 48


def test_empty_is_measured_by_its_children_or_itself(session: LiveSession) -> None:
    session.run(
        SLIDE + "e = bpy.data.objects.new('Root', None)\ns.collection.objects.link(e)\no.parent = e\n"
        "f = bpy.data.objects.new('Lone', None)\ns.collection.objects.link(f)\n"
        "f.keyframe_insert('location', frame=1)\nf.location.z = 2\nf.keyframe_insert('location', frame=25)"
    )
    found = session.use(TOOL, actors=["Root", "Lone"], frames=[1, 49])
    assert actor(found, "Root")["phases"][0]["displacement"] == pytest.approx(10, abs=1e-3)
    assert actor(found, "Lone")["phases"][0]["displacement"] == pytest.approx(2, abs=1e-3)
    assert actor(found, "Lone")["measured"] == "origin"


def test_bones_and_instances_are_measured_where_they_are(session: LiveSession) -> None:
    session.run(
        SLIDE + "bpy.ops.object.armature_add()\nr = bpy.context.object\nr.name = 'Rig'\nb = r.pose.bones[0]\n"
        "b.rotation_mode = 'XYZ'\nb.keyframe_insert('rotation_euler', frame=1)\n"
        "b.rotation_euler.x = 1.5707963\nb.keyframe_insert('rotation_euler', frame=25)\n"
        "c = bpy.data.collections.new('Stock')\ns.collection.objects.unlink(o)\nc.objects.link(o)\n"
        "i = bpy.data.objects.new('Copy', None)\ni.instance_type, i.instance_collection = 'COLLECTION', c\n"
        "i.location.z = 3\ns.collection.objects.link(i)"
    )
    found = session.use(TOOL, actors=["Rig", "Copy"], frames=[1, 25, 49])
    # The bone's tail, a metre from its head, goes a quarter of a circle; the mean of both ends goes half as far.
    rig = actor(found, "Rig")["phases"][0]
    assert rig["displacement"] == pytest.approx(math.sqrt(2) / 2, rel=0.01)
    assert actor(found, "Rig")["keyframes"] == [1, 25]
    copy = actor(found, "Copy")["phases"][0]
    assert copy["displacement"] == pytest.approx(10, rel=0.01)
    assert copy["start_position"][2] == pytest.approx(3, abs=0.01)


def test_phases_at_one_time_are_measured_each_and_drawn_below_each_other(session: LiveSession) -> None:
    session.run(SLIDE)
    phases = [{"name": "all", "start": 1, "end": 49}, {"name": "early", "start": 7, "end": 13}]
    both = session.use(TOOL, actors=["Sledge"], phases=phases, frames=[1, 25, 49])
    path = 10 / 48
    for phase in actor(both, "Sledge")["phases"]:
        length = phase["end"] - phase["start"]
        assert phase["displacement"] == pytest.approx(length * path, rel=1e-3), phase["phase"]
    assert both.data["end"] == 49, "the first to begin ends last"
    (one,) = session.use(TOOL, actors=["Sledge"], phases=phases[:1], frames=[1, 25, 49]).pictures
    (sheet,) = both.pictures
    with Image.open(io.BytesIO(one.png)) as single, Image.open(io.BytesIO(sheet.png)) as double:
        assert double.height > single.height, "there is a line of names for each"


def test_lanes_hold_phases_that_follow_one_another() -> None:
    assert lanes_of([(1, 10), (10, 20), (20, 30)]) == [0, 0, 0]
    assert lanes_of([(1, 10), (5, 15), (10, 20), (12, 14)]) == [0, 1, 0, 2]
    assert lanes_of([]) == []


def test_all_that_is_touched_in_a_phase_is_told(session: LiveSession) -> None:
    posts = (
        "bpy.ops.mesh.primitive_cube_add(size=1, location=(at, 1, 0)); bpy.context.object.name = f'Post {at}'"
    )
    session.run(SLIDE + f"for at in range(0, 11): {posts}")
    text = session.use(TOOL, actors=["Sledge"], frames=[1, 49]).text
    assert all(f"Post {at}" in text for at in range(11))


def test_keys_before_and_after_the_frames_are_told(session: LiveSession) -> None:
    session.run(SLIDE)
    text = session.use(TOOL, actors=["Sledge"], frames=[20, 30]).text
    assert "keyed from 1 to 49, at none of these frames" in text
    assert "no keyframes" not in text
    assert (
        "1 keyed frame, 1 (in all from 1 to 49)" in session.use(TOOL, actors=["Sledge"], frames=[1, 30]).text
    )
    assert "2 keyed frames, 1–49\n" in session.use(TOOL, actors=["Sledge"], frames=[1, 49]).text


def test_the_scene_is_left_as_it_was(session: LiveSession) -> None:
    session.run(FALL + "for f in range(1, 8): s.frame_set(f)\ns.frame_set(7, subframe=0.25)")
    before = session.run(STATE)
    session.use(TOOL, actors=["Crate", "Floor"], frames=[10, 30])
    assert session.run(STATE) == before
    session.run("bpy.ops.ptcache.bake_all(bake=True)\nbpy.context.scene.frame_set(30)")
    before = session.run(STATE)
    session.use(TOOL, actors=["Crate"], frames=[10, 30])
    assert session.run(STATE) == before
    assert not list(session.blender.folder.workspace.mount.glob(".motion*"))


def test_the_pictures_show_the_motion_in_one_fixed_frame(session: LiveSession) -> None:
    session.run(FALL)
    found = session.use(TOOL, actors=["Crate"], frames=[1, 10, 15, 20, 24, 60])
    rows = np.array([row for _, row in red_places(found, 6, 248)])
    heights = np.array([one["position"][2] for one in actor(found, "Crate")["samples"]])
    down = (rows - rows[0]) / (rows[-1] - rows[0])
    assert down == pytest.approx((heights[0] - heights) / (heights[0] - heights[-1]), abs=0.03)
    assert found.pictures[0].path.read_bytes() == found.pictures[0].png
    again = session.use(TOOL, actors=["Crate"], frames=[1, 60])
    assert again.pictures[0].path != found.pictures[0].path


def test_what_is_cut_away_since_it_hides_an_actor_is_told(session: LiveSession) -> None:
    screen = (
        "bpy.ops.mesh.primitive_cube_add(size=1, location=(x, -3, 1)); w = bpy.context.object; "
        "w.name = f'Screen {x}'; w.scale = (4, .1, 9)\n"
    )
    session.run(SLIDE + "for x in (0, 30):\n    " + screen)
    found = session.use(TOOL, actors=["Sledge"], frames=[1, 49])
    assert "since it would hide it: 'Screen 0' (frame 1)." in found.text
    session.run("bpy.data.objects.remove(bpy.data.objects['Screen 0'])")
    assert "Cut away" not in session.use(TOOL, actors=["Sledge"], frames=[1, 49]).text


def test_what_is_in_a_closed_room_is_seen(session: LiveSession) -> None:
    session.run(
        SLIDE + "bpy.ops.mesh.primitive_cube_add(size=1)\nr = bpy.context.object\n"
        "r.scale = (14, 4, 4)\nr.location.x = 5\nr.name = 'Room'"
    )
    found = session.use(TOOL, actors=["Sledge"], frames=[1, 13, 25, 37, 49])
    across = np.array([column for column, _ in red_places(found, 5, 140)])
    assert np.diff(across) == pytest.approx([across[1] - across[0]] * 4, abs=4), "it slides evenly"
    assert across[1] - across[0] > 25


def test_a_simulation_that_ends_early_or_stands_still_is_told_with_why(session: LiveSession) -> None:
    session.run(FALL + "s.rigidbody_world.point_cache.frame_end = 15\ns.use_gravity = False")
    notes = actor(session.use(TOOL, actors=["Crate"], frames=[1, 30]), "Crate")["notes"]
    assert "Simulated only up to frame 15: the rigid-body world." in notes
    assert any("does not move" in note and "no gravity" in note for note in notes)


def test_a_fluid_that_only_a_bake_brings_is_told(session: LiveSession) -> None:
    session.run(
        "s = bpy.context.scene\ns.frame_end = 10\nbpy.ops.mesh.primitive_cube_add(size=2)\no = bpy.context.object\n"
        "o.name = 'Tank'\nm = o.modifiers.new('F', 'FLUID')\nm.fluid_type = 'DOMAIN'\n"
        "m.domain_settings.domain_type = 'LIQUID'\nm.domain_settings.use_mesh = True\n"
        "m.domain_settings.resolution_max = 16\nm.domain_settings.cache_type = 'ALL'\n"
        "m.domain_settings.cache_directory = bpy.path.abspath('//nothing_baked')"
    )
    tank = actor(session.use(TOOL, actors=["Tank"]), "Tank")
    assert (tank["measured"], tank["phases"][0]["present"]) == ("fluid", False)
    assert any("Not baked: liquid of 'Tank'" in note for note in tank["notes"])


def test_reports_motion_that_is_not_reproducible(session: LiveSession) -> None:
    session.run(
        SLIDE + "o.animation_data_clear()\ncalls = [0]\ndef wander(scene, graph=None):\n    calls[0] += 1\n"
        "    bpy.data.objects['Sledge'].location.x = calls[0]\n"
        "bpy.app.handlers.frame_change_pre.append(wander)"
    )
    notes = actor(session.use(TOOL, actors=["Sledge"], frames=[1, 10]), "Sledge")["notes"]
    assert any("not repeatable" in note for note in notes)


def test_reports_what_cannot_be_seen(session: LiveSession) -> None:
    session.run(SLIDE + "o.hide_render = True")
    notes = actor(session.use(TOOL, actors=["Sledge"], frames=[1, 10]), "Sledge")["notes"]
    assert notes == ["Not in the pictures: 'Sledge': hidden from renders."]


HIDDEN = """
for frame, hide in ((1, False), (20, True), (40, False)):
    {which}
"""
IN_VIEWPORT = HIDDEN.format(which="o.hide_viewport = hide; o.keyframe_insert('hide_viewport', frame=frame)")
IN_RENDERS = HIDDEN.format(which="o.hide_render = hide; o.keyframe_insert('hide_render', frame=frame)")


@pytest.mark.parametrize("frame", [1, 30])
def test_what_keys_hide_in_the_viewport_is_where_renders_show_it(session: LiveSession, frame: int) -> None:
    session.run(f"{SLIDE}{IN_VIEWPORT}s.frame_set({frame})")
    before = session.run(STATE)
    found = session.use(
        TOOL, actors=["Sledge"], phases=[{"name": "slide", "start": 1, "end": 49}], frames=[1, 30]
    )
    slide = actor(found, "Sledge")["phases"][0]
    assert slide["peak_speed"] == pytest.approx(5, rel=1e-3), "it stood still, and jumped"
    assert slide["path_length"] == pytest.approx(10, abs=1e-3)
    assert not any("Not in the pictures" in note for note in actor(found, "Sledge")["notes"])
    assert session.run(STATE) == before
    assert session.run("bpy.data.objects['Sledge'].hide_viewport") == (frame == 30)
    session.run("bpy.context.scene.frame_set(25)")
    assert session.run("bpy.data.objects['Sledge'].hide_viewport"), "its keys have their effect again"


def test_what_keys_take_out_of_renders_is_not_there_meanwhile(session: LiveSession) -> None:
    gone = IN_RENDERS.replace("(40, False)", "(60, True)")
    session.run(SLIDE + IN_VIEWPORT + gone)
    (slide,) = actor(session.use(TOOL, actors=["Sledge"], frames=[1, 60]), "Sledge")["phases"]
    assert list(slide["there"]) == [1, 19]
    assert slide["peak_speed"] == pytest.approx(5, rel=1e-3)


def test_ignores_positions_that_are_not_finite(session: LiveSession) -> None:
    session.run(SLIDE + "o.animation_data_clear()\no.location.x = float('nan')")
    found = actor(session.use(TOOL, actors=["Sledge"], frames=[1, 10]), "Sledge")
    assert not found["phases"][0]["present"]


def test_a_long_range_is_measured_at_a_stride_and_says_so(session: LiveSession) -> None:
    session.run(SLIDE + "s.frame_end = 1801")
    phases = [{"name": "a", "start": 1, "end": 50}, {"name": "b", "start": 50, "end": 1801}]
    found = session.use(TOOL, actors=["Sledge"], phases=phases, frames=[1, 1801])
    assert found.data["stride"] == 4
    assert "every 4 frames" in found.text
    assert actor(found, "Sledge")["phases"][0]["displacement"] == pytest.approx(10, abs=1e-3)


def test_progress_is_told_as_frames_go_by(session: LiveSession) -> None:
    session.run(FALL)
    told: list[tuple[float, float | None, str]] = []
    session.use(TOOL, Call(progress=lambda *one: told.append(one)), actors=["Crate"], frames=[1, 20])
    done = [one[0] for one in told]
    assert len(done) >= 22  # 20 frames, and 2 that are drawn from what was simulated
    assert done == sorted(done)
    assert done[-1] <= (told[-1][1] or 0)


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({"actors": ["Crait"]}, "Nearest: 'Crate'"),
        ({"actors": []}, "actors"),
        ({"actors": ["Crate"] * 2}, "twice"),
        ({"actors": [f"A{n}" for n in range(9)]}, "actors"),
        ({"actors": ["Crate"], "frames": [1, 61]}, "Frame 61 is outside the scene's range, 1 to 60"),
        ({"actors": ["Crate"], "frames": [5]}, "a single frame shows no motion"),
        ({"actors": ["Crate"], "frames": [1, 2.5]}, "frames"),
        ({"actors": ["Crate"], "phases": [{"name": "a", "start": 9, "end": 9}]}, "must end after its start"),
        ({"actors": ["Crate"], "phases": [{"name": "a", "start": 1}]}, "end"),
        ({"actors": ["Crate"], "phases": [{"name": "a", "start": 0, "end": 9}]}, "Frame 0 is outside"),
        (
            {
                "actors": ["Crate"],
                "phases": [{"name": name, "start": 1 + at, "end": 30} for at, name in enumerate("abcd")],
            },
            "phases: as 'd' begins, more than 3 are at one time; ask for a second sheet",
        ),
    ],
)
def test_what_cannot_be_asked_is_refused(session: LiveSession, asked: dict[str, Any], told: str) -> None:
    session.run(FALL)
    with pytest.raises(Refusal) as refused:
        session.use(TOOL, **asked)
    assert told in str(refused.value)


def test_what_is_not_in_the_view_layer_is_refused(session: LiveSession) -> None:
    session.run(
        "c = bpy.data.collections.new('Attic')\nbpy.context.scene.collection.children.link(c)\n"
        "bpy.ops.mesh.primitive_cube_add()\no = bpy.context.object\n"
        "bpy.context.scene.collection.objects.unlink(o)\n"
        "c.objects.link(o)\nbpy.context.view_layer.layer_collection.children['Attic'].exclude = True"
    )
    with pytest.raises(Refusal, match="not in the view layer"):
        session.use(TOOL, actors=["Attic"])


def test_rejects_what_is_no_motion(session: LiveSession) -> None:
    with pytest.raises(Untrustworthy, match="not a valid reply"):
        session.blender.call("ping", {}, MotionReply.model_validate, timeout=60)
    session.run(SLIDE)
    assert session.use(TOOL, actors=["Sledge"], frames=[1, 9]).data["actors"]
