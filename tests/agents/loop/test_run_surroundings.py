"""What befalls a run from outside of its roles: scenes that cannot be saved, models that do not answer, early ends."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

import crates
import pytest
from fake_messages_api import Reply
from run_sessions import answered, go_on, scenes, seat, sit
from team import ABORT, DONE, Team, run, words_of

from agents.loop.record.journal import NAME, read_rows
from agents.loop.running import interruptible

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI

pytestmark = pytest.mark.blender

# A baked cache with a link in place of a frame, which is never followed: such a scene cannot be saved.
LINKED = """
import os
cache = planks.modifiers.new("Cloth", "CLOTH").point_cache
cache.frame_end, cache.use_disk_cache = 2, True
with bpy.context.temp_override(point_cache=cache):
    bpy.ops.ptcache.bake(bake=True)
folder = bpy.path.abspath("//blendcache_scene")
frame = os.path.join(folder, sorted(os.listdir(folder))[-1])
os.remove(frame)
os.symlink("/etc/hostname", frame)
"""
WHOLE = """
import bpy
planks = bpy.data.objects["Planks"]
planks.modifiers.remove(planks.modifiers["Cloth"])
"""


def test_a_coder_mends_what_keeps_the_scene_from_being_saved(api: FakeMessagesAPI, tmp_path: Path) -> None:
    heard: list[str] = []

    def mend(params: dict[str, Any]) -> Reply:
        heard.append(words_of(params))
        return run(WHOLE)

    api.answer = Team(
        coder={"modeling": (run(crates.STANDING + LINKED), Reply(DONE), mend, Reply(DONE))},
        decisions={"camera": (ABORT,)},
    )
    played = sit(tmp_path / "run", verifier=False)
    assert played.ended.how == "aborted"
    assert played.of("stage.closed", stage="modeling")[0]["attempts"] == 2
    assert "the scene cannot be saved. Mend what is in the way: " in heard[0]
    assert "is not a regular file" in heard[0]
    (modeling,) = scenes(tmp_path / "look", tmp_path / "run" / "scene.blend")
    assert "Object Planks" in modeling


def test_a_failure_to_save_is_tried_again_when_the_run_is_resumed(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    root = tmp_path / "run"
    in_the_way = root / "blender" / "camera.blend"

    def block(row: Mapping[str, Any]) -> None:
        if (row["type"], row.get("stage")) == ("stage.began", "camera"):
            in_the_way.mkdir(parents=True)

    api.answer = Team(decisions={"light": (ABORT,)})
    first = sit(root, seat(on_row=block))
    assert first.ended.how == "failed"
    assert "is a folder of this run" in first.ended.why
    assert first.ended.file == root / "scene.blend"
    in_the_way.rmdir()
    asked = len(api.requests)
    second = go_on(root)
    assert second.ended.how == "aborted"
    assert [row["stage"] for row in second.of("stage.closed")] == ["modeling", "camera"]
    assert len(api.requests) == len(second.of("model.answered")) > asked
    saved = second.of("tool.answered", role="runner", stage="camera", name="blender_save")
    assert [row["failed"] for row in saved] == [True, True, True, False, False]


def test_the_scene_stands_from_the_first_closed_stage_on_and_is_replaced(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    root = tmp_path / "run"
    stood: dict[str, bytes] = {}
    in_the_way = root / "blender" / "delivered" / "render" / "scene.blend"

    def keep(row: Mapping[str, Any]) -> None:
        if row["type"] == "stage.closed":
            stood[row["stage"]] = (root / "scene.blend").read_bytes()
        if row["type"] == "final.reviewed":
            in_the_way.mkdir(parents=True)

    first = sit(root, seat(on_row=keep))
    assert (first.ended.how, first.ended.file) == ("failed", root / "scene.blend"), "it is not the result"
    in_the_way.rmdir()
    assert go_on(root).ended.how == "done"
    assert (root / "scene.blend").read_bytes() != stood["light"]
    assert list(stood) == ["modeling", "camera", "light"]
    assert len({*stood.values()}) == 3
    for stage, content in stood.items():
        (tmp_path / f"{stage}.blend").write_bytes(content)
    modeling, camera = scenes(tmp_path / "look", tmp_path / "modeling.blend", tmp_path / "camera.blend")
    assert "Object Planks" in modeling
    assert "Object Camera" not in modeling
    assert "Object Camera" in camera


def test_a_save_names_the_path_at_which_the_scene_stays(api: FakeMessagesAPI, tmp_path: Path) -> None:
    api.answer = Team(decisions={"modeling": (ABORT,)})
    played = sit(tmp_path / "run")
    saved = played.of("tool.answered", name="blender_save")[0]["content"][0]["text"]
    assert str(played.root / "checkpoints" / "start.blend") in saved


def test_a_stop_does_not_wait_for_a_model_that_does_not_answer(
    home: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interruptible, "GRACE", 0.0)
    over, at = threading.Event(), seat()

    def hang(role: str, stage: str, params: dict[str, Any]) -> None:
        if role == "coder" and not over.is_set():
            at.stop.event.set()
            over.wait(120)

    with answered(home, Team(first=hang, decisions={"modeling": (ABORT,)})):
        played = sit(tmp_path / "run", at)
        rows = read_rows(tmp_path / "run" / NAME)
        over.set()
        assert played.ended.how == "stopped"
        assert "had not answered; it is asked again" in played.ended.why
        assert [row["type"] for row in rows[-2:]] == ["model.asked", "run.ended"]
        assert go_on(tmp_path / "run").ended.how == "aborted"
