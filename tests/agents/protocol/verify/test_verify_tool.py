"""``blender_verify``: the open scene judged, told and drawn."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image
from scenes import build

from agents.blender.tools.verify import TOOL as VERIFY
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

pytestmark = pytest.mark.blender

# A table whose leg ends 12 mm above the floor, and a lamp that is 10 mm deep in it.
SCENE = """
thing("Room", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
thing("Table", box("Top", (-0.6, -0.4, 0.7), (0.6, 0.4, 0.75)), box("Leg", (-0.05, -0.05, 0.012), (0.05, 0.05, 0.7)))
thing("Lamp", box("Shade", (0.3, -0.1, 0.74), (0.5, 0.1, 1.12)))
bpy.data.objects["Leg"]["contact_with"] = ["Slab"]
"""
PLAN: dict[str, Any] = {
    "title": "A table",
    "systems": ["ground", "set"],
    "objects": [
        {
            "name": "Room",
            "systems": ["ground"],
            "dimensions": [4, 4, 0.1],
            "position": [0, 0, 0],
            "role": "ground",
        },
        {"name": "Table", "systems": ["set"], "dimensions": [1.2, 0.8, 0.75], "position": [0, 0, 0]},
        {"name": "Lamp", "systems": ["set"], "dimensions": [0.2, 0.2, 0.38], "position": [0, 0, 0]},
    ],
    "relations": [{"kind": "OnTopOf", "a": "Lamp", "b": "Table"}],
    "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
    "camera": {"position": [5, -5, 3], "target": [0, 0, 0]},
    "render": {"kind": "still"},
}


def found(data: dict[str, Any], rule: str) -> list[tuple[list[str], float]]:
    return [(list(one["objects"]), one["measured"]) for one in data["findings"] if one["rule"] == rule]


def redness(png: bytes, box: tuple[int, int, int, int]) -> int:
    """How many pixels in a part of a picture are plainly red."""
    pixels = np.asarray(Image.open(io.BytesIO(png)).convert("RGB").crop(box)).astype(int)
    return int(((pixels[..., 0] > 150) & (pixels[..., 1] < 70) & (pixels[..., 2] < 70)).sum())


def test_findings_come_as_data_and_as_words_that_say_what_to_do(session: LiveSession) -> None:
    build(session, SCENE)
    result = session.use(VERIFY)
    assert not result.failed
    assert result.pictures == ()
    assert result.data["ok"] is False
    ((objects, measured),) = found(result.data, "V1")
    assert objects == ["Leg", "Slab"]
    assert measured == pytest.approx(0.012, abs=1e-5)
    ((objects, measured),) = found(result.data, "V2")
    assert set(objects) == {"Shade", "Top"}
    assert measured == pytest.approx(0.01, abs=1e-5)
    assert "but are 12.0 mm apart." in result.text
    assert "Fix: Move 'Leg' 12.0 mm down (−Z)" in result.text
    assert "no plan was given" in result.text


def test_chosen_rules_alone_are_run(session: LiveSession) -> None:
    build(session, SCENE)
    data = session.use(VERIFY, rules=["v1", "C"]).data
    assert [rule["id"] for rule in data["rules"]] == ["C1", "C2", "C3", "C4", "C5", "C6", "V1"]
    assert {one["rule"] for one in data["findings"]} == {"V1"}


def test_a_plan_is_judged_by(session: LiveSession) -> None:
    build(session, SCENE)
    data = session.use(VERIFY, plan=PLAN, rules=["R1", "R10"]).data
    assert data["plan"] == "A table"
    ((objects, measured),) = found(data, "R10")
    assert objects == ["Lamp", "Table"]
    assert measured == pytest.approx(0.01, abs=1e-4)
    assert {rule["id"]: rule["state"] for rule in data["rules"]} == {"R1": "holds", "R10": "broken"}


def test_the_scene_stays_as_it_is(session: LiveSession) -> None:
    build(session, f"{SCENE}\nscene.frame_set(17)")
    look = (
        "(bpy.context.scene.frame_current, sorted(bpy.data.objects.keys()), len(bpy.data.meshes), "
        "len(bpy.data.scenes), len(bpy.data.materials))"
    )
    before = session.run(look)
    session.use(VERIFY, image=True)
    assert session.run(look) == before


def test_the_picture_shows_what_is_at_fault_in_red_and_names_it(session: LiveSession) -> None:
    build(session, SCENE)
    plain = session.use(VERIFY, image=True, rules=["W4"])
    (picture,) = session.use(VERIFY, image=True, rules=["V"]).pictures
    width, height = Image.open(io.BytesIO(picture.png)).size
    assert width < 1000
    assert redness(picture.png, (0, 60, width, height)) > 5000
    assert picture.path.read_bytes() == picture.png
    assert plain.pictures  # that a camera is absent has no place, but its own line
    assert redness(plain.pictures[0].png, (0, 60, width, 400)) < 500  # axes, and no more
    assert len(picture.png) < 400_000
    left = list(session.blender.folder.workspace.mount.glob(".*.png"))
    assert left == []


def test_places_in_the_picture_are_those_of_the_world(session: LiveSession) -> None:
    build(session, SCENE)
    reply = session.blender.call(
        "findings_image",
        {
            "findings": [
                {
                    "objects": ["Leg"],
                    "colour": [1, 0, 0],
                    "at": at,
                    "size": None,
                    "frame": None,
                    "marked": True,
                }
                for at in ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], None)
            ]
            + [
                {
                    "objects": ["Leg"],
                    "colour": [1, 0, 0],
                    "at": [0, 0, 0],
                    "size": 1,
                    "frame": 9,
                    "marked": True,
                }
            ],
            "folder": str(session.blender.folder.workspace.mount),
            "size": 200,
            "close": 100,
        },
        unread,
        timeout=60,
    ).value
    front, right, top, _ = reply["views"]
    origin, along_x, up, middle, another_frame = front["marks"]
    assert another_frame is None
    assert reply["close"] == []
    pixels = 0.5 / front["metres_per_pixel"]
    assert (along_x[0] - origin[0], along_x[1] - origin[1]) == pytest.approx((pixels, 0), abs=1e-3)
    assert (up[0] - origin[0], up[1] - origin[1]) == pytest.approx((0, -pixels), abs=1e-3)
    # Without a place of its own a finding is in the middle of its object.
    assert (middle[1] - origin[1]) * front["metres_per_pixel"] == pytest.approx(-0.356, abs=1e-3)
    assert right["marks"][1] == pytest.approx(right["marks"][0], abs=1e-3)
    assert top["marks"][2] == pytest.approx(top["marks"][0], abs=1e-3)
    for view in reply["views"]:
        (session.blender.folder.workspace.mount / view["file"]).unlink()


def test_a_close_up_shows_the_gap_as_wide_as_it_is(session: LiveSession) -> None:
    build(session, SCENE)
    reply = session.blender.call(
        "findings_image",
        {
            "findings": [
                {
                    "objects": ["Leg", "Slab"],
                    "colour": [1, 0, 0],
                    "at": [0, 0, 0.006],
                    "size": 0.012,
                    "frame": None,
                    "marked": True,
                }
            ],
            "folder": str(session.blender.folder.workspace.mount),
            "size": 200,
            "close": 240,
        },
        unread,
        timeout=60,
    ).value
    (close,) = reply["close"]
    assert close["name"] == "front"
    assert close["metres_per_pixel"] * 240 == pytest.approx(12 * 0.012)
    file = session.blender.folder.workspace.mount / close["file"]
    column = np.asarray(Image.open(file).convert("RGBA").resize((240, 240)))[:, 120, 3] > 40
    (edges,) = np.nonzero(np.diff(column.astype(int)))
    assert edges[1] - edges[0] == pytest.approx(20, abs=3)  # the gap, from the leg's end to the floor
    for view in (*reply["views"], close):
        (session.blender.folder.workspace.mount / view["file"]).unlink()


@pytest.mark.parametrize(
    ("arguments", "why"),
    [
        ({"rules": ["X9"]}, "There is no rule 'X9'. The rules are: C1, C2"),
        ({"rules": [" "]}, "No rule is named"),
        ({"plan": {"title": "x"}}, "- systems: It is missing."),
        (
            {"plan": {**PLAN, "relations": [{"kind": "OnTopOf", "a": "Lmap", "b": "Table"}]}},
            "- relations[0].a: There is no object 'Lmap'; did you mean 'Lamp'",
        ),
        ({"plan": {**PLAN, "tolerances": {"contact": 5.0}}}, "- tolerances: contact cannot be loosened"),
        (
            {"plan": {**PLAN, "tolerances": {"contakt": 0.001}}},
            "- tolerances: there is no tolerance 'contakt'",
        ),
    ],
)
def test_what_cannot_be_asked_is_refused_with_all_its_faults(
    session: LiveSession, arguments: dict[str, Any], why: str
) -> None:
    with pytest.raises(Refusal) as error:
        session.use(VERIFY, **arguments)
    assert why in str(error.value)


def test_an_empty_scene_is_no_pass_without_a_word(session: LiveSession) -> None:
    result = session.use(VERIFY)
    assert {one["rule"] for one in result.data["findings"]} == {"C6", "W4", "W5"}
    assert "Not checked: C1, C2, C4, C5" in result.text


def test_where_there_is_nothing_to_see_the_findings_come_without_a_picture(session: LiveSession) -> None:
    result = session.use(VERIFY, image=True)
    assert result.pictures == ()
    assert "The scene has no camera." in result.text
    assert "No image could be made:" in result.text


def test_without_findings_the_picture_shows_the_scene_as_it_is(session: LiveSession) -> None:
    build(session, SCENE)
    result = session.use(VERIFY, image=True, rules=["C"])
    assert result.data["findings"] == []
    (picture,) = result.pictures
    assert redness(picture.png, (0, 60, 900, 900)) < 500  # axes, and no more
