"""``simworlds bench judge``: what it prints, what it costs, and how it ends."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from fake_messages_api import Status
from judge_apis import LISTS, PROMPT, STILL, STILL_LISTS
from places import REPO

from bench.scenes.spec import FOLDER, spec_of
from simworlds.cli import main

DOCS = REPO / "docs" / "judge.md"
TABLECLOTH = {
    "objects": [
        {"words": "red tablecloth", "text": "a red tablecloth"},
        {"words": "small round wooden table", "text": "a small round wooden table"},
    ],
    "relations": [
        {"words": "drapes over a small round wooden table", "text": "the tablecloth lies over the table"}
    ],
    "actions": [{"words": "A red tablecloth drapes", "text": "the tablecloth drapes over the table"}],
}


def run(*words: object):
    return CliRunner().invoke(main, ["bench", "judge", *map(str, words)])


@pytest.fixture
def on(api):
    """Options that lead to the server."""
    return ["--provider", api.name, "--base-url", api.server.base_url]


def test_it_prints_each_dimension_with_items_verdicts_evidence_score_and_cost(claude, frames):
    found = run(*frames, "--prompt", PROMPT, "--base-url", claude.server.base_url)
    assert found.exit_code == 0, found.output
    for line in (
        "objects_present 0.750",
        "  ✓ two parrots",
        "  ✗ a bamboo perch",
        "      Seen in the middle. [1, 5]",
        "score 0.900   $0.0080, plus $0.0080 once for the prompt; 1,000 tokens in, 200 out",
        "Asked now: 2 requests, $0.0160, 2,000 tokens in, 400 out",
    ):
        assert line in found.output.splitlines()
    again = run(*frames, "--prompt", PROMPT, "--base-url", claude.server.base_url)
    assert "Nothing was asked now: all answers were cached." in again.output
    assert len(claude.server.requests) == 2


def test_a_scene_is_judged_by_its_own_prompt(api, on, frames):
    api.script.lists = TABLECLOTH
    found = run(*frames, "--scene", "cloth_D1_01", "--json", *on)
    assert found.exit_code == 0, found.output
    told = json.loads(found.output)
    assert told["judgements"][0]["scene"] == "cloth_D1_01"
    assert told["judgements"][0]["scores"]["objects_present"] == 0.5
    assert (told["not_judged"], told["agreement"]) == ([], None)
    assert told["asked_now"]["requests"] == 2
    assert (told["asked_now"]["cost"] is None) == (api.name == "openai")
    assert spec_of("cloth_D1_01").prompt in api.question(0)[0]
    assert "cloth_D1_01" not in api.question(0)[0] + api.question(1)[0]


def test_a_scene_of_ones_own_is_read_from_its_file(claude, frames):
    claude.script.lists = TABLECLOTH
    options = ["--scene", FOLDER / "cloth_D1_01.yaml", "--json", "--base-url", claude.server.base_url]
    assert json.loads(run(*frames, *options).output)["judgements"][0]["scene"] == "cloth_D1_01"


def test_repeated_judgements_come_with_their_agreement(claude, frames):
    options = ["--prompt", PROMPT, "--repeat", 3, "--base-url", claude.server.base_url]
    found = json.loads(run(*frames, *options, "--json").output)
    assert [one["repetition"] for one in found["judgements"]] == [0, 1, 2]
    assert found["agreement"]["overall"]["pairwise"] == 1.0
    assert claude.stages() == ["items", "verdicts", "verdicts", "verdicts"]
    words = run(*frames, *options).output
    assert "agreement of 3 judgements" in words
    assert "all items" in words


def test_items_with_disagreement_are_named(claude, frames):
    claude.script.instead["verdicts"].append(
        lambda ids: {
            "verdicts": [{"id": one, "evidence": "No.", "frames": [], "holds": False} for one in ids]
        }
    )
    words = run(*frames, "--prompt", PROMPT, "--repeat", 2, "--base-url", claude.server.base_url).output
    assert "disagreement on objects_present.1 (0.50)" in words


def test_a_failed_judgement_is_reported_and_the_others_count(claude, frames):
    claude.script.instead["verdicts"].append(claude.refusal())
    found = run(*frames, "--prompt", PROMPT, "--repeat", 3, "--json", "--base-url", claude.server.base_url)
    assert found.exit_code == 2
    told = json.loads(found.stdout)
    assert [one["repetition"] for one in told["judgements"]] == [1, 2]
    assert [(one["repetition"], one["reason"]) for one in told["not_judged"]] == [(0, "refused")]
    assert "repetition 0" in found.stderr


def test_a_lasting_failure_is_not_repeated(claude, frames):
    claude.fail(Status(401))
    found = run(*frames, "--prompt", PROMPT, "--repeat", 5, "--base-url", claude.server.base_url)
    assert (found.exit_code, len(claude.server.requests)) == (2, 1)
    assert "Not judged (repetition 0): rejected:" in found.stderr
    assert found.stdout == ""


def test_a_still_is_known_from_the_scene_or_the_option(claude, frames):
    claude.script.lists = STILL_LISTS
    options = ["--base-url", claude.server.base_url, "--json"]
    found = json.loads(run(frames[0], "--prompt", STILL, "--static", *options).output)
    assert "actions_visible" not in found["judgements"][0]["dimensions"]
    assert run(*frames, "--scene", "static_D1_01", *options).exit_code == 2
    assert run(*frames, "--scene", "cloth_D1_01", "--static", *options).exit_code == 2


def test_the_limit_of_the_cost_is_respected(claude, frames):
    found = run(*frames, "--prompt", PROMPT, "--max-cost", "0.01", "--base-url", claude.server.base_url)
    assert found.exit_code == 2
    assert "over budget" in found.stderr
    assert claude.server.requests == []


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--scene", "cloth_D1_01"], "Give the frames"),
        (["a.png"], "--scene or --prompt"),
        (["a.png", "--dry-run"], "--scene or --prompt"),
        ([], "Give the frames"),
        (["a.png", "--scene", "cloth_D1_01", "--prompt", "x"], "not both"),
        (["a.png", "--scene", "cloth_D9_01"], "no scene 'cloth_D9_01'"),
        (["a.png", "b.png", "--prompt", "x"], "There is no file a.png, b.png"),
        (["--price", "cheap", "--dry-run"], "is not a price"),
    ],
)
def test_the_reason_why_nothing_was_judged_is_printed(words, told):
    found = run(*words)
    assert found.exit_code == 2
    assert told in found.output
    assert "Traceback" not in found.output


# Asking nobody


@pytest.fixture
def _alone(monkeypatch):
    for name in ("ANTHROPIC_API_KEY", "OPENAI_API_KEY"):
        monkeypatch.delenv(name)
    monkeypatch.setenv("ANTHROPIC_BASE_URL", "http://127.0.0.1:1")
    monkeypatch.setenv("OPENAI_BASE_URL", "http://127.0.0.1:1")


@pytest.mark.usefixtures("_alone")
@pytest.mark.parametrize("provider", ["anthropic", "openai"])
def test_a_dry_run_shows_the_questions_and_needs_no_key(frames, provider):
    found = run(*frames, "--prompt", PROMPT, "--dry-run", "--provider", provider)
    assert found.exit_code == 0, found.output
    assert "═══ items: asked 1 time, 0 pictures" in found.output
    assert "═══ verdicts: asked 1 time, 5 pictures" in found.output
    assert found.output.count("[picture, 64 × 36, about 6 tokens]") == 5
    assert PROMPT in found.output
    assert ("price is unknown" in found.output) == (provider == "openai")


@pytest.mark.usefixtures("_alone")
def test_a_dry_run_of_all_scenes_shows_the_cost_of_one_system():
    rows = json.loads(run("--dry-run", "--json", "--repeat", 2).output)
    asked = {stage: [row for row in rows if row["stage"] == stage] for stage in ("items", "verdicts")}
    assert sum(row["times"] for row in asked["items"]) == 50
    assert sum(row["times"] for row in asked["verdicts"]) == 100
    assert sorted({row["pictures"] for row in asked["verdicts"]}) == [1, 5]
    assert all(row["most"] > row["cost"] > 0 for row in rows)


@pytest.mark.usefixtures("_alone")
def test_the_costs_in_the_documentation_are_what_the_command_prints():
    costs, separator, _ = run("--dry-run").output.rpartition("An invalid answer")
    assert separator
    assert costs in DOCS.read_text("utf-8"), (
        "copy the output of 'simworlds bench judge --dry-run' to docs/judge.md"
    )


def test_a_dry_run_shows_cached_answers_and_items(claude, frames):
    options = [*frames, "--prompt", PROMPT, "--base-url", claude.server.base_url]
    run(*options)
    rows = json.loads(run(*options, "--dry-run", "--repeat", 3, "--json").output)
    assert [row["times"] for row in rows] == [0, 2]
    assert LISTS["objects"][0]["text"] in rows[1]["said"][-1]
    assert len(claude.server.requests) == 2


def test_the_estimated_question_is_the_one_that_is_sent(claude, frames):
    options = [*frames, "--prompt", PROMPT, "--base-url", claude.server.base_url]
    run(*options)
    rows = json.loads(run(*options, "--dry-run", "--json").output)
    for place, row in enumerate(rows):
        words, pictures = claude.question(place)
        shown = [row["system"], *(one for one in row["said"] if not one.startswith("[picture"))]
        assert words == "\n".join(shown)
        assert row["pictures"] == len(pictures)
