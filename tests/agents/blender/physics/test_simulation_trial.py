"""``blender_trial``: what it tells of a few frames, and that it leaves nothing behind but frames to be kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
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
    assert [frame for frame, _, _ in actors["Brick"]["heights"]] == [*range(1, 11)]
    assert "frame: lowest and highest point, m: 1: 1.500 2.500; 2: " in found.text
    assert brick[-1]["volume"] == pytest.approx(1, rel=1e-3)
    assert brick[-1]["lowest"] == pytest.approx(1.5 - 9.81 / 2 * (9 / 24) ** 2, abs=0.05)  # free fall
    assert brick[-1]["speed"] == pytest.approx(9.81 * 8.5 / 24, rel=0.1)
    assert "s a frame" in found.text
    assert "the whole bake of 12 frames" in found.text
    (strip,) = found.pictures
    assert strip.png.startswith(b"\x89PNG")


def test_bodies_that_are_not_measured_in_full_are_told_by_how_far_they_move(session: LiveSession) -> None:
    session.run("""
scene = bpy.context.scene
for number in range(20):
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(number, 0, 5 if number != 15 else 0.1))
    bpy.context.object.name = f"Brick {number:02}"
    bpy.ops.rigidbody.object_add()
    bpy.context.object.rigid_body.use_start_deactivated = number == 15
    bpy.context.object.rigid_body.use_deactivation = number == 15
""")
    found = session.use(TOOL, frames=13, pictures=False)
    assert len(found.data["actors"]) == 12
    assert {len(actor["heights"]) for actor in found.data["actors"]} == {7}
    others = found.data["others"]
    assert (others["count"], others["moved"]["count"], others["moving"]["count"]) == (8, 7, 7)
    for name, metres in others["moved"]["most"]:
        assert metres == pytest.approx(9.81 / 2 * (12 / 24) ** 2, rel=0.1), name
    for name, speed in others["moving"]["most"]:
        assert speed == pytest.approx(9.81 * 11.5 / 24, rel=0.1), name
    assert "- Other bodies: 8, of which 7 have moved ('Brick 12' 1.2" in found.text
    assert "only the first 12 of 20 are measured in full" in found.text.lower()


def test_a_trial_past_its_deadline_still_says_what_a_frame_took(session: LiveSession) -> None:
    session.run(f"""{CLOTH_ON_BALL}
import time
bpy.app.handlers.frame_change_post.append(lambda *_: time.sleep(0.5))""")
    wanted = {"objects": None, "frames": 99, "seconds": 99, "folder": "/nowhere", "width": None}
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
