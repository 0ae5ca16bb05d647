"""Models and servers that do what they should not: the run goes on, or says clearly why it cannot."""

from __future__ import annotations

import json
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import crates
import pytest
import teams
from fake_messages_api import Reply, Status
from run_sessions import MESSAGES, answered, asked_of, go_on, seat, sit
from team import ABORT, DONE, Team, calls, last_words, reply, run, turn_of, use, whose, words_of

from agents.loop.errors import Unusable
from agents.loop.options import RunLimits
from agents.loop.running import run as run_module
from agents.roles.base import RoleContext
from simworlds.llm.context import ContextLimits as Kept

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from fake_messages_api import FakeMessagesAPI
    from run_sessions import Played

pytestmark = pytest.mark.blender


def of_role(played: Played, role: str, stage: str) -> list[dict[str, Any]]:
    return [request for request in played.requests if whose(request) == (role, stage)]


def outcomes(played: Played, stage: str, attempt: int = 1) -> list[dict[str, Any]]:
    return played.of("tool.answered", role="coder", stage=stage, attempt=attempt)


def said(row: dict[str, Any]) -> str:
    return row["content"][0]["text"]


# What a run survives


def test_a_run_with_all_these_troubles_ends_well(troubled: Played) -> None:
    assert troubled.ended.how == "done"
    assert (troubled.root / "scene.blend").exists()


def test_an_answer_without_json_is_sent_back(troubled: Played) -> None:
    second = next(one for one in of_role(troubled, "planner", "") if turn_of(one) == 1)
    assert "Your answer cannot be taken as it is" in last_words(second)
    assert "There is no JSON in the answer." in last_words(second)


def test_the_faults_of_a_plan_go_back_to_who_made_it(troubled: Played) -> None:
    third = next(one for one in of_role(troubled, "planner", "") if turn_of(one) == 2)
    assert "relations[0].child: There is no object 'Box'" in last_words(third)


def test_a_plan_for_another_stage_is_sent_back(troubled: Played) -> None:
    asked = [last_words(one) for one in of_role(troubled, "planner", "modeling")]
    assert any("this is the stage 'modeling', not 'uv'" in words for words in asked)


def test_a_retry_that_does_not_say_what_to_mend_is_sent_back(troubled: Played) -> None:
    asked = [last_words(one) for one in of_role(troubled, "planner", "modeling")]
    assert any("a retry must say what to fix" in words for words in asked)


def test_what_did_not_fit_is_not_kept_in_the_conversation(troubled: Played) -> None:
    last = [one for one in troubled.requests if whose(one)[0] == "planner"][-1]
    assert "cannot be taken as it is" not in words_of(last)


def test_an_unknown_tool_is_told_with_those_that_there_are(troubled: Played) -> None:
    unknown = outcomes(troubled, "modeling")[0]
    assert unknown["failed"]
    assert "There is no tool 'blender_paint'; there are" in said(unknown)
    assert "blender_execute" in said(unknown)


def test_arguments_that_do_not_fit_are_told(troubled: Played) -> None:
    wrong = outcomes(troubled, "modeling")[1]
    assert wrong["failed"]
    assert "code: " in said(wrong)
    assert "kode" in said(wrong)


def test_code_that_hangs_is_ended_and_blender_is_put_back(troubled: Played) -> None:
    hung = outcomes(troubled, "modeling")[2]
    assert hung["failed"]
    assert "A new Blender was started from checkpoint" in said(hung)
    assert hung["seconds"] < 30


def test_code_that_kills_blender_costs_only_itself(troubled: Played) -> None:
    died, built = outcomes(troubled, "modeling")[3:5]
    assert died["failed"]
    assert "A new Blender was started from checkpoint" in said(died)
    assert not built["failed"]


def test_an_answer_that_is_cut_off_goes_on_in_smaller_steps(troubled: Played) -> None:
    asked = {last_words(one) for one in of_role(troubled, "coder", "modeling")}
    assert sum("Go on in smaller steps" in words for words in asked) == 1


def test_who_calls_in_circles_is_told_then_stopped_and_the_stage_is_not_closed(troubled: Played) -> None:
    asked = [last_words(one) for one in of_role(troubled, "coder", "camera")]
    assert "This very call has now been made 3 times" in "".join(asked)
    ended = troubled.the("attempt.ended", stage="camera", attempt=1)
    assert (ended["ended"], ended["calls"]) == ("circles", 7)
    decided = troubled.the("decided", stage="camera", attempt=1)
    assert (decided["taken"], decided["why"]) == ("retry", "The coder did not finish (circles).")


def test_a_coder_who_declines_is_asked_once_more(troubled: Played) -> None:
    assert troubled.the("attempt.ended", stage="light", attempt=1)["ended"] == "refused"
    assert troubled.the("decided", stage="light", attempt=1)["taken"] == "retry"
    assert troubled.the("decided", stage="light", attempt=2)["taken"] == "advance"


def test_a_reviewer_who_declines_has_not_reviewed_and_that_blocks(troubled: Played) -> None:
    review = troubled.the("reviewed", stage="modeling", attempt=1)["review"]
    assert review["blocking"]
    assert "There is no review: The model (claude-opus-5-5) declined" in review["summary"]


def test_a_final_reviewer_who_declines_has_no_objection(troubled: Played) -> None:
    review = troubled.the("final.reviewed")["review"]
    assert review["verdict"] == "accept"
    assert "There is no final review" in review["summary"]


def test_outages_are_told_and_nothing_of_a_broken_answer_is_used(troubled: Played) -> None:
    told = [text for _, text in troubled.onlooker.heard if "asking again in" in text]
    assert len(told) > 12
    assert any("529" in text for text in told)
    assert any("429" in text for text in told)
    assert len(troubled.of("model.answered")) == len(troubled.of("model.asked"))
    assert len(troubled.requests) == len(troubled.of("model.asked")) + len(told)


# What ends it


def test_nonsense_without_end_fails_clearly_and_may_be_asked_for_again(
    api: FakeMessagesAPI, tmp_path: Path
) -> None:
    api.answer = Team(plan="No plan today.")
    played = sit(tmp_path / "run")
    assert (played.ended.how, len(api.requests)) == ("failed", 4)
    assert "The planner (claude-opus-5-5) gave no answer of the requested form, 4 times" in played.ended.why
    assert "There is no JSON in the answer." in played.ended.why
    assert "--role-model" in played.ended.why
    api.answer = Team(plan=teams.REFUSED)
    again = go_on(tmp_path / "run")
    assert (again.ended.how, len(api.requests)) == ("failed", 5)
    assert "declined" in again.ended.why
    api.answer = Team(decisions={"modeling": (ABORT,)})
    better = go_on(tmp_path / "run")
    assert (better.ended.how, better.taken) == ("aborted", [("modeling", "abort")])


@pytest.mark.whole  # one who declines is asked again, and retries that are used up end a run, in other tests
def test_a_coder_who_always_declines_uses_up_the_retries(api: FakeMessagesAPI, tmp_path: Path) -> None:
    api.answer = Team(coder={"modeling": (teams.REFUSED,)})
    played = sit(tmp_path / "run")
    assert played.ended.how == "aborted"
    assert {row["ended"] for row in played.of("attempt.ended")} == {"refused"}


@pytest.mark.parametrize(
    ("fault", "says"),
    [
        (Status(401), "Check the key"),
        pytest.param(
            Status(400, body='{"error": {"message": "prompt is too long"}}'),
            "too long",
            marks=pytest.mark.whole,
        ),
    ],
)
def test_a_server_that_takes_no_request_ends_the_sitting_at_once(
    api: FakeMessagesAPI, tmp_path: Path, fault: Status, says: str
) -> None:
    api.fail(MESSAGES, fault)
    played = sit(tmp_path / "run")
    assert (played.ended.how, len(api.requests)) == ("failed", 1)
    assert says in played.ended.why


@pytest.mark.usefixtures("api")
def test_without_a_key_no_run_is_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ANTHROPIC_API_KEY")
    with pytest.raises(Unusable, match="ANTHROPIC_API_KEY"):
        sit(tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_a_run_whose_key_is_gone_fails_and_goes_on_once_there_is_one(
    api: FakeMessagesAPI, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert sit(tmp_path / "run", seat(RunLimits(max_cost=0))).ended.how == "stopped"
    with monkeypatch.context() as patch:
        patch.delenv("ANTHROPIC_API_KEY")
        played = go_on(tmp_path / "run")
    assert played.ended.how == "failed"
    assert "ANTHROPIC_API_KEY" in played.ended.why
    api.answer = Team(decisions={"modeling": (ABORT,)})
    assert go_on(tmp_path / "run", seat(RunLimits(max_cost=50))).ended.how == "aborted"


# A context that grows too long

LOOKS = [use("blender_single_mesh_preview", object="Planks", frame=frame) for frame in range(1, 9)]


def _talkative() -> Iterator[Reply]:
    """Builds wrongly, looks and prints without end, mends it, goes on looking and printing."""
    for code in (crates.FLOATING, crates.LOWER):
        yield run(code)
        for look in LOOKS:
            yield calls(look, run(f"print('{look['id']} ' * 700)").content[0])
        yield reply(DONE)


@pytest.fixture(scope="module")
def crowded(home: Path, tmp_path_factory: pytest.TempPathFactory) -> Played:
    """A run whose conversations outgrow what is kept of them."""
    turns = _talkative()
    team = Team(coder={"modeling": (lambda params: next(turns),)}, decisions={"camera": (ABORT,)})
    with pytest.MonkeyPatch.context() as patch, answered(home, team) as api:
        patch.setattr(run_module, "RoleContext", partial(RoleContext, limits=Kept(budget=45_000, pictures=4)))
        played = sit(tmp_path_factory.mktemp("crowded") / "run")
        return replace(played, requests=asked_of(api))


def _pictures(request: dict[str, Any]) -> int:
    return json.dumps(request["messages"]).count('"type": "image"')


def test_old_pictures_and_outputs_give_way_to_references(crowded: Played) -> None:
    coder = of_role(crowded, "coder", "modeling")
    assert max(map(_pictures, crowded.requests)) <= 4
    shortened = "".join(map(words_of, coder))
    assert "A picture is left out to save space; call blender_single_mesh_preview" in shortened
    assert "more characters are left out to save space" in shortened
    assert "Earlier exchanges are left out to save space" in words_of(coder[-1])


def test_the_plan_and_open_findings_are_in_every_request(crowded: Played) -> None:
    coder = of_role(crowded, "coder", "modeling")
    tactic = '{"stage": "modeling", "goal": "Build modeling."}'
    for request in coder:
        assert "The scene plan:" in words_of(request)
        assert '"title": "A crate on a floor"' in words_of(request)
        assert tactic in words_of(request)
    mending = coder[-len(LOOKS) - 2 :]
    assert "The stage is not done" in words_of(mending[0])
    assert all("'Crate' floats 200.0 mm above 'Floor'" in words_of(one) for one in mending)


def test_the_planner_and_reviewers_have_the_plan_before_their_eyes(crowded: Played) -> None:
    others = [one for one in crowded.requests if whose(one)[0] != "coder" and whose(one) != ("planner", "")]
    assert all("A crate on a floor" in json.dumps(one["messages"]) for one in others)


def test_a_shortened_conversation_is_still_one_that_the_api_takes(crowded: Played) -> None:
    assert crowded.ended.how == "aborted"  # as its planner wants it in the end, and not for a request refused
    assert crowded.of("stage.closed", stage="modeling")
