"""``blender_plan_check``: what a model is told of the plan that it wrote."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from small_plan import small_plan

from agents.blender.checks import plan_check
from agents.plan.scene import ScenePlan

if TYPE_CHECKING:
    from mcp_types import CallToolResult


def said(answer: CallToolResult) -> str:
    assert answer.content[0].type == "text"
    return answer.content[0].text


def data(answer: CallToolResult) -> dict[str, Any]:
    assert answer.structured_content is not None
    return answer.structured_content


def test_summarises_a_valid_plan() -> None:
    answer = plan_check.answer({"plan": small_plan()})
    assert not answer.is_error
    assert said(answer).splitlines() == [
        "The plan 'A ball on a shelf' is valid.",
        "- Objects (3): ground: Floor; static: Shelf; rigid: Ball.",
        "- Relations (3): SupportedBy 2, LeftOf 1.",
        "- Phases (1) of Ball, in frames 1–48 (2 s at 24 fps).",
        "- Stages: modeling, texture, deformation_setup, motion, camera, light, render.",
        "- Checked from modeling on: C1–C6, G1–G3, V1, V2, W1–W3, R1–R13, R16, R17.",
        "- Checked from deformation_setup on: R15.",
        "- Checked from motion on: R18, R19, T1–T4, T6–T8.",
        "- Checked from camera on: W4, W6, R14.",
        "- Checked from light on: W5.",
    ]
    assert data(answer) == {"sound": True, "faults": [], "stages": list(_plan().stages), "doubts": []}


def _plan(**more: Any) -> ScenePlan:
    return ScenePlan.model_validate(small_plan() | more)


def test_rules_of_a_skipped_stage_apply_from_the_next_one() -> None:
    still = _plan(
        motion={"phases": []},
        render={"kind": "still"},
        frame_end=1,
        opt_out=["uv", "deformation_setup", "motion"],
    )
    lines = plan_check.summary(still).splitlines()
    assert "- Phases: none; nothing moves." in lines
    assert "- Checked from camera on: W4, W6, R14, R15, R18, R19, T1–T4, T6–T8." in lines


def test_each_fault_has_its_path_and_a_sentence() -> None:
    broken = small_plan()
    broken["relations"][1]["parents"] = ["Shelf/Bord"]
    broken["motion"]["phases"][0]["end"] = 60
    answer = plan_check.answer({"plan": broken})
    assert not answer.is_error, "the tool did what it was asked"
    faults = data(answer)["faults"]
    assert data(answer)["sound"] is False
    assert [fault["path"] for fault in faults] == ["relations[1].parents[0]", "motion.phases[0]"]
    assert said(answer).startswith("The plan has 2 faults:\n- `relations[1].parents[0]`: ")
    assert "no part 'Bord' (its parts: Board)" in said(answer)


def test_fields_that_are_missing_wrong_or_unknown_are_faults() -> None:
    answer = plan_check.answer({"plan": small_plan() | {"fps": 0, "mood": "calm", "render": {}}})
    assert {fault["path"] for fault in data(answer)["faults"]} == {"fps", "mood", "render.kind"}


def test_a_tolerance_that_would_be_loosened_is_a_fault() -> None:
    answer = plan_check.answer({"plan": small_plan() | {"tolerances": {"contact": 0.5}}})
    assert "cannot be loosened" in said(answer)


def test_what_is_wrong_in_many_places_is_one_line() -> None:
    objects = [{"name": f"Box {number}", "systems": ["nowhere"]} for number in range(40)]
    answer = plan_check.answer({"plan": small_plan() | {"objects": objects}})
    assert len(data(answer)["faults"]) >= 80
    (line,) = (line for line in said(answer).splitlines() if line.endswith("It is missing."))
    assert line.startswith("- `objects[0].dimensions, objects[0].position, objects[1].dimensions, ")


def test_many_faults_are_counted() -> None:
    answer = plan_check.answer({"plan": small_plan() | {f"odd_{number}": 1 for number in range(40)}})
    count = len(data(answer)["faults"])
    assert count >= 40
    assert said(answer).startswith(f"The plan has {count} faults:")
    assert said(answer).endswith(f"- … and {count - 20} more")


def test_a_plan_in_a_string_is_read_too() -> None:
    assert data(plan_check.answer({"plan": json.dumps(small_plan())}))["sound"] is True


@pytest.mark.parametrize("plan", ["", "{", "[1]", "null", "\ud800", "[" * 100_000, "x" * 3_000_000])
def test_rejects_what_is_not_a_plan(plan: str) -> None:
    answer = plan_check.answer({"plan": plan})
    assert data(answer)["sound"] is False
    assert len(data(answer)["faults"]) == 1
    assert len(said(answer)) < 500


@pytest.mark.parametrize("arguments", [{"plan": None}, {"plan": [1]}, {"plan": {}, "rules": ["C"]}])
def test_arguments_that_do_not_fit_are_refused(arguments: dict[str, Any]) -> None:
    answer = plan_check.answer(arguments)
    assert answer.is_error
    assert '{"plan": {…}}' in said(answer)


def test_names_that_cannot_be_sent_do_not_break_the_answer() -> None:
    answer = plan_check.answer({"plan": small_plan() | {"title": "\ud800"}})
    assert said(answer).encode()
