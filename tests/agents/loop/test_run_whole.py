"""A run from its prompt to its result, with every part real but the model."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image
from run_sessions import PROMPT, scenes
from team import whose

from agents.plan.scene import ScenePlan

if TYPE_CHECKING:
    from pathlib import Path

    from run_sessions import Played

pytestmark = pytest.mark.blender


def test_a_run_leaves_a_plan_checkpoints_a_scene_and_a_picture(mended: Played) -> None:
    root = mended.root
    assert mended.ended.how == "done"
    assert (mended.ended.file, mended.ended.shown) == (root / "scene.blend", root / "still.png")
    assert ScenePlan.model_validate_json((root / "plan.json").read_text()).title == "A crate on a floor"
    assert sorted(path.name for path in (root / "checkpoints").iterdir()) == [
        "camera.blend",
        "light.blend",
        "mended-2.blend",
        "modeling.blend",
        "start.blend",
    ]
    with Image.open(root / "still.png") as still:
        assert still.size == (64, 36)


def test_checkpoints_and_scene_open_and_hold_what_was_built_by_then(mended: Played, tmp_path: Path) -> None:
    names = ("start", "modeling", "camera", "light")
    files = [mended.root / "checkpoints" / f"{name}.blend" for name in names]
    start, modeling, camera, light, scene = scenes(tmp_path, *files, mended.root / "scene.blend")
    assert "Object Planks" not in start
    assert "Object Planks" in modeling
    assert "Object Camera" not in modeling
    assert "Object Camera" in camera
    assert "Object Sun" not in camera
    assert "Object Sun" in light
    assert "Object Sun.001" not in light
    assert scene.keys() == light.keys()


def test_every_row_is_numbered_and_stands_in_its_place(mended: Played) -> None:
    rows = mended.rows
    assert [row["i"] for row in rows] == list(range(1, len(rows) + 1))
    assert sorted(row["t"] for row in rows) == [row["t"] for row in rows]
    told = ("model.asked", "model.answered", "tool.called", "tool.answered")
    stages = [(row["type"], row.get("stage")) for row in rows if row["type"] not in told]
    attempt = ["attempt.began", "attempt.ended", "verified", "reviewed", "decided"]
    assert stages == [
        ("run.began", None),
        ("sitting.began", None),
        ("room.told", None),
        ("plan", None),
        *((kind, "modeling") for kind in ("stage.began", "tactic", *attempt, *attempt, "stage.closed")),
        *(("stage.skipped", stage) for stage in ("uv", "texture", "deformation_setup", "motion")),
        *((kind, "camera") for kind in ("stage.began", "tactic", *attempt, *attempt, "stage.closed")),
        *((kind, "light") for kind in ("stage.began", "tactic", *attempt, "rolled.back")),
        *((kind, "light") for kind in ("tactic", *attempt, "stage.closed")),
        ("rendered", None),
        ("final.reviewed", None),
        *((kind, "render") for kind in ("rolled.back", "attempt.began", "attempt.ended", "verified")),
        ("rendered", None),
        ("final.reviewed", None),
        ("run.ended", None),
    ]


def test_the_first_and_the_last_row_say_what_the_run_is_and_what_came_of_it(mended: Played) -> None:
    began, ended = mended.rows[0], mended.rows[-1]
    assert (began["prompt"], began["mode"], began["source"]) == (PROMPT, "make", "live")
    assert set(began["models"].values()) == {"claude-opus-5-5"}
    assert began["blender"].startswith("5.1")
    assert (ended["outcome"], ended["file"], ended["video"]) == ("done", "scene.blend", "still.png")


def test_a_call_is_written_down_before_it_is_made_and_its_answer_before_the_next(mended: Played) -> None:
    open_calls: dict[tuple[object, ...], int] = {}
    answered = 0
    for row in mended.rows:
        if not row["type"].startswith(("tool.", "model.")):
            continue
        kind, part = row["type"].split(".")
        lane = (kind, row["n"], *([row["role"], row["stage"], row["attempt"]] if kind == "tool" else []))
        if part in ("called", "asked"):
            assert lane not in open_calls
            open_calls[lane] = row["i"]
        else:
            assert open_calls.pop(lane) < row["i"]
            answered += 1
    assert not open_calls
    assert answered > 60


def test_pictures_in_the_journal_are_files_that_a_role_saw(mended: Played) -> None:
    named = {
        block["path"] for row in mended.of("tool.answered") for block in row["content"] if "path" in block
    }
    named.update(path for row in mended.of("rendered") for path in row["pictures"])
    assert named == {f"pictures/{path.name}" for path in (mended.root / "pictures").iterdir()}
    for name in named:
        with Image.open(mended.root / name) as picture:
            picture.verify()


def test_every_live_answer_is_counted_with_its_price(mended: Played) -> None:
    turns = [row["turn"] for row in mended.of("model.answered")]
    assert len(turns) == len(mended.requests)
    assert all(turn["live"] and turn["usage"]["output"] == 20 for turn in turns)
    assert all(turn["cost"] == pytest.approx((100 * 4 + 20 * 20) / 1e6) for turn in turns)


def test_requests_are_streamed_and_marked_for_the_prompt_cache(mended: Played) -> None:
    for request in mended.requests:
        assert request["stream"]
        assert "cache_control" in request["system"][-1]
        assert "cache_control" in request["messages"][-1]["content"][-1]


def test_reviewers_see_pictures_and_the_planner_has_no_tools(mended: Played) -> None:
    for request in mended.requests:
        role, _ = whose(request)
        shown = "image" in json.dumps([block for one in request["messages"] for block in one["content"]])
        assert shown == (
            role in ("reviewer", "final_reviewer") or "preview" in json.dumps(request["messages"])
        )
        assert bool(request.get("tools")) == (role in ("coder", "reviewer"))


def test_what_falls_is_shown_as_a_video(falling: Played) -> None:
    assert falling.ended.how == "done"
    assert falling.ended.shown == falling.root / "video.mp4"
    assert (falling.root / "video.mp4").read_bytes()[4:8] == b"ftyp"
    rendered = falling.the("rendered")
    assert (rendered["kind"], rendered["frames"], len(rendered["pictures"])) == ("animation", 20, 5)


def shown_by(played: Played, stage: str, tool: str, **about: Any) -> list[dict[str, Any]]:
    """What a tool was asked for the reviewer of a stage's first attempt."""
    rows = played.of("tool.called", role="runner", stage=stage, name=tool, **about)
    return [row["input"] for row in rows]


def test_motion_is_shown_by_the_phases_of_the_plan(falling: Played) -> None:
    (sheet,) = shown_by(falling, "motion", "blender_motion_sheet_preview", attempt=1)
    assert sheet["actors"] == ["Crate"]
    assert [phase["name"] for phase in sheet["phases"]] == ["falls", "lies"]


def test_the_camera_is_judged_in_neutral_light_and_light_at_three_frames(falling: Played) -> None:
    (lit,) = shown_by(falling, "camera", "blender_material_preview")
    first, peak, last = lit["frames"]
    assert (first, last) == (1, 20)
    assert 5 <= peak <= 12, "it is fastest just before it lands"
    looks = [
        asked["frame"] for asked in shown_by(falling, "light", "blender_render") if asked["name"] != "mine"
    ]
    assert looks == [first, peak, last]


def test_the_reviewer_gets_the_stills_that_the_coder_made(falling: Played) -> None:
    told = [json.dumps(one["messages"]) for one in falling.requests if whose(one) == ("reviewer", "light")]
    assert told
    assert all(text.count("A still of the coder's own") == 1 for text in told)
    others = [json.dumps(one["messages"]) for one in falling.requests if whose(one) == ("reviewer", "camera")]
    assert others
    assert not any("A still of the coder's own" in text for text in others)


def test_who_judges_motion_sees_it(falling: Played) -> None:
    seen = [row["name"] for row in falling.of("tool.answered", role="runner", stage="motion", attempt=1)]
    assert "blender_motion_sheet_preview" in seen
    seen = [row["name"] for row in falling.of("tool.answered", role="runner", stage="modeling", attempt=1)]
    assert "blender_motion_sheet_preview" not in seen
