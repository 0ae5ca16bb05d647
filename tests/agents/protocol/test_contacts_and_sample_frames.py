"""Declared contacts, sample frames, and poses, from facts alone."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scenes import a_plan

from agents.protocol.facts import SceneFacts
from agents.protocol.judging.declared_contacts import allowed_crossings, declared_contacts
from agents.protocol.judging.geometry.poses import anchor
from agents.protocol.judging.geometry.vectors import (
    angle_between,
    axes_of_euler,
    place_and_axes,
    rotation_between,
)
from agents.protocol.judging.sample_frames import moves, planned_pose_frame, relation_frames, sample_frames
from agents.protocol.judging.sizes import smallest_diagonal
from agents.protocol.rule import RuleContext
from agents.protocol.structure import SceneStructure
from agents.protocol.tolerances import TOLERANCES

UNIT = tuple(float(value) for value in np.eye(4).flatten())


def an_object(name: str, *, size: float = 1.0, **more: Any) -> dict[str, Any]:
    box = {"low": (0, 0, 0), "high": (size, size, size)}
    return {"name": name, "type": "MESH", "matrix": UNIT, "surface": True, "box": box, **more}


def a_subject(*relations: dict[str, Any], tables: dict[str, Any] | None = None, **cup: Any) -> RuleContext:
    """A table of a top and a leg, and a cup of 0.1 m."""
    empty = {"type": "EMPTY", "matrix": UNIT, "is_root": True}
    facts = SceneFacts.model_validate(
        {
            "version": "5.1",
            "scene": "Scene",
            "frame": 5,
            "frame_start": 1,
            "frame_end": 20,
            "fps": 24,
            "collections": [
                {"name": "Table", "role": "object", "objects": ("Table root", "Top", "Leg")},
                {"name": "Cup", "role": "object", "objects": ("Cup root", "Body")},
            ],
            "objects": [
                {"name": "Table root", **empty, **(tables or {})},
                an_object("Top", parent="Table root"),
                an_object("Leg", parent="Table root"),
                {"name": "Cup root", **empty},
                an_object("Body", size=0.1, parent="Cup root", **cup),
            ],
        }
    )
    return RuleContext(facts, SceneStructure(facts), TOLERANCES, a_plan(*relations) if relations else None)


RESTS = {"kind": "SupportedBy", "child": "Cup", "parents": ["Table"]}


def test_tags_and_the_plan_declare_contacts_each_pair_once() -> None:
    context = a_subject(RESTS, tables={"contact_with": ("Leg", "Cup")}, contact_with=("Top", "Table root"))
    found = [(one.a, one.b) for one in declared_contacts(context)]
    assert found == [
        ("Table root", "Leg"),
        ("Table root", "Cup"),
        ("Body", "Top"),
        ("Body", "Table root"),
        ("Cup", "Table"),
    ]
    assert [one.by for one in declared_contacts(context)][-1] == "relations[0] (SupportedBy)"


def test_a_contact_that_both_sides_tell_is_one() -> None:
    context = a_subject(tables={"contact_with": ("Body",)}, contact_with=("Table root",))
    assert [(one.a, one.b) for one in declared_contacts(context)] == [("Table root", "Body")]


@pytest.mark.parametrize(
    ("relation", "pairs"),
    [
        (RESTS, {("Body", "Top"), ("Body", "Leg")}),
        ({"kind": "Inside", "content": "Cup", "container": "Table/Top"}, {("Body", "Top")}),
        ({"kind": "EmbeddedIn", "part": "Cup", "host": "Table/Leg", "depth": 0.01}, {("Body", "Leg")}),
        ({"kind": "NextTo", "a": "Cup", "b": "Table"}, set()),
    ],
)
def test_what_touches_or_is_in_something_may_cross_it(
    relation: dict[str, Any], pairs: set[tuple[str, str]]
) -> None:
    assert allowed_crossings(a_subject(relation)) == {frozenset(pair) for pair in pairs}


def test_the_smaller_of_two_groups_counts_as_a_whole() -> None:
    context = a_subject()
    assert smallest_diagonal(context, ("Top", "Leg"), ("Body",)) == pytest.approx(0.1 * math.sqrt(3))
    assert smallest_diagonal(context, ()) == 0


def test_what_stands_still_is_looked_at_now() -> None:
    assert sample_frames(a_subject(), "Cup", "Table") == (None,)
    assert planned_pose_frame(a_subject(), "Cup") is None


@pytest.mark.parametrize(
    "mover",
    [
        {"keys": {"location": 2}},
        {"animated_shape_keys": True},
        {"drivers": 1},
        {"modifiers": [{"name": "Cloth", "type": "CLOTH"}]},
        {"modifiers": [{"name": "Fluid", "type": "FLUID_DOMAIN"}]},
        {"rigid_body": {"active": True}},
        {"constraints": [{"type": "FOLLOW_PATH", "target": "Table root"}]},
    ],
)
def test_what_moves_is_looked_at_first_and_last(mover: dict[str, Any]) -> None:
    context = a_subject(**mover)
    assert sample_frames(context, "Table", "Cup") == (1, 20)
    assert planned_pose_frame(context, "Cup") == 1
    assert not moves(context, "Table")


@pytest.mark.parametrize(
    "still",
    [
        {"rigid_body": {"active": False}},
        {"modifiers": [{"name": "Cloth", "type": "CLOTH", "on": False}]},
        {"modifiers": [{"name": "Hole", "type": "BOOLEAN", "target": "Leg"}]},
        {"constraints": [{"type": "CHILD_OF", "target": "Table root"}]},
    ],
)
def test_what_only_could_move_stands_still(still: dict[str, Any]) -> None:
    assert sample_frames(a_subject(**still), "Cup") == (None,)


@pytest.mark.parametrize(
    "link",
    [
        {"constraints": [{"type": "CHILD_OF", "target": "Table root"}]},
        {"modifiers": [{"name": "Hook", "type": "HOOK", "target": "Top"}]},
    ],
)
def test_what_follows_something_that_moves_does_too(link: dict[str, Any]) -> None:
    assert moves(a_subject(tables={"keys": {"location": 2}}, **link), "Cup")


def test_objects_that_follow_each_other_come_to_an_end() -> None:
    circle = {"constraints": [{"type": "CHILD_OF", "target": "Body"}]}
    context = a_subject(tables=circle, constraints=[{"type": "CHILD_OF", "target": "Table root"}])
    assert not moves(context, "Cup")


@pytest.mark.parametrize(
    ("node", "name"),
    [("Cup", "Cup root"), ("Table/Leg", "Leg"), ("Top", "Top"), ("Table/Lid", None), ("Saucer", None)],
)
def test_a_node_has_the_transform_of_its_root_or_part(node: str, name: str | None) -> None:
    assert anchor(a_subject(), node) == name


def test_angles_are_in_degrees_and_nothing_has_no_direction() -> None:
    assert angle_between(np.array([1.0, 0, 0]), np.array([1.0, 1, 0])) == pytest.approx(45)
    assert angle_between(np.array([1.0, 0, 0]), np.zeros(3)) == 180


def test_euler_angles_are_blenders() -> None:
    # X by 90°, then Z by 90°: Y goes up, X to the back, Z to the right.
    assert axes_of_euler((90, 0, 90)) == pytest.approx(np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]), abs=1e-12)


@pytest.mark.parametrize("degrees", [0.0, 5.0, 179.0])
def test_turning_is_measured_by_the_shortest_way(degrees: float) -> None:
    assert rotation_between(
        axes_of_euler((20, 30, 40)), axes_of_euler((20, 30, 40 + degrees))
    ) == pytest.approx(degrees, abs=1e-5)


def test_a_matrix_is_a_place_and_unit_axes() -> None:
    place, axes = place_and_axes((0, -2, 0, 7, 3, 0, 0, 8, 0, 0, 0, 9, 0, 0, 0, 1))
    assert place.tolist() == [7, 8, 9]
    assert axes.tolist() == [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]


FALLS = {"rigid_body": {"active": True}}


@pytest.mark.parametrize(
    ("when", "cup", "role", "frames"),
    [
        ("start_or_end", FALLS, "rigid", (1, 20)),
        ("always", FALLS, "rigid", (1, 20)),
        ("end", FALLS, "rigid", (20,)),
        ("end", {}, "rigid", ()),  # it is to move, but does not yet
        ("end", {}, "static", (None,)),
        ("start_or_end", {}, "rigid", (None,)),
    ],
)
def test_a_relation_is_checked_when_it_is_to_hold(
    when: str, cup: dict[str, Any], role: str, frames: tuple[int | None, ...]
) -> None:
    context = a_subject({**RESTS, "when": when}, **cup)
    objects = [
        one.model_copy(update={"role": role if one.name == "Cup" else "static"})
        for one in context.planned.objects
    ]
    plan = context.planned.model_copy(update={"objects": tuple(objects)})
    context = RuleContext(context.facts, context.structure, TOLERANCES, plan)
    assert relation_frames(context, plan.relations[0]) == frames


def test_what_is_not_baked_is_checked_at_the_first_frame_while_no_rule_follows_motion() -> None:
    context = a_subject(RESTS, **FALLS)
    early = RuleContext(context.facts, context.structure, TOLERANCES, context.plan, judges_end=False)
    assert sample_frames(early, "Cup") == (1,)


def test_what_is_embedded_touches_its_host() -> None:
    embedded = {"kind": "EmbeddedIn", "part": "Cup", "host": "Table", "depth": 0.01}
    assert [(one.a, one.b) for one in declared_contacts(a_subject(embedded))] == [("Cup", "Table")]
