"""What the loop does by the paper's algorithm: who decides, what is sent back, what is undone, when it ends."""

from __future__ import annotations

from typing import TYPE_CHECKING

import crates
import pytest
import teams
from run_sessions import scenes
from team import ABORT, DONE, FINE, REPLAN, RETRY, Team, call, last_words, run, turn_of, whose, words_of

from agents.loop.review.verdicts import VerifierVerdict, still_open
from agents.loop.review.withdrawals import as_soft
from agents.plan.tactical import Review, Withdrawal
from agents.protocol.findings import Finding

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from run_sessions import Played

    from agents.protocol.findings import Outcome

pytestmark = pytest.mark.blender


def of_role(played: Played, role: str, stage: str) -> list[dict[str, object]]:
    return [request for request in played.requests if whose(request) == (role, stage)]


def test_stages_that_are_opted_out_are_skipped_and_the_scene_is_carried_on(mended: Played) -> None:
    assert [row["stage"] for row in mended.of("stage.skipped")] == list(crates.OUTSIDE)
    assert not [request for request in mended.requests if whose(request)[1] in crates.OUTSIDE]
    (row,) = mended.of("tool.answered", role="runner", stage="camera", attempt=1, n=1)
    assert "Crate" in row["content"][0]["text"]


def test_a_contact_that_does_not_hold_keeps_the_stage_open(mended: Played) -> None:
    first, second = mended.of("decided", stage="modeling")
    assert (first["decision"]["transition"], first["taken"]) == ("retry", "retry")
    assert first["why"] == "The verifier has 2 hard findings."
    assert second["taken"] == "advance"
    verified = mended.the("verified", stage="modeling", attempt=1)
    assert not verified["ok"]
    rules = {one["rule"] for one in verified["findings"] if one["severity"] == "hard"}
    assert "R5" in rules
    assert "V1" not in rules, "that it does not touch is told by how far it floats"


def test_who_is_sent_back_hears_why_and_what_was_found(mended: Played) -> None:
    again = words_of(of_role(mended, "coder", "modeling")[-1])
    assert "The planner says: Mend what the verifier finds." in again
    assert "'Crate' floats 200.0 mm above 'Floor'" in again


def test_a_blocking_review_keeps_the_stage_open(mended: Played) -> None:
    first, second = mended.of("decided", stage="camera")
    assert (first["taken"], first["why"]) == ("retry", "The review blocks.")
    assert second["taken"] == "advance"
    assert "The crate looks like a sphere." in words_of(of_role(mended, "coder", "camera")[-1])


def test_a_stage_that_nothing_keeps_open_is_closed_without_asking_the_planner(mended: Played) -> None:
    asked = [last_words(one) for one in of_role(mended, "planner", "camera")]
    decisions = [words for words in asked if "Attempt" in words]
    assert len(decisions) == len(mended.of("decided", stage="camera")) - 1
    assert (
        "Attempt 1 of the stage camera is over, and the stage is not done. The review blocks." in decisions[0]
    )
    assert all("decision" not in row for row in mended.of("decided", taken="advance"))


def test_the_planner_hears_with_the_next_question_how_a_stage_was_closed(mended: Played) -> None:
    (begins, *later) = of_role(mended, "planner", "camera")
    words = last_words(begins)
    assert words.index("The stage modeling is closed") < words.index("The stage camera begins.")
    assert "It looks right." in words
    assert not any("is closed" in last_words(one) for one in later), "told once"


def test_a_decision_to_plan_anew_may_bring_the_plan(play: Callable[..., Played]) -> None:
    plan = {"stage": "modeling", "goal": "Build it otherwise."}
    replans = [REPLAN | {"tactic": tactic} for tactic in (plan, plan | {"stage": "uv"}, {"goal": 3})]
    played = play(Team(decisions={"modeling": (*replans, ABORT)}))
    assert [row["taken"] for row in played.of("decided")] == ["replan"] * 3 + ["abort"]
    assert played.ended.how == "aborted"
    assert "This cannot be built." in played.ended.why
    asked = [last_words(one) for one in of_role(played, "planner", "modeling")]
    begun = [words for words in asked if "The stage modeling begins." in words]
    assert ["The last plan did not do" in words for words in begun] == [False, True, True]
    assert not any("cannot be taken as it is" in words for words in asked), (
        "without its plan, the decision fits"
    )
    goals = [row["plan"]["goal"] for row in played.of("tactic")]
    assert goals == ["Build modeling.", "Build it otherwise.", "Build modeling.", "Build modeling."]


def test_the_coder_keeps_its_session_over_retries_and_has_a_fresh_one_in_each_stage(mended: Played) -> None:
    turns = [turn_of(request) for request in of_role(mended, "coder", "modeling")]
    assert turns == [0, 1, 2, 3]
    assert turn_of(of_role(mended, "coder", "camera")[0]) == 0


def test_the_reviewer_has_one_session_a_stage_and_the_planner_one_for_the_run(mended: Played) -> None:
    assert [turn_of(request) for request in of_role(mended, "reviewer", "camera")] == [0, 1]
    planner = [request for request in mended.requests if whose(request)[0] == "planner"]
    assert [turn_of(request) for request in planner] == list(range(len(planner)))


def test_the_reviewer_cannot_call_what_changes_the_scene(mended: Played) -> None:
    offered = {tool["name"] for tool in of_role(mended, "reviewer", "modeling")[0]["tools"]}  # type: ignore[index]
    assert "blender_scene_state" in offered
    assert not offered & {"blender_execute", "blender_load", "blender_bake", "blender_docs", "blender_verify"}
    refused = words_of(of_role(mended, "reviewer", "modeling")[1])
    assert "blender_execute is not available to your role" in refused
    assert not mended.of("tool.called", role="reviewer")


def test_a_new_plan_begins_with_the_scene_as_it_was_before_the_stage(mended: Played, tmp_path: Path) -> None:
    assert mended.taken[-2:] == [("light", "replan"), ("light", "advance")]
    assert mended.the("rolled.back", stage="light")["to"] == "camera"
    assert [row["attempt"] for row in mended.of("tactic", stage="light")] == [1, 2]
    states = mended.of("tool.answered", role="runner", stage="light", name="blender_scene_state")
    before, after = (
        next(row["content"][0]["text"] for row in states if row["attempt"] == attempt) for attempt in (1, 2)
    )
    assert "Sun" not in before
    assert "Sun" not in after
    assert "The last plan did not do: This plan leads nowhere." in words_of(mended.requests[-1]) or any(
        "The last plan did not do: This plan leads nowhere." in words_of(request)
        for request in of_role(mended, "planner", "light")
    )


def test_the_result_is_mended_once_from_the_last_checkpoint_and_rendered_again(mended: Played) -> None:
    (load,) = mended.of("tool.answered", role="runner", stage="render", name="blender_load")
    assert not load["failed"]
    assert "Put the sun higher." in words_of(of_role(mended, "coder", "render")[0])
    assert [row["round"] for row in mended.of("rendered")] == [1, 2]
    assert [row["round"] for row in mended.of("final.reviewed")] == [1, 2]
    first, second = of_role(mended, "final_reviewer", "render")
    told = "This is the result after what you asked for was mended."
    assert told not in words_of(first)
    assert told in words_of(second), "it sees what came of its instructions, and no round follows"


def test_a_fix_that_breaks_a_hard_rule_is_undone(play: Callable[..., Played], tmp_path: Path) -> None:
    played = play(teams.spoiled())
    assert played.ended.how == "done"
    assert not played.the("verified", stage="render")["ok"]
    assert played.the("rolled.back", stage="render", attempt=2)["to"] == "light"
    assert len(played.of("rendered")) == 1
    light, scene = scenes(tmp_path, played.root / "checkpoints" / "light.blend", played.root / "scene.blend")
    assert scene == light


def test_motion_that_is_faked_by_keyframes_is_stopped(falling: Played) -> None:
    first, second = falling.of("verified", stage="motion")
    assert "R15" in {one["rule"] for one in first["findings"] if one["severity"] == "hard"}
    assert second["ok"]
    assert [taken for stage, taken in falling.taken if stage == "motion"] == ["retry", "advance"]


MORE_BODIES = """
for number in range(13):
    bpy.ops.mesh.primitive_cube_add(size=0.2, location=(number - 6, 9, 9))
    bpy.ops.rigidbody.object_add()
"""


def test_a_trial_tells_of_what_the_plan_moves_before_of_what_moves_more(
    play: Callable[..., Played],
) -> None:
    trial = call("blender_trial", frames=16, pictures=False)
    team = Team(
        plan=crates.falling(),
        coder={
            "modeling": (run(crates.HIGH), DONE),
            "motion": (run(crates.BODIES + MORE_BODIES), trial, DONE),
        },
        decisions={"motion": (ABORT,)},
    )
    (tried,) = [row for row in play(team).of("tool.answered") if row["name"] == "blender_trial"]
    assert (tried["data"]["actors"][0]["name"], tried["data"]["others"]["count"]) == ("Planks", 2)


def test_what_the_plan_states_wrongly_is_withdrawn_once_mending_was_tried(
    play: Callable[..., Played],
) -> None:
    """The rules go on to measure it, and nothing is kept open by it any more."""
    withdraw = {
        "transition": "withdraw",
        "reason": "It hangs there as it was asked to.",
        "withdraw": [{"rule": "R5", "objects": ["Crate"]}, {"rule": "R3", "objects": ["Crate"]}],
    }
    team = Team(
        coder={
            "modeling": (run(crates.FLOATING), DONE),
            "camera": (run(crates.CAMERA), call("blender_verify"), DONE),
        },
        decisions={"modeling": (RETRY, withdraw), "camera": (ABORT,)},
        reviewer={"modeling": (FINE,)},
    )
    played = play(team)
    assert played.taken[:2] == [("modeling", "retry"), ("modeling", "advance")]
    (row,) = played.of("withdrew")
    assert row["decision"]["reason"] == withdraw["reason"]
    (later,) = played.of("verified", stage="camera", attempt=1)
    assert later["ok"], later["findings"]
    assert {one["rule"]: one["severity"] for one in later["findings"]}["R5"] == "soft"
    heard = [words_of(request) for request in played.requests if whose(request) == ("planner", "camera")]
    assert any(
        "Withdrawn by the planner, and not counted, though told as hard below: R3 " in words
        for words in heard
    )
    *_, told = [request for request in played.requests if whose(request) == ("coder", "camera")]
    assert (
        "find it broken: R5 Crate; R3 Crate. It is measured all the same, and not to be mended."
        in words_of(told)
    )
    assert (
        "Withdrawn by the planner, and not counted, though told as hard below: "
        "R3 Crate, Crate root; R5 Crate, Floor (no other is hard)." in last_words(told)
    )


@pytest.mark.parametrize(
    ("outcomes", "why"),
    [
        (("broken",), "The verifier has 1 hard finding."),
        (("undecided",), "The verifier could not decide 1 hard rule."),
        (("broken", "broken", "error"), "The verifier has 2 hard findings and could not decide 1 hard rule."),
    ],
)
def test_what_could_not_be_decided_is_not_called_a_finding(outcomes: tuple[Outcome, ...], why: str) -> None:
    found = tuple(Finding("R3", "hard", ("Gust",), "", outcome=outcome) for outcome in outcomes)
    review = Review(judgements=(), blocking=False, summary="Fine.")
    assert still_open("done", VerifierVerdict("", found), review) == why


def test_a_part_of_what_a_rule_finds_is_withdrawn() -> None:
    waits, rests = (
        Finding("T7", "hard", ("Bucket",), f"motion.phases[{at}] ('{name}'): it moves.")
        for at, name in enumerate(("bucket waits", "bucket rests"))
    )
    one = Withdrawal(rule="T7", objects=("Bucket",), says="'bucket waits'")
    findings, told = as_soft([waits, rests, waits], [one])
    assert [finding.severity for finding in findings] == ["soft", "hard", "soft"]
    assert (
        told
        == "Withdrawn by the planner, and not counted, though told as hard below: T7 Bucket (1 hard beside it)."
    )
    assert str(one) == "T7 Bucket ('bucket waits')"


def test_when_retries_are_used_up_the_run_is_given_up(play: Callable[..., Played]) -> None:
    team = Team(coder={"modeling": (run(crates.FLOATING), DONE)}, decisions={"modeling": (RETRY,)})
    played = play(team)
    assert [taken for _, taken in played.taken] == ["retry"] * 10 + ["abort"]
    assert played.ended.how == "aborted"
    assert "There is no retry left." in played.ended.why
    assert (played.ended.file, played.ended.shown) == (None, None)
    lefts = [words_of(request) for request in played.requests if whose(request) == ("planner", "modeling")]
    assert "10 retries and 5 replans are left" in lefts[1]
    assert "0 retries and 5 replans are left" in lefts[-1]


@pytest.mark.whole
def test_when_replans_are_used_up_the_last_checkpoint_stands(
    play: Callable[..., Played], tmp_path: Path
) -> None:
    builds = [turn for _ in range(6) for turn in (run(crates.LIGHT), DONE)]
    team = Team(coder={"light": builds}, decisions={"light": (REPLAN,)})
    played = play(team)
    assert [taken for stage, taken in played.taken if stage == "light"] == ["replan"] * 5 + ["abort"]
    assert played.ended.how == "aborted"
    assert played.ended.file == played.root / "scene.blend"
    (kept,) = scenes(tmp_path, played.ended.file)
    assert "Object Camera" in kept
    assert "Object Sun" not in kept
    assert played.rows[-1]["file"] == "scene.blend"
