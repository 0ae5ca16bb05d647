"""SimWorlds itself as a system: runs that are begun, taken up again, ended; what their journals tell."""

from __future__ import annotations

import json
import signal
import threading
from typing import TYPE_CHECKING, Any

import pytest
from fake_messages_api import FakeMessagesAPI, Reply
from processes_below import all_end, below
from sweeping import CHEAP, record

from bench.scenes.spec import spec_of
from bench.sweep.records import SystemInfo
from bench.sweep.systems.simworlds_runs import TRANSCRIPTS, ReplaySystem, SimWorldsSystem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from sweeping import Command

REFUSAL = Reply("", stop_reason="refusal", stop_details={"type": "refusal", "explanation": "not this"})
SCENE = "cloth_D1_01"


def began(**more: Any) -> dict[str, Any]:
    return {
        "t": "2026-01-01T10:00:00+00:00",
        "type": "run.began",
        "prompt": "A crate",
        "source": "live",
        "models": {"planner": "a", "coder": "b"},
        **more,
    }


def answered(minute: int, cost: float | None, **more: Any) -> dict[str, Any]:
    usage = {"input": 100, "output": 10, "cache_read": 5, "cache_write": 0}
    lost = {"input": 1, "output": 0, "cache_read": 0, "cache_write": 0}
    turn = {"live": True, "cost": cost, "usage": usage, "lost": lost, **more}
    return {"t": f"2026-01-01T10:{minute:02}:00+00:00", "type": "model.answered", "n": minute, "turn": turn}


def ended(minute: int, outcome: str, file: str | None = None, video: str | None = None) -> dict[str, Any]:
    row = {"type": "run.ended", "outcome": outcome, "why": "so", "file": file, "video": video}
    return {"t": f"2026-01-01T10:{minute:02}:00+00:00", **row}


@pytest.fixture
def run(tmp_path: Path) -> Callable[..., Any]:
    """What is made of a run that has come to its end, with these rows in its journal."""

    def run(
        rows: Iterable[dict[str, Any]], system: type[SimWorldsSystem | ReplaySystem] = SimWorldsSystem
    ) -> Any:
        place = tmp_path / "run"
        place.mkdir()
        (place / "scene.blend").touch()
        (place / "video.mp4").touch()
        (place / "journal.jsonl").write_text("".join(f"{json.dumps(row)}\n" for row in rows))
        return system(SystemInfo(name="it", kind="simworlds")).produce(spec_of(SCENE), place, lambda _: None)

    return run


# Journals


def test_a_finished_run_is_not_repeated_and_its_costs_are_read(
    run: Callable[..., Any], tmp_path: Path
) -> None:
    session = {"t": "2026-01-01T10:30:00+00:00", "type": "sitting.began"}
    rows = [
        began(),
        answered(3, 0.25),
        session,
        answered(31, 0.5),
        ended(33, "done", "scene.blend", "video.mp4"),
    ]
    made = run(rows)
    assert (made.outcome, made.prompt, made.cost, made.minutes) == ("done", "A crate", 0.75, 6)
    assert (made.blend, made.video) == (tmp_path / "run" / "scene.blend", tmp_path / "run" / "video.mp4")
    assert made.models == {"planner": "a", "coder": "b"}
    assert made.tokens == {"input": 202, "output": 20, "cache_read": 10, "cache_write": 0}


def test_an_aborted_run_counts_with_its_last_scene(run: Callable[..., Any]) -> None:
    made = run([began(), ended(1, "aborted", "scene.blend")])
    assert (made.outcome, made.why, made.video) == ("aborted", "so", None)
    assert made.blend is not None


def test_an_unknown_cost_is_not_zero(run: Callable[..., Any]) -> None:
    assert run([began(), answered(1, 0.25), answered(2, None), ended(3, "done")]).cost is None


def test_a_transcript_has_its_author_as_model_and_costs_nothing(run: Callable[..., Any]) -> None:
    rows = [began(source="hand-written session: dominoes"), answered(1, None, live=False), ended(2, "done")]
    made = run(rows, ReplaySystem)
    assert (made.models, made.cost, made.tokens) == ({"all roles": "hand-written session: dominoes"}, 0, {})


@pytest.mark.parametrize("file", ["../../secret.blend", "/etc/passwd", "none.blend", "", None, 7])
def test_ignores_files_outside_the_run(file: Any, run: Callable[..., Any], tmp_path: Path) -> None:
    (tmp_path.parent / "secret.blend").touch()
    assert run([began(), ended(1, "done", file)]).blend is None


def test_a_scene_without_a_transcript_is_missing(tmp_path: Path) -> None:
    replay = ReplaySystem(SystemInfo(name="it", kind="replay"))
    made = replay.produce(spec_of("rigid_D1_01"), tmp_path, lambda _: None)
    assert (made.outcome, made.why) == ("missing", "there is no transcript for it")
    assert not replay.is_for(spec_of("rigid_D1_01"))


def test_every_transcript_has_an_existing_scene() -> None:
    from agents.loop.answer_source import transcripts

    assert all(spec_of(scene) for scene in TRANSCRIPTS)
    assert {*TRANSCRIPTS.values()} == {*transcripts()} - {"edit"}


# Real runs, against a model that does not help


@pytest.fixture
def known(base: Path, tmp_path: Path) -> dict[str, str]:
    """The settings of a home with a knowledge base, which would be built beside a run otherwise."""
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "kb").symlink_to(base.parent)
    return {"SIMWORLDS_HOME": str(tmp_path / "home")}


@pytest.mark.blender
def test_records_why_a_run_failed_and_resumes_it_in_the_next_sweep(
    known: dict[str, str], tmp_path: Path, command: Callable[..., Command]
) -> None:
    with FakeMessagesAPI(lambda _: REFUSAL) as api:
        reached = {**known, "ANTHROPIC_API_KEY": "any", "ANTHROPIC_BASE_URL": api.base_url}
        words = ("run", "--system", "simworlds", "--scenes", SCENE, "--out", tmp_path, "--no-stages", *CHEAP)
        code, out, _ = command(*words, **reached).end()
        assert (code, "1 scene: 0 scored" in out) == (0, True)
        first = record(tmp_path / "simworlds+no-stages", SCENE)
        asked = len(api.requests)
        assert asked > 0
        assert command(*words, **reached).end()[0] == 0
        assert len(api.requests) > asked
        other = command(*words, "--model", "claude-haiku-5-5", **reached).end()
    assert first["produced"]["outcome"] == "failed"
    assert first["produced"]["why"]
    assert first["audited"]["why"] == first["produced"]["why"]
    assert first["system"]["ablations"] == ["no-stages"]
    assert set(first["produced"]["models"].values()) == {"claude-opus-5-5"}
    again = record(tmp_path / "simworlds+no-stages", SCENE)
    assert again["produced"]["at"] >= first["produced"]["at"]
    assert len(list((tmp_path / "simworlds+no-stages" / SCENE / "work").glob("*/journal.jsonl"))) == 1
    assert other[0] == 2
    assert "holds results of other settings: model None (now claude-haiku-5-5)" in other[2]


@pytest.mark.blender
def test_ctrl_c_stops_a_waiting_run_which_can_be_resumed(
    known: dict[str, str], tmp_path: Path, command: Callable[..., Command]
) -> None:
    asked, answer = threading.Event(), threading.Event()

    def wait(_: Any) -> Reply:
        asked.set()
        answer.wait(240)  # longer than a busy machine takes to send the signal
        return REFUSAL

    with FakeMessagesAPI(wait) as api:
        reached = {**known, "ANTHROPIC_API_KEY": "any", "ANTHROPIC_BASE_URL": api.base_url}
        words = ("run", "--system", "simworlds", "--scenes", SCENE, "--out", tmp_path, *CHEAP)
        sweep = command(*words, **reached)
        assert asked.wait(120)
        children = below(sweep.process.pid)
        sweep.kill(signal.SIGINT)
        assert sweep.process.returncode == 130
        assert len(children) > 1
        assert all_end(children)
        answer.set()
    assert not (tmp_path / "simworlds" / SCENE / "record.json").exists()
    (journal,) = (tmp_path / "simworlds" / SCENE / "work").glob("*/journal.jsonl")
    assert "run.began" in journal.read_text()
