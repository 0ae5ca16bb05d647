"""The judge's part of a sweep: frames are judged once, whoever made them; why there is no judgement is told."""

from __future__ import annotations

import json
import shutil
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from judge_apis import Anthropic
from PIL import Image
from sweeping import record

from agents.cli import main

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from click.testing import Result

PROMPT_OF = {
    "objects": [{"words": "three-seat sofa", "text": "a three-seat sofa"}],
    "relations": [{"words": "against the back wall", "text": "the sofa stands against the back wall"}],
    "actions": [],
}


@pytest.fixture
def api(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Iterator[Anthropic]:
    monkeypatch.setenv("ANTHROPIC_API_KEY", "key")
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "home"))
    for name in ("ANTHROPIC_AUTH_TOKEN", "ANTHROPIC_BASE_URL"):
        monkeypatch.delenv(name, raising=False)
    made = Anthropic()
    made.script.lists = PROMPT_OF
    made.script.fails = ("objects_present.1",)
    with made.server:
        yield made


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A static scene by two systems: pictures that can be judged, files that cannot be audited."""
    for number, system in enumerate(("one", "two")):
        folder = tmp_path / system / "static_D1_01"
        folder.mkdir(parents=True)
        (folder / "scene.blend").write_bytes(b"none")
        Image.new("RGB", (64, 36), (60 * number, 90, 120)).save(folder / "still.png")
    return tmp_path


def judged(room: Path, api: Anthropic, system: str = "one", *words: str) -> Result:
    given = ["--system", f"folder={room / system}", "--scenes", "static_D1_01", "--out", str(room / "out")]
    return CliRunner().invoke(main, ["bench", "run", *given, "--judge-url", api.server.base_url, *words])


def verdict(room: Path, system: str = "one") -> dict[str, Any]:
    return record(room / "out" / system, "static_D1_01")["judged"]


def test_frames_are_judged_and_the_judgement_is_kept_with_its_cost(room: Path, api: Anthropic) -> None:
    done = judged(room, api)
    assert done.exit_code == 0, done.output
    assert "1 scene: 0 scored, 1 judged" in done.stdout
    found = verdict(room)
    judgement = json.loads((room / "out" / "one" / "static_D1_01" / "judgement.json").read_text())
    assert (found["why"], found["score"]) == (None, judgement["score"])
    assert found["scores"]["objects_present"] == 0
    assert "actions_visible" not in found["scores"]
    assert found["cost"] > 0
    assert (found["provider"], found["model"]) == ("anthropic", "claude-opus-5-5")


def test_the_same_frames_are_judged_once(room: Path, api: Anthropic) -> None:
    judged(room, api)
    asked = len(api.server.requests)
    before = verdict(room)
    judged(room, api)
    shutil.rmtree(room / "out")
    judged(room, api)
    assert len(api.server.requests) == asked
    assert verdict(room)["scores"] == before["scores"]


def test_all_systems_are_judged_by_one_list_of_items(room: Path, api: Anthropic) -> None:
    judged(room, api)
    judged(room, api, "two")
    assert api.stages() == ["items", "verdicts", "verdicts"]


def test_other_frames_are_judged_anew(room: Path, api: Anthropic) -> None:
    judged(room, api)
    Image.new("RGB", (64, 36), (9, 9, 9)).save(room / "one" / "static_D1_01" / "still.png")
    api.script.fails = ()
    before = verdict(room)
    judged(room, api)
    assert verdict(room)["score"] > before["score"]


def test_without_a_key_frames_are_there_and_it_says_why_they_are_not_judged(
    room: Path, api: Anthropic, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    done = judged(room, api)
    assert done.exit_code == 0
    assert "1 not judged: There is no key for the model" in done.stdout
    assert verdict(room)["score"] is None
    assert len(record(room / "out" / "one", "static_D1_01")["framed"]["frames"]) == 1


def test_a_judgement_stays_when_nobody_can_be_asked_for_another(
    room: Path, api: Anthropic, monkeypatch: pytest.MonkeyPatch
) -> None:
    judged(room, api)
    before = verdict(room)
    judged(room, api, "one", "--judge", "none")
    assert verdict(room) == before
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    judged(room, api)
    assert verdict(room) == before


def test_a_judge_who_refuses_is_told_and_asked_again_by_the_next_sweep(room: Path, api: Anthropic) -> None:
    api.script.instead["verdicts"].append(api.refusal())
    done = judged(room, api)
    assert "1 not judged: refused" in done.stdout
    assert verdict(room)["score"] is None
    judged(room, api)
    assert verdict(room)["score"] is not None


def test_the_limit_of_cost_holds_for_the_whole_sweep(room: Path, api: Anthropic) -> None:
    done = judged(room, api, "one", "--judge-max-cost", "0.0001")
    assert "1 not judged: over budget" in done.stdout
    assert not api.server.requests
