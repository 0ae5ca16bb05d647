"""``blender_trial``: what it tells of a few frames, and that it leaves nothing behind but frames to be kept."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image
from test_bake import PARTS, one
from test_stepped_once import CLOTH_ON_BALL, broken

from agents.blender.tools.bake import TOOL as BAKE
from agents.blender.tools.base import Call
from agents.blender.tools.trial import TOOL
from simworlds.sandbox.errors import Refusal, TookTooLong
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

STATE = """
points = bpy.data.objects['Flag'].modifiers['Cloth'].point_cache
(bpy.context.scene.frame_current, points.is_baked, points.frame_start, points.frame_end)
"""


def test_a_trial_tells_heights_speeds_pace_and_shows_a_strip(session: LiveSession) -> None:
    session.run(f"{CLOTH_ON_BALL}\nbody()\nscene.frame_set(3)")
    before = session.run(STATE)
    lines: list[str] = []
    found = session.use(TOOL, Call(progress=lambda _done, _total, text: lines.append(text)), frames=10)
    assert session.run(STATE) == before
    assert len(lines) == 10
    assert lines[4].startswith("frame 5 in ")
    assert "Brick: lowest " in lines[4]
    actors = {actor["name"]: actor for actor in found.data["actors"]}
    assert set(actors) == {"Flag", "Brick"}
    brick = actors["Brick"]["samples"]
    assert [sample["frame"] for sample in brick] == [1, 3, 5, 6, 8, 10]
    assert [frame for frame, *_ in actors["Brick"]["heights"]] == [*range(1, 11)]
    assert "frame: lowest, highest point (m), speed (m/s): 1: 1.500 2.500; 2: " in found.text
    assert found.text.count("1.500 2.500") == 1, "a height is told twice"
    assert found.text.count(" 1 m³") == 1, "a volume that stays is told more than once"
    assert actors["Brick"]["lowest"] == (brick[-1]["lowest"], 10)
    assert actors["Brick"]["peak_speed"] == (brick[-1]["speed"], 10)
    assert brick[-1]["volume"] == pytest.approx(1, rel=1e-3)
    assert brick[-1]["lowest"] == pytest.approx(1.5 - 9.81 / 2 * (9 / 24) ** 2, abs=0.05)  # free fall
    assert brick[-1]["speed"] == pytest.approx(9.81 * 8.5 / 24, rel=0.1)
    assert "s a frame" in found.text
    assert "the whole bake of 12 frames" in found.text
    (strip,) = found.pictures
    assert strip.png.startswith(b"\x89PNG")


DRIFT = """
scene = bpy.context.scene
scene.gravity = (0, 0, 0)
bpy.ops.mesh.primitive_cube_add(size=1)
boat = bpy.context.object
boat.name = "Boat"
bpy.ops.rigidbody.object_add()
boat.rigid_body.use_deactivation = False
current = bpy.data.objects.new("Current", None)
scene.collection.objects.link(current)
current.location, current.rotation_euler.y = (-3, 0, 0), 1.5707963
bpy.context.view_layer.update()
with bpy.context.temp_override(object=current, active_object=current):
    bpy.ops.object.forcefield_toggle()
current.field.type, current.field.shape = "WIND", "PLANE"
current.field.flow, current.field.strength = 0, 0
"""


def test_what_keeps_its_height_is_told_by_where_it_is(session: LiveSession) -> None:
    session.run(DRIFT)
    still = session.use(TOOL, frames=25, pictures=False)
    assert "**has not moved**" in still.text
    session.run("bpy.data.objects['Current'].field.strength = 48")
    found = session.use(TOOL, frames=25, pictures=False)
    assert "has not moved" not in found.text
    way = float(found.text.partition("moved by (")[2].partition(",")[0])
    assert way == pytest.approx(1, rel=0.1), "2 m/s² for a second"
    assert (
        "-0.500 to 0.500 m high all the time; frame: middle (m), speed (m/s): 1: (0.00, 0.00, 0.00); "
        in found.text
    )


MANY = """
scene = bpy.context.scene
for number in range(20):
    at_rest = number in (2, 15)
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(number, 0, 0.1 if at_rest else 5))
    bpy.context.object.name = f"Brick {number:02}"
    bpy.ops.rigidbody.object_add()
    bpy.context.object.rigid_body.use_start_deactivated = at_rest
    bpy.context.object.rigid_body.use_deactivation = at_rest
"""


def test_of_many_bodies_those_that_move_are_told_in_full_and_of_others_how_far(session: LiveSession) -> None:
    session.run(MANY)
    found = session.use(TOOL, frames=13, pictures=False)
    told = [actor["name"] for actor in found.data["actors"]]
    assert len(told) == 12
    assert not {"Brick 02", "Brick 15"} & set(told), "what rests is told in full"
    assert {len(actor["heights"]) for actor in found.data["actors"]} == {9}
    others = found.data["others"]
    assert (others["count"], others["moved"]["count"], others["moving"]["count"]) == (8, 6, 6)
    for name, metres in others["moved"]["most"]:
        assert metres == pytest.approx(9.81 / 2 * (12 / 24) ** 2, rel=0.1), name
    for name, speed in others["moving"]["most"]:
        assert speed == pytest.approx(9.81 * 11.5 / 24, rel=0.1), name
    assert "- Others: 8, of which 6 have moved ('Brick 1" in found.text
    assert "Name others" in found.text


def test_of_many_bodies_those_that_are_asked_for_first_are_told_first(session: LiveSession) -> None:
    session.run(
        f"{MANY}\none = bpy.data.collections.new('One')\nscene.collection.children.link(one)\n"
        "one.objects.link(bpy.data.objects['Brick 15'])"
    )
    found = session.use(TOOL, frames=3, pictures=False, first=["One", "Brick 19", "not there"])
    assert [actor["name"] for actor in found.data["actors"]][:2] == ["Brick 15", "Brick 19"]


# Particles from above a floor, of which some are born 30 frames before the cache's first one.
RAIN = """
scene = bpy.context.scene
scene.frame_end = 40
bpy.ops.mesh.primitive_cube_add(size=1, location=(0, 0, -0.1))
floor = bpy.context.object
floor.name, floor.scale = 'Floor', (20, 20, 0.2)
bpy.ops.mesh.primitive_plane_add(size=2, location=(0, 0, 1))
bpy.context.object.name = 'Cloud'
rain = bpy.context.object.modifiers.new('Rain', 'PARTICLE_SYSTEM').particle_system.settings
rain.count, rain.lifetime, rain.normal_factor = 200, 200, 0
rain.frame_start, rain.frame_end = {start}, 30
{partner}
"""
COLLIDES = "floor.modifiers.new('Collision', 'COLLISION')"


def test_a_swarm_is_told_by_how_many_there_are_where_and_which_way(session: LiveSession) -> None:
    session.run(RAIN.format(start=1, partner=COLLIDES) + "scene.gravity = (9.81, 0, 0)")
    found = session.use(TOOL, frames=9, pictures=False)
    (cloud,) = found.data["actors"]
    first, *_, last = cloud["samples"]
    assert (first["frame"], last["frame"], first["alive"]) == (1, 9, 1)
    assert last["alive"] == cloud["most_alive"] == pytest.approx(200 * 8 / 29, abs=2)
    assert last["velocity"] == pytest.approx((last["speed"], 0, 0), abs=1e-3), "they fall along X"
    assert 0 < last["middle"][0] < 9.81 / 2 * (8 / 24) ** 2
    assert f"frame 9: {last['alive']} alive, mean place (" in found.text
    assert cloud["heights"] == []
    assert found.data["fallen"] == []


def test_a_swarm_has_a_strip_of_pictures_of_its_own(session: LiveSession) -> None:
    session.run(RAIN.format(start=1, partner=COLLIDES) + "bpy.context.view_layer.update()")
    alone = session.use(TOOL, frames=4)
    session.run(
        "bpy.ops.mesh.primitive_cube_add(size=0.2, location=(30, 0, 5))\nbpy.ops.rigidbody.object_add()"
    )
    both = session.use(TOOL, frames=4)
    heights = [Image.open(io.BytesIO(found.pictures[0].png)).height for found in (alone, both)]
    assert [len(found.pictures) for found in (alone, both)] == [1, 1]
    assert heights[1] != heights[0]
    picture = np.asarray(Image.open(io.BytesIO(both.pictures[0].png)).convert("RGB")).astype(int)
    orange = (picture[..., 0] > 150) & (picture[..., 1] < 130) & (picture[..., 2] < 80)
    rows = np.nonzero(orange.any(axis=1))[0]
    assert rows.min() > heights[1] / 2, "the swarm is in the strip below"


def test_a_thing_that_comes_in_among_falling_particles_has_not_let_them_through(session: LiveSession) -> None:
    session.run(
        RAIN.format(start=1, partner=COLLIDES)
        + "floor.location = (50, 0, 0.5)\nfloor.keyframe_insert('location', frame=11)\n"
        "floor.location.x = 0\nfloor.keyframe_insert('location', frame=12)"
    )
    found = session.use(TOOL, frames=16, pictures=False)
    assert found.data["actors"][0]["lowest"][0] < 0, "some have fallen past before it came"
    assert found.data["fallen"] == []


@pytest.mark.parametrize(
    ("start", "partner", "cause"),
    [
        (1, COLLIDES, None),
        (-30, COLLIDES, "born before the cache's first frame, 1,"),
        (1, "", None),  # no more than any other mesh
        (1, "ground = bpy.data.collections.new('ground')\nscene.collection.children.link(ground)\n"
            "ground['protocol_role'] = 'system'\nground.objects.link(floor)", "no Collision modifier"),
        (-30, COLLIDES + "\nfloor.collision.permeability = 1", None),
    ],
)  # fmt: skip
def test_particles_that_have_gone_through_a_floor_are_told_with_the_cause(
    session: LiveSession, start: int, partner: str, cause: str | None
) -> None:
    session.run(RAIN.format(start=start, partner=partner))
    found = session.use(TOOL, frames=40, pictures=False)
    if cause is None:
        assert found.data["fallen"] == []
        return
    (fault,) = found.data["fallen"]
    assert "particles of 'Cloud' have gone through 'Floor'" in fault
    assert cause in fault
    assert f"**{fault[:1].upper()}{fault[1:]}**" in found.text


def test_particles_that_are_blown_below_a_thing_have_not_gone_through_it(session: LiveSession) -> None:
    """They fall past its edge, and go on below it."""
    session.run(
        RAIN.format(start=1, partner=COLLIDES)
        + "floor.scale = (20, 2, 0.2)\nfloor.location.y = 1.2\nfloor.location.z = 0.5\nrain.frame_end = 2\n"
        "scene.frame_set(1)\nbpy.data.objects['Cloud'].scale.y = 0.1\n"
        "scene.gravity = (0, 6, -9.81)"
    )
    found = session.use(TOOL, frames=24, pictures=False)
    low, high = 0.2, 2.2  # the floor's sides
    middle = found.data["actors"][0]["samples"][-1]["middle"]
    assert low < middle[1] < high
    assert middle[2] < 0.3
    assert found.data["fallen"] == []


def test_a_trial_past_its_deadline_still_says_what_a_frame_took(session: LiveSession) -> None:
    session.run(f"""{CLOTH_ON_BALL}
import time
bpy.app.handlers.frame_change_post.append(lambda *_: time.sleep(0.5))""")
    wanted = {"objects": None, "first": [], "frames": 99, "seconds": 99, "folder": "/nowhere", "width": None}
    with pytest.raises(TookTooLong, match=r"4 s \(the last it told: frame \d+ in .* s; Flag: lowest"):
        session.blender.call("trial", wanted, unread, timeout=4)


def test_what_a_trial_simulated_is_kept_for_the_next_one_and_for_the_bake(session: LiveSession) -> None:
    session.run(CLOTH_ON_BALL)
    first = session.use(TOOL, frames=12, pictures=False)
    again = session.use(TOOL, frames=12, pictures=False)
    assert (first.data["simulated"], again.data["simulated"]) == (True, False)
    assert first.data["actors"] == again.data["actors"]
    assert "had been simulated" in again.text
    assert one(session.use(BAKE))["kept"]


def test_a_trial_says_how_deep_something_is_in_another(session: LiveSession) -> None:
    session.run(f"{PARTS}\nbody()\nbpy.ops.mesh.primitive_cube_add(size=2, location=(12, 0, 0.6))")
    found = session.use(TOOL, objects=["Brick"], frames=2, pictures=False)
    sample = found.data["actors"][0]["samples"][0]
    assert (sample["inside"], sample["depth"]) == ("Cube", pytest.approx(0.1, abs=1e-3))
    assert "100.0 mm deep in 'Cube'" in found.text


def test_a_trial_says_which_body_is_not_where_its_mesh_is(session: LiveSession) -> None:
    raised = "from mathutils import Matrix\nfloor = bpy.data.objects['Cube']\n"
    session.run(
        f"{PARTS}\nbody()\nbpy.ops.mesh.primitive_cube_add(size=2, location=(12, 0, -1))\n{raised}"
        "bpy.ops.rigidbody.object_add()\nfloor.rigid_body.type, floor.rigid_body.collision_shape = 'PASSIVE', 'BOX'"
    )
    remark = "Primitive collision shapes are centred on the origin"
    assert remark not in session.use(TOOL, objects=["Brick"], frames=2, pictures=False).text
    session.run(f"{raised}floor.data.transform(Matrix.Translation((0, 0, -.2)))")
    found = session.use(TOOL, objects=["Brick"], frames=2, pictures=False)
    assert f"{remark}; here that is not the middle of the mesh: BOX of 'Cube' by 0.2 m." in found.text


def test_a_cage_in_its_own_body_is_not_deep_in_anything(session: LiveSession) -> None:
    session.run(
        f"{PARTS}\nbody()\nbpy.ops.mesh.primitive_cube_add(size=2, location=(12, 0, 2))\nskin = bpy.context.object\n"
        "whole = bpy.data.collections.new('Whole')\nscene.collection.children.link(whole)\n"
        "whole['protocol_role'] = 'object'\n"
        "for part in (skin, bpy.data.objects['Brick']):\n    whole.objects.link(part)"
    )
    found = session.use(TOOL, objects=["Brick"], frames=2, pictures=False)
    assert found.data["actors"][0]["samples"][0]["inside"] is None


def test_a_trial_ends_when_its_time_is_over(session: LiveSession) -> None:
    session.run(CLOTH_ON_BALL)
    arguments: dict[str, Any] = {
        "objects": None,
        "first": [],
        "frames": 12,
        "seconds": 0,
        "folder": ".none",
        "width": None,
    }
    reply = session.blender.call("trial", arguments, unread, timeout=60).value
    assert (reply["first"], reply["last"]) == (1, 1)
    assert "were over" in reply["stopped"]


def test_a_trial_stops_where_it_is_not_finite_and_says_why(session: LiveSession) -> None:
    session.run(broken("soft body"))
    found = session.use(TOOL, frames=12)
    assert found.data["last"] < 12
    assert "Ended after frame" in found.text
    assert "step_min" in found.text


def test_a_liquid_that_waits_for_its_bake_is_tried_and_left_as_it_was(session: LiveSession) -> None:
    session.run(f"{PARTS}\ntank(use_mesh=True, cache_type='ALL', cache_directory='//waits')")
    found = session.use(TOOL, frames=6)
    volumes = [sample["volume"] for sample in found.data["actors"][0]["samples"]]
    assert volumes[-1] == pytest.approx(0.27, abs=0.08)  # a drop with a radius of 0.4
    assert len(found.pictures) == 1
    domain = "bpy.data.objects['Tank'].modifiers[0].domain_settings"
    state = session.run(f"({domain}.cache_type, {domain}.cache_directory, {domain}.has_cache_baked_data)")
    assert state == ("ALL", "//waits", False)
    assert not [path for path in session.blender.folder.root.rglob("*trial-*") if path.is_dir()]


@pytest.mark.parametrize(
    ("code", "arguments", "why"),
    [
        ("", {}, "no simulation"),
        (CLOTH_ON_BALL, {"objects": ["Ball"]}, "none of these"),
        ("", {"objects": ["X"]}, "X"),
    ],
)
def test_what_cannot_be_tried_is_refused(
    session: LiveSession, code: str, arguments: dict[str, Any], why: str
) -> None:
    session.run(code)
    with pytest.raises(Refusal, match=why):
        session.use(TOOL, **arguments)
