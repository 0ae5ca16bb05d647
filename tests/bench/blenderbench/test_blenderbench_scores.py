"""Scores of what was made, without making it again, and the table of them."""

from __future__ import annotations

import json
import shutil
from itertools import product
from statistics import fmean
from typing import TYPE_CHECKING, Any

import pytest
from click.testing import CliRunner
from fake_messages_api import FakeMessagesAPI, Reply, Status
from PIL import Image
from test_blenderbench_vlm import marks

from bench.blenderbench.published import OVERALL, PUBLISHED, TASKS
from bench.blenderbench.report import as_markdown, read_results
from bench.blenderbench.results import Score, read, task_folder
from bench.blenderbench.run import run
from bench.blenderbench.score import ScoringRule, score
from bench.blenderbench.systems import RendersFolder
from bench.blenderbench.task_set import LEVELS, BenchTask, TaskSet
from bench.blenderbench.weights import Clip
from simworlds.cli import main

if TYPE_CHECKING:
    from pathlib import Path

GREY = 100


def bench(*words: object) -> Any:
    return CliRunner().invoke(main, ["bench", "blenderbench", *map(str, words)])


@pytest.fixture
def found(tmp_path: Path) -> TaskSet:
    """A set whose goals are grey; nobody opens its scenes."""
    tasks: list[BenchTask] = []
    for level, name in (("level1", "a1"), ("level1", "a2"), ("level2", "b1"), ("level3", "c1")):
        folder = tmp_path / "set" / level / name
        goal = folder / "renders" / "goal" / "render1.png"
        goal.parent.mkdir(parents=True)
        grey(goal, GREY)
        for file in ("blender_file.blend", "start.py", "task.txt"):
            (folder / file).write_bytes(b"BLENDER")
        tasks.append(
            BenchTask(level, name, folder, folder / "blender_file.blend", "", f"Do {name}.", goal, (32, 16))
        )
    return TaskSet(tmp_path / "set", tuple(tasks), ("level1/a3/task.txt is missing.",))


def grey(path: Path, shade: int) -> None:
    Image.new("RGB", (32, 16), (shade, shade, shade)).save(path)


@pytest.fixture
def out(found: TaskSet, tmp_path: Path) -> Path:
    """Rounds of somebody: all but one task, whose shades differ from the goals' by so many steps."""
    theirs = tmp_path / "theirs"
    for task, steps in (("level1/a1", (51, 0, 51)), ("level1/a2", (102,)), ("level2/b1", (0, 51))):
        (theirs / task).mkdir(parents=True)
        for number, step in enumerate(steps, 1):
            grey(theirs / task / f"{number}.png", GREY + step)
    run(found, found.tasks, RendersFolder(theirs), tmp_path / "out")
    return tmp_path / "out"


def test_scores_the_last_round_with_the_loss_by_hand(out: Path) -> None:
    scores = {one.task: one for one in score(out, ScoringRule())}
    assert scores["level1/a1"].pl == pytest.approx(4.0, abs=1e-5)  # 0.2² × 100
    assert [each.pl for each in scores["level1/a1"].rounds] == pytest.approx([4.0, 0.0, 4.0], abs=1e-5)
    assert scores["level1/a2"].pl == pytest.approx(16.0, abs=1e-5)
    assert scores["level2/b1"].chosen == "renders/02.png"
    assert (scores["level1/a1"].n_clip, scores["level1/a1"].vlm) == (None, None)


def test_a_failed_task_has_a_reason_and_no_zero(out: Path) -> None:
    last = score(out, ScoringRule())[-1]
    assert (last.task, last.pl, last.rounds) == ("level3/c1", None, ())
    assert "has no render" in last.missing["pl"]


def test_the_peers_convention_multiplies_nothing(out: Path) -> None:
    assert score(out, ScoringRule(convention="peer"))[0].pl == pytest.approx(0.04, abs=1e-7)


class Shades:
    """In the place of the tower: pictures are as far apart as their shades."""

    def embed(self, pictures: list[Image.Image]) -> Any:
        import numpy as np

        turns = [picture.getpixel((0, 0))[0] / 255 for picture in pictures]  # type: ignore[index]
        return np.array([[np.cos(turn), np.sin(turn)] for turn in turns])


def clip() -> Clip:
    tower: Any = Shades()
    return Clip(tower, "made up", "0" * 64)


def test_chooses_the_best_round_by_n_clip_only_on_request(out: Path) -> None:
    plain = {one.task: one for one in score(out, ScoringRule(clip=clip()))}
    best = {one.task: one for one in score(out, ScoringRule(clip=clip(), best_round=True))}
    assert (plain["level1/a1"].chosen, best["level1/a1"].chosen) == ("renders/03.png", "renders/02.png")
    assert (plain["level2/b1"].chosen, best["level2/b1"].chosen) == ("renders/02.png", "renders/01.png")
    assert best["level1/a1"].pl == pytest.approx(0, abs=1e-6)
    text = as_markdown([read_results(out)])
    assert "the round with the best N-CLIP counts" in text
    assert "does not use OpenAI's weights: made up" in text


def test_the_best_round_without_weights_is_an_error_and_nothing_is_scored(out: Path) -> None:
    done = bench("score", out, "--best-round")
    assert done.exit_code == 2
    assert "--best-round chooses by N-CLIP" in done.stderr
    assert not task_folder(out, "level1/a1").scores.exists()


def test_means_are_over_tasks_and_count_missing_ones(out: Path) -> None:
    score(out, ScoringRule())
    found = read_results(out)
    assert found.rows["level1"]["pl"].mean == pytest.approx(10, abs=1e-5)
    assert (found.rows["level3"]["pl"].mean, found.rows["level3"]["pl"].tasks) == (None, 0)
    assert found.rows[OVERALL]["pl"].mean == pytest.approx(fmean([4, 16, 4]), abs=1e-5)
    assert found.rows[OVERALL]["pl"].tasks == 3


def test_the_table_states_its_basis(out: Path) -> None:
    score(out, ScoringRule())
    text = as_markdown([read_results(out)], published=True)
    rows = {line.split("|")[1].strip(): line for line in text.splitlines() if line.startswith("| ")}
    assert rows["Level 1"].split("|")[2].strip() == "10.00"
    assert rows["Overall"].split("|")[2].strip() == "8.00 (3 of 4)"
    assert rows["Level 3"].split("|")[2].strip() == "–"
    assert [cell.strip() for cell in rows["Overall"].split("|")[5:11]] == [
        "6.02",
        "5.28",
        "2.76",
        "4.63",
        "4.80",
        "3.41",
    ]
    assert "theirs: 4 of 4 tasks; distances at the goal's size, × 100; the last round counts" in text
    assert "level1/a3/task.txt is missing." in text
    assert "level3/c1 has no PL: " in text


def test_does_not_mix_published_figures_with_another_convention(out: Path) -> None:
    score(out, ScoringRule(convention="peer"))
    done = bench("report", out, "--paper")
    assert done.exit_code == 2
    assert "Score without --peer" in done.stderr


def test_the_published_overall_figures_are_means_over_nine_eight_and_nine_tasks_and_no_others() -> None:
    def furthest(counts: tuple[int, ...]) -> float:
        return max(
            abs(
                sum(rows[level][at] * count for level, count in zip(LEVELS, counts, strict=True))
                / sum(counts)
                - overall
            )
            for rows in PUBLISHED.values()
            for at, overall in enumerate(rows[OVERALL])
        )

    fitting = [counts for counts in product(range(1, 10), repeat=3) if furthest(counts) <= 0.01]
    assert fitting == [tuple(TASKS.values())] == [(9, 8, 9)]


def test_does_not_combine_results_scored_differently(out: Path, tmp_path: Path) -> None:
    done = bench("report", out)
    assert done.exit_code == 2
    assert "not scored yet" in done.stderr
    score(out, ScoringRule())
    shutil.copytree(out, tmp_path / "other")
    score(tmp_path / "other", ScoringRule(convention="peer"))
    assert "both conventions" in bench("report", out, tmp_path / "other").stderr
    shutil.copy(task_folder(tmp_path / "other", "level1/a1").scores, task_folder(out, "level1/a1").scores)
    assert "scored with different options" in bench("report", out).stderr


def test_the_json_has_every_score_with_provenance(out: Path) -> None:
    score(out, ScoringRule())
    done = bench("report", out, "--json")
    assert done.exit_code == 0
    [told] = json.loads(done.stdout)
    assert (told["system"], told["convention"], told["best_round"]) == ("theirs", "paper", False)
    assert told["rows"]["level1"]["pl"] == {"mean": pytest.approx(10, abs=1e-5), "tasks": 2}
    assert [one["task"] for one in told["scores"]] == ["level1/a1", "level1/a2", "level2/b1", "level3/c1"]
    assert len(told["scores"][0]["provenance"]["code"]) == 64


def test_a_lost_goal_is_a_reason_and_no_crash(out: Path) -> None:
    task_folder(out, "level1/a1").goal.write_bytes(b"")
    done = bench("score", out)
    assert done.exit_code == 1
    assert "level1/a1: pl is not scored" in done.stderr


@pytest.mark.parametrize(("name", "told"), [("none", "has no results"), ("set", "has no results")])
def test_a_folder_without_results_says_so(name: str, told: str, found: TaskSet, tmp_path: Path) -> None:
    for command in ("score", "report"):
        done = bench(command, tmp_path / name)
        assert done.exit_code == 2
        assert told in done.stderr


# Marks


def test_the_judge_marks_the_chosen_round_and_failures_are_counted(
    out: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with FakeMessagesAPI(lambda params: Reply(json.dumps(marks(3, 4, 4, 4)))) as api:
        monkeypatch.setenv("ANTHROPIC_API_KEY", "any")
        api.fail("POST /v1/messages", Status(400))
        words = ("--judge", "anthropic", "--base-url", api.base_url, "--cache", tmp_path / "kept")
        done = bench("score", out, *words)
        assert done.exit_code == 1
        assert "level1/a1: vlm is not scored: rejected" in done.stderr
        assert read(task_folder(out, "level1/a2").scores, Score).vlm == 3.75
        asked = len(api.received("POST /v1/messages"))
        assert bench("score", out, *words).exit_code == 1  # level3/c1 has nothing to show
        assert len(api.received("POST /v1/messages")) == asked + 1
    text = as_markdown([read_results(out)])
    assert "marks by claude-opus-5-5, wording " in text
    assert "| 3.75" in text


def test_a_judge_without_a_key_is_an_error_before_anything_is_scored(out: Path) -> None:
    done = bench("score", out, "--judge", "anthropic")
    assert done.exit_code == 2
    assert "set the environment variable ANTHROPIC_API_KEY" in done.stderr
    assert not task_folder(out, "level1/a1").scores.exists()
