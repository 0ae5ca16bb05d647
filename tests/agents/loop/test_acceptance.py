"""Acceptance is answered line by line: what fails keeps the stage open, what comes later is asked later."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from bs4 import BeautifulSoup
from team import ACCEPT, FINE, Team, last_words, reply, turn_of, whose

from agents.loop.answer_source import TRANSCRIPTS, transcripts
from agents.loop.review.acceptance import AcceptanceRecord
from agents.plan.acceptance import AcceptanceAnswer, faults_of_answers
from agents.plan.tactical import FinalReview, Review, TacticalPlan
from agents.views.report.page import write_report
from simworlds.llm.errors import Misfit
from simworlds.llm.records.transcript import read_folder
from simworlds.llm.structured import fits, read

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from fake_messages_api import Reply
    from run_sessions import Played
    from team import Params

STANDS, LIT, FRAMED = (
    "The crate stands on the floor.",
    "The crate has a lit and a dark side.",
    "All is in view.",
)


def answer(line: int, verdict: str = "holds", **more: Any) -> dict[str, Any]:
    source = {} if verdict == "later" else {"source": "picture"}
    return {"line": line, "verdict": verdict, "evidence": "The front view.", **source, **more}


def answers(*given: dict[str, Any]) -> tuple[AcceptanceAnswer, ...]:
    return tuple(AcceptanceAnswer.model_validate(one) for one in given)


# The form


def test_every_line_is_answered_once() -> None:
    assert faults_of_answers(answers(answer(2), answer(1)), 2) == []
    assert faults_of_answers(answers(answer(2)), 3) == ["acceptance: not answered: 1, 3."]
    assert faults_of_answers(answers(answer(1), answer(1)), 1) == ["acceptance: line 1 is answered 2 times."]
    assert faults_of_answers(answers(answer(1), answer(2)), 1) == [
        "acceptance: there is no line 2; there are 1."
    ]


def test_a_line_is_left_only_to_a_stage_that_is_still_to_come() -> None:
    left = answers(answer(1, "later", stage="light"))
    assert faults_of_answers(left, 1, "modeling") == []
    for stage in ("light", "render"):
        (fault,) = faults_of_answers(left, 1, stage)  # type: ignore[arg-type]
        assert f"cannot be left to light, which is not after {stage}" in fault


@pytest.mark.parametrize(
    ("given", "why"),
    [
        ({"line": 1, "verdict": "holds", "evidence": "Looks good."}, "source"),
        ({"line": 1, "verdict": "holds", "source": "picture", "evidence": ""}, "evidence"),
        ({"line": 1, "verdict": "later", "evidence": "There is no light yet."}, "stage"),
        ({"line": 0, "verdict": "holds", "source": "number", "evidence": "0.5 m"}, "line"),
    ],
)
def test_an_answer_has_its_evidence(given: dict[str, Any], why: str) -> None:
    with pytest.raises(Misfit, match=why):
        read(json.dumps(given), fits(AcceptanceAnswer))


@pytest.mark.parametrize("name", transcripts())
def test_the_reviewers_of_the_demos_answer_every_line(name: str) -> None:
    record = AcceptanceRecord()
    tactics: dict[str, TacticalPlan] = {}
    last: dict[str, Review] = {}
    judged = finals = 0
    for turn in read_folder(TRANSCRIPTS / name):
        text = turn.turn.text
        if turn.role == "planner" and '"goal"' in text:
            for stage, review in last.items():
                record.close(tactics[stage], review)
            last.clear()
            tactics[turn.stage] = record.with_lines_due(read(text, fits(TacticalPlan)))
        elif turn.role == "reviewer" and '"judgements"' in text:
            tactic, last[turn.stage] = tactics[turn.stage], read(text, fits(Review))
            lines = len(tactic.acceptance)
            assert faults_of_answers(last[turn.stage].acceptance, lines, tactic.stage) == []
            judged += lines
        elif turn.role == "final_reviewer":
            for stage, review in last.items():
                record.close(tactics[stage], review)
            review = read(text, fits(FinalReview))
            assert faults_of_answers(review.acceptance, len(record.lines)) == []
            finals += len(record.lines)
    assert judged >= finals > 3


# A run


def _reviews(*acceptance: Sequence[dict[str, Any]]) -> Callable[[Params], Reply]:
    return lambda params: reply(FINE | {"acceptance": acceptance[turn_of(params)]})


@pytest.fixture(scope="module")
def answered(play: Callable[..., Played]) -> Played:
    """A line fails at first, another is left to the light; a reviewer and the final one forget lines at first."""
    later = answer(2, "later", stage="light")
    return play(
        Team(
            tactics={
                "modeling": ({"stage": "modeling", "goal": "Build it.", "acceptance": [STANDS, LIT]},),
                "camera": ({"stage": "camera", "goal": "Frame it.", "acceptance": [FRAMED]},),
            },
            reviewer={
                "modeling": (_reviews([answer(1, "fails"), later], [answer(1), later]),),
                "camera": (_reviews([], [answer(1)]),),
                "light": (_reviews([answer(1)]),),
            },
            final=(ACCEPT, ACCEPT | {"acceptance": [answer(1), answer(2, "fails"), answer(3)]}),
        )
    )


def of_role(played: Played, role: str, stage: str) -> list[str]:
    return [last_words(request) for request in played.requests if whose(request) == (role, stage)]


@pytest.mark.blender
def test_a_line_that_fails_keeps_the_stage_open(answered: Played) -> None:
    assert answered.ended.how == "done"
    first, second = answered.of("decided", stage="modeling")
    assert (first["taken"], first["why"]) == (
        "retry",
        "The review does not block, but a line of acceptance fails.",
    )
    assert second["taken"] == "advance"
    again = next(
        words for words in of_role(answered, "coder", "modeling") if "The stage is not done" in words
    )
    assert f"Acceptance FAILS: {STANDS} (The front view.)" in again


@pytest.mark.blender
def test_a_line_that_is_left_for_later_is_asked_there(answered: Played) -> None:
    tactic = answered.the("tactic", stage="light")
    assert tactic["plan"]["acceptance"] == [LIT]
    assert f"1. {LIT}" in of_role(answered, "reviewer", "light")[0]
    assert LIT in of_role(answered, "coder", "light")[0]
    assert LIT not in of_role(answered, "reviewer", "camera")[0]
    told = next(words for words in of_role(answered, "planner", "camera") if "is closed" in words)
    assert f"left to the stage light: {LIT}" in told


@pytest.mark.blender
def test_a_review_without_all_answers_is_sent_back(answered: Played) -> None:
    asked = of_role(answered, "reviewer", "camera")
    assert "acceptance: not answered: 1." in asked[-1]
    assert "acceptance: not answered: 1, 2, 3." in of_role(answered, "final_reviewer", "render")[-1]


@pytest.mark.blender
def test_the_final_reviewer_answers_all_lines_and_reads_what_was_said_of_them(answered: Played) -> None:
    asked = of_role(answered, "final_reviewer", "render")[0]
    assert f"1. {STANDS} (stage modeling: holds, The front view.)" in asked
    assert f"2. {LIT} (stage light: holds, The front view.)" in asked
    final = answered.the("final.reviewed")
    assert final["lines"] == [STANDS, LIT, FRAMED]
    assert [one["verdict"] for one in final["review"]["acceptance"]] == ["holds", "fails", "holds"]


@pytest.mark.blender
def test_the_report_shows_every_answer(answered: Played, tmp_path: Path) -> None:
    page = BeautifulSoup(write_report(answered.root).read_bytes(), "lxml")
    rows = [(" ".join(row.get_text(" ").split()), row["class"]) for row in page.select(".judged li")]
    assert (f"{STANDS} By picture: The front view.", ["no"]) in rows
    assert (f"{LIT} judged in Light The front view.", ["later"]) in rows
    final = page.select_one(".verdict .judged")
    assert final
    assert [row["class"] for row in final.select("li")] == [["yes"], ["no"], ["yes"]]
