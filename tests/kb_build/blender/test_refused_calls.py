"""From the outcomes of calls to what decides whether one is refused."""

from __future__ import annotations

from typing import Any

import pytest

from kb_build.blender.refused_calls import refusals

Outcome = dict[str, Any]


def outcome(kind: str, made: str, message: str = "", **more: Any) -> Outcome:
    return {"chosen": {"type": kind} if kind else {}, "made": made, "message": message, **more}


@pytest.mark.parametrize(
    ("outcomes", "expected"),
    [
        pytest.param(
            [outcome("A", "mesh", "no"), outcome("B", "mesh"), outcome("A", "curve", "no")],
            {"argument": "type", "values": ("A",)},
            id="a value",
        ),
        pytest.param(
            [outcome("A", "mesh", "no", given=["length"]), outcome("B", "mesh")],
            {"given": ("length",), "mode": "", "argument": "type", "values": ("A",)},
            id="a value without more arguments",
        ),
        pytest.param(
            [outcome("", "armature", "no", given=[], mode="EDIT")],
            {"given": (), "mode": "EDIT"},
            id="the mode",
        ),
        pytest.param(
            [
                outcome("A", "lamp", "no"),
                outcome("B", "lamp", "no"),
                outcome("A", "mesh"),
                outcome("B", "mesh"),
            ],
            {"by": ("lamp",), "taken_by": ("mesh",)},
            id="what it is made of",
        ),
        pytest.param(
            [outcome("", "action"), outcome("", "action", "no", again="any")],
            {"again": "any"},
            id="a second call",
        ),
        pytest.param(
            [outcome("A", "mesh"), outcome("A", "mesh", "no", again="same"), outcome("B", "mesh")],
            {"again": "same", "argument": "type", "values": ("A",)},
            id="a second call with one value",
        ),
        pytest.param([outcome("", "tree", "no")], {}, id="nothing that is known"),
    ],
)
def test_one_thing_decides(outcomes: list[Outcome], expected: Outcome) -> None:
    assert refusals(outcomes) == [{"message": "no", **expected}]


def test_where_value_and_thing_decide_values_with_the_same_takers_stand_together() -> None:
    outcomes = [outcome(kind, "lamp", "returned None") for kind in "ABC"]
    outcomes += [
        outcome("A", "mesh"),
        outcome("B", "mesh"),
        outcome("C", "mesh", "returned None"),
        outcome("C", "curve"),
    ]
    assert refusals(outcomes) == [
        {"message": "", "argument": "type", "values": ("A", "B"), "by": ("lamp",), "taken_by": ("mesh",)},
        {"message": "", "argument": "type", "values": ("C",), "by": ("lamp", "mesh"), "taken_by": ("curve",)},
    ]


def test_none_without_a_reason_says_nothing() -> None:
    assert not refusals([outcome("", "image", "returned None")])
    assert not refusals([outcome("A", "mesh"), outcome("B", "mesh")])
