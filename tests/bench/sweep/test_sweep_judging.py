"""The judge's part of a sweep: frames are judged once, whoever made them; why there is no judgement is told."""

from __future__ import annotations

import json
import shutil
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from judge_apis import Anthropic
from PIL import Image

from bench.audit.untrusted_blend import BlenderOptions
from bench.frames.clip_frames import RenderQuality
from bench.sweep.judging import JudgeOptions, judge_all, judge_of
from bench.sweep.records import Judged, read_record, write_record
from bench.sweep.sweep import ScoringOptions, make_rescore_tasks
from simworlds.cli import main

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SCENE = "static_D1_01"
LISTS = {
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
    made.script.lists = LISTS
    made.script.fails = ("objects_present.1",)
    with made.server:
        yield made


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A static scene by two systems, framed and not judged: pictures, and files that cannot be audited."""
    place = tmp_path_factory.mktemp("room")
    for number, system in enumerate(("one", "two")):
        folder = place / system / SCENE
        folder.mkdir(parents=True)
        (folder / "scene.blend").write_bytes(b"none")
        Image.new("RGB", (64, 36), (60 * number, 90, 120)).save(folder / "still.png")
        words = ["--system", f"folder={place / system}", "--scenes", SCENE, "--out", str(place / "out")]
        done = CliRunner().invoke(main, ["bench", "run", *words, "--judge", "none"])
        assert (done.exit_code, "1 not judged: no judge was requested" in done.stdout) == (0, True)
    return place / "out"


@pytest.fixture
def out(swept: Path, tmp_path: Path) -> Path:
    """A copy of the results."""
    shutil.copytree(swept, tmp_path / "out")
    return tmp_path / "out"


def judged(out: Path, api: Anthropic, **given: object) -> dict[str, Judged]:
    """What stands in each system's record after a judge was asked."""
    who = {"provider": "anthropic", "base_url": api.server.base_url, "cache": out.parent / "kept", **given}
    with closing(judge_of(JudgeOptions(**who))) as judge:  # type: ignore[arg-type]
        for tasks in make_rescore_tasks(out, ScoringOptions(BlenderOptions(), RenderQuality())):
            assert len(list(judge_all(tasks, judge))) == len(tasks)
    found = {path.parent.parent.name: read_record(path.parent) for path in out.glob("*/*/record.json")}
    return {name: one.judged for name, one in found.items() if one is not None and one.judged is not None}


def test_judges_frames_and_keeps_the_judgement_with_its_cost(out: Path, api: Anthropic) -> None:
    done = CliRunner().invoke(
        main, ["bench", "rescore", str(out / "one"), "--judge-url", api.server.base_url]
    )
    assert (done.exit_code, "1 scene: 0 scored, 1 judged" in done.stdout) == (0, True), done.output
    record = read_record(out / "one" / SCENE)
    assert record is not None
    assert record.judged is not None
    judgement = json.loads((out / "one" / SCENE / "judgement.json").read_text())
    assert (record.judged.why, record.judged.score) == (None, judgement["score"])
    assert record.judged.scores["objects_present"] == 0
    assert "actions_visible" not in record.judged.scores
    assert (record.judged.cost or 0) > 0
    assert (record.judged.provider, record.judged.model) == ("anthropic", "claude-opus-5-5")


def test_judges_all_systems_once_by_one_list_of_items(out: Path, api: Anthropic) -> None:
    first = judged(out, api)
    assert sorted(api.stages()) == ["items", "verdicts", "verdicts"]
    assert judged(out, api) == first
    assert len(api.server.requests) == 3


def test_judges_new_frames_again(out: Path, api: Anthropic) -> None:
    before = judged(out, api)["one"].score or 0
    Image.new("RGB", (64, 36), (9, 9, 9)).save(out / "one" / SCENE / "frames" / "000.png")
    api.script.fails = ()
    assert (judged(out, api)["one"].score or 0) > before


def test_without_a_key_it_says_why_frames_are_not_judged(
    out: Path, api: Anthropic, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    found = judged(out, api)["one"]
    assert found.score is None
    assert "set the environment variable ANTHROPIC_API_KEY" in (found.why or "")


def test_keeps_a_judgement_when_no_judge_is_available(
    out: Path, api: Anthropic, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = judged(out, api)
    assert judged(out, api, provider="none") == before
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    assert judged(out, api) == before


def test_an_earlier_judgement_is_not_passed_off_as_the_new_judges(out: Path, api: Anthropic) -> None:
    before = judged(out, api)
    words = ["--judge-url", api.server.base_url, "--judge-model", "mine", "--judge-max-cost", "1"]
    rescore = ["bench", "rescore", str(out), "--judge-cache", str(out.parent / "kept"), *words]
    done = CliRunner().invoke(main, rescore)
    assert done.exit_code == 0
    assert "0 judged" in done.stdout
    assert (
        "1 with an earlier judgement, which stays: over budget: No price is known for the model"
        in done.stdout
    )
    model = before["one"].model
    assert "not judged: over budget: No price is known for the model 'mine'" in done.stderr
    assert f"of anthropic/{model} stays" in done.stderr
    assert judged(out, api, provider="none") == before
    priced = CliRunner().invoke(main, [*rescore, "--judge-price", "1/2"])
    assert (priced.exit_code, "1 judged" in priced.stdout) == (0, True)
    told = CliRunner().invoke(main, ["bench", "report", str(out), "--html", str(out.parent / "page.html")])
    assert "VLM scores are those of anthropic/mine, prompts" in " ".join(told.output.split())


def test_drops_a_judgement_of_frames_that_are_gone(out: Path, api: Anthropic) -> None:
    judged(out, api)
    record = read_record(out / "one" / SCENE)
    assert record is not None
    assert record.framed is not None
    framed = record.framed.model_copy(update={"frames": (), "why": "it is no picture"})
    write_record(out / "one" / SCENE, record.model_copy(update={"framed": framed}))
    found = judged(out, api)["one"]
    assert (found.score, found.why) == (None, "no frames: it is no picture")


def test_records_a_refusal_and_asks_again_in_the_next_sweep(out: Path, api: Anthropic) -> None:
    shutil.rmtree(out / "two")
    api.script.instead["verdicts"].append(api.refusal())
    assert (judged(out, api)["one"].why or "").startswith("refused")
    assert judged(out, api)["one"].score is not None


def test_the_cost_limit_holds_for_all_scenes_together(out: Path, api: Anthropic) -> None:
    found = judged(out, api, max_cost=0.0001)
    assert all((one.why or "").startswith("over budget") for one in found.values())
    assert not api.server.requests
