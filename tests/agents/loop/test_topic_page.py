"""A coder begins a stage with the knowledge base's page of its topic, where there is one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import crates
import pytest
from team import turn_of, whose, words_of

from agents.loop.task import RunTask
from agents.loop.topic_page import topic_of
from agents.plan.scene import ScenePlan
from simworlds.llm.tokens import of_text

if TYPE_CHECKING:
    from run_sessions import Played


def task_of(*roles: str) -> RunTask:
    plan = crates.standing()
    plan["objects"] += [
        crates.an_object(f"Thing {n}", [1, 1, 1], [n, 0, 0], role=role) for n, role in enumerate(roles)
    ]
    return RunTask("", ScenePlan.model_validate(plan))


def test_the_topic_follows_from_the_stage_and_from_what_the_plan_moves() -> None:
    still, moved = task_of(), task_of("rigid", "keyframed", "rig")
    assert (topic_of("camera", still), topic_of("light", still)) == ("camera", "lights")
    assert topic_of("deformation_setup", still) == topic_of("motion", task_of("cloth")) == ""
    assert (topic_of("deformation_setup", moved), topic_of("motion", moved)) == ("armatures", "keyframes")
    assert topic_of("modeling", RunTask("", edit=True)) == "modeling"
    assert topic_of("motion", RunTask("", edit=True)) == topic_of("render", still) == ""


def first_requests(played: Played, stage: str) -> list[dict[str, Any]]:
    return [one for one in played.requests if whose(one) == ("coder", stage) and not turn_of(one)]


@pytest.mark.blender
def test_the_coder_begins_with_the_page_of_its_stage_where_there_is_one(mended: Played) -> None:
    kinds: dict[str, str] = {}
    for stage, topic in (("modeling", "modeling"), ("camera", "camera"), ("light", "lights")):
        (answered,) = mended.of("tool.answered", role="runner", stage=stage, name="blender_docs")
        page, kind = answered["content"][0]["text"], answered["data"]["kind"]
        told = words_of(first_requests(mended, stage)[0])
        assert (f'blender_docs on "{topic}":\n\n{page}' in told) == (kind == "page")
        assert ("blender_docs on" in told) == (kind == "page")
        assert of_text(page) <= 900, "counted on the safe side"
        kinds[stage] = kind
    assert kinds["modeling"] == "page"
    assert kinds["camera"] != "page", "the base of the tests has few pages"


@pytest.mark.blender
def test_the_page_is_told_once_a_stage(mended: Played) -> None:
    asked = [one for one in mended.requests if whose(one) == ("coder", "modeling")]
    assert words_of(asked[-1]).count('blender_docs on "modeling"') == 1
    assert len(mended.of("tool.called", role="runner", stage="light", name="blender_docs")) == 1, "a replan"


@pytest.mark.blender
def test_a_stage_whose_solver_has_a_sheet_has_no_page(falling: Played) -> None:
    assert not falling.of("tool.called", role="runner", stage="motion", name="blender_docs")
