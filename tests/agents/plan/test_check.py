"""A plan is checked for itself: what is wrong is named by its field, in a sentence."""

from __future__ import annotations

import copy
import itertools
import json
from typing import Any

import pytest

from agents.plan.check import read_plan
from agents.plan.faults import Fault, grouped

CHAIR = {"dimensions": [0.5, 0.5, 0.9], "position": [0, 0, 0]}


def a_plan() -> dict[str, Any]:
    """A table with a bowl of fruit, four chairs around it, and a ball that falls into the bowl."""
    chairs = [{"name": f"Chair {n}", "systems": ["furniture"], **CHAIR} for n in range(4)]
    return {
        "title": "A laid table",
        "frame_start": 1,
        "frame_end": 96,
        "systems": ["ground", "furniture"],
        "objects": [
            {
                "name": "Floor",
                "systems": ["ground"],
                "dimensions": [6, 6, 0.1],
                "position": [0, 0, 0],
                "role": "ground",
            },
            {
                "name": "Table",
                "systems": ["furniture"],
                "dimensions": [1.6, 0.9, 0.75],
                "position": [0, 0, 0],
                "parts": ["Top"],
            },
            {
                "name": "Bowl",
                "systems": ["furniture"],
                "dimensions": [0.3, 0.3, 0.12],
                "position": [0, 0, 0.75],
                "role": "container",
            },
            {
                "name": "Ball",
                "systems": ["furniture"],
                "dimensions": [0.08, 0.08, 0.08],
                "position": [0, 0, 1.5],
                "role": "rigid",
            },
            *chairs,
        ],
        "relations": [
            {"kind": "SupportedBy", "child": "Table", "parents": ["Floor"]},
            {"kind": "SupportedBy", "child": "Bowl", "parents": ["Table/Top"]},
            {"kind": "Inside", "content": "Ball", "container": "Bowl"},
            {
                "kind": "Distributed",
                "members": [chair["name"] for chair in chairs],
                "pattern": "circle",
                "fold": 4,
                "about": "Table",
                "facing": "inwards",
            },
        ],
        "groups": [{"name": "chairs", "members": ["Chair 0", "Chair 1"], "same": ["mesh"]}],
        "lighting": [
            {"name": "Key", "kind": "area", "position": [2, -2, 3], "target": "Table", "energy": 200}
        ],
        "camera": {"position": [3, -3, 2], "target": "Table", "subjects": ["Table", "Ball"]},
        "render": {"kind": "animation"},
        "motion": {
            "phases": [
                {"name": "drop", "actor": "Ball", "kind": "fall", "start": 1, "end": 20, "extent": 0.7},
                {"name": "rest", "actor": "Ball", "kind": "settle", "start": 60, "end": 96, "cause": "drop"},
            ]
        },
        "opt_out": ["uv"],
    }


def fault_texts(plan: Any) -> list[str]:
    parsed, faults = read_plan(plan)
    assert (parsed is None) == bool(faults)
    return [str(fault) for fault in faults]


def test_a_sound_plan_has_no_faults() -> None:
    plan, faults = read_plan(json.dumps(a_plan()))
    assert faults == []
    assert plan is not None
    assert plan.stages == ("modeling", "texture", "deformation_setup", "motion", "camera", "light", "render")
    ball = plan.object("Ball")
    assert ball is not None
    assert ball.mechanism == ("sim_rigid", "bake")


def test_a_plan_comes_back_from_its_json_as_it_was() -> None:
    plan, _ = read_plan(a_plan())
    assert plan is not None
    assert read_plan(plan.model_dump_json())[0] == plan


def test_causes_that_go_round_are_a_fault_once() -> None:
    plan = a_plan()
    fall = {"actor": "Ball", "kind": "fall", "start": 1, "end": 20, "extent": 0.7}
    turn = {"kind": "rotate", "start": 1, "end": 20, "turn": 90}
    others = [
        {**turn, "name": name, "actor": f"Chair {place}", "cause": cause}
        for place, (name, cause) in enumerate([("b", "c"), ("c", "b"), ("d", "b")])
    ]
    plan["objects"] = [
        {**planned, "role": "keyframed"} if planned["name"].startswith("Chair") else planned
        for planned in plan["objects"]
    ]
    plan["motion"]["phases"] = [{**fall, "name": "a"}, *others]
    cycles = [text for text in fault_texts(plan) if "cycle" in text]
    assert len(cycles) == 1
    assert cycles[0].startswith("motion.phases[1].cause")
    assert "b → c → b" in cycles[0]


def changed(path: str, value: Any) -> dict[str, Any]:
    """The sound plan with one field replaced; ``path`` as in a fault."""
    plan = copy.deepcopy(a_plan())
    *above, last = [
        int(part) if part.isdigit() else part for part in path.replace("]", "").replace("[", ".").split(".")
    ]
    place: Any = plan
    for part in above:
        place = place[part]
    place[last] = value
    return plan


@pytest.mark.parametrize(
    ("path", "value", "where", "says"),
    [
        ("relations[0].child", "Tabel", "relations[0].child", "did you mean 'Table'"),
        ("relations[1].parents[0]", "Table/Leg", "relations[1].parents[0]", "no part 'Leg' (its parts: Top)"),
        ("relations[0].parents", ["Bowl"], "relations[1]", "closes a cycle"),
        ("relations[0].parents", ["Table"], "relations[0]", "'Table' twice"),
        ("relations[0].parents", ["Chair 0"], "relations[0]", "nothing below it leads to"),
        ("relations[3].fold", 5, "relations[3].fold", "fold is 5, but members has 4"),
        ("relations[3].members", ["Chair 0", "Chair 1"], "relations[3].fold", "fold is 4, but members has 2"),
        ("objects[3].dimensions", [0.5, 0.1, 0.1], "relations[2]", "does not fit inside"),
        ("objects[3].role", "static", "motion.phases[0].actor", "its role 'static' does not; choose one of"),
        ("objects[0].systems", ["furniture"], "objects", "No object belongs to the system 'ground'"),
        ("objects[1].name", "Floor", "objects[1]", "used twice"),
        ("objects[1].name", "furniture", "objects[1].name", "also the name of a system"),
        ("systems", ["furniture"], "systems", "The system 'ground' is missing"),
        ("objects[1].systems", ["furnitur"], "objects[1].systems[0]", "did you mean 'furniture'"),
        ("motion.phases[0].end", 200, "motion.phases[0]", "outside the scene's"),
        ("motion.phases[0].end", 70, "motion.phases[1]", "overlaps 'drop'"),
        ("motion.phases[1].cause", "push", "motion.phases[1].cause", "no phase 'push'"),
        ("motion.phases[0].cause", "rest", "motion.phases[0].cause", "after its effect"),
        ("motion.phases[0].cause", "drop", "motion.phases[0].cause", "cannot cause itself"),
        ("motion.phases[0].actor", "Cat", "motion.phases[0].actor", "no object 'Cat'"),
        ("camera.subjects", ["Cat"], "camera.subjects[0]", "no object 'Cat'"),
        ("camera.target", "Cat", "camera.target", "no object 'Cat'"),
        ("lighting[0].target", "Cat", "lighting[0].target", "no object 'Cat'"),
        ("groups[0].members", ["Cat", "Table"], "groups[0].members[0]", "no object 'Cat'"),
        ("opt_out", ["camera"], "opt_out[0]", "'camera' cannot be skipped"),
        ("opt_out", ["motion"], "opt_out", "motion.phases is not empty"),
        ("motion.phases", [], "motion.phases", "no phase says how"),
        ("frame_end", -5, "frame_end", "is before frame_start, 1."),
        ("objects[1].dimensions", [1, 0, 1], "objects[1].dimensions[1]", "greater than 0"),
        ("objects[1].position", [float("nan"), 0, 0], "objects[1].position[0]", "finite"),
        ("objects[1].colour", "red", "objects[1].colour", "Unknown field 'colour' (fields: name, "),
        ("relations[0].kind", "Upon", "relations[0].kind", "Unknown relation 'Upon'; did you mean "),
        ("relations[0].kind", "supported_by", "relations[0].kind", "did you mean 'SupportedBy'"),
        ("relations[0]", {"child": "Table"}, "relations[0].kind", "which relation this is"),
        (
            "relations[0]",
            {"kind": "SupportedBy", "child": "Table"},
            "relations[0].parents",
            "It is missing.",
        ),
        ("relations[0].parents", "Floor", "relations[0].parents", 'should be a list. Given: "Floor".'),
        (
            "objects[0].fluid_kind",
            "smoke",
            "objects[0].fluid_kind",
            "'Floor' has the role 'ground', not 'fluid'.",
        ),
        (
            "joints",
            [{"kind": "hinge", "part": "Ball", "host": "Bal"}],
            "joints[0].host",
            "There is no object 'Bal'; did you mean 'Ball'",
        ),
        (
            "joints",
            [{"kind": "hinge", "part": "Table", "host": "Bowl", "limits": [90, 0]}],
            "joints[0].limits",
            "The lower one, 90.0, is above the upper one, 0.0",
        ),
        (
            "joints",
            [{"kind": "hinge", "part": "Table", "host": "Bowl"}],
            "joints[0].part",
            "'Table' is not a rigid body; its role is 'static'.",
        ),
        ("relations[3].fould", 4, "relations[3].fould", "did you mean 'fold' (fields: when, kind, members, "),
        ("relations[3].spacing", "wide", "relations[3].spacing", "Write a number or a list of two numbers."),
        ("camera.target", [1, 2], "camera.target", "Write a name or a list of three numbers."),
        ("motion.phases[0].end", 0, "motion.phases[0].end", "Frame 0 is before the start frame, 1."),
        ("lighting", [], "lighting", "It should have at least 1 item, not 0."),
        ("objects[1].role", "wood", "objects[1].role", 'Given: "wood".'),
        (
            "objects[1].name",
            "a/b",
            "objects[1].name",
            "no slash; a part of an object (Object/Part) cannot be",
        ),
        (
            "joints",
            [{"kind": "hinge", "part": "Table/Leaf", "host": "Bowl"}],
            "joints[0].part",
            'a part of an object (Object/Part) cannot be given here. Given: "Table/Leaf".',
        ),
        ("relations[0].child", "a/b/c", "relations[0].child", "write a part of an object as Object/Part."),
    ],
)
def test_a_fault_is_named_by_its_field(path: str, value: Any, where: str, says: str) -> None:
    faults = fault_texts(changed(path, value))
    assert any(fault.startswith(where) and says in fault for fault in faults), faults


def test_opposite_directions_contradict_each_other() -> None:
    plan = a_plan()
    plan["relations"] += [
        {"kind": "LeftOf", "a": "Chair 0", "b": "Table"},
        {"kind": "LeftOf", "a": "Table", "b": "Chair 0"},
        {"kind": "RightOf", "a": "Chair 0", "b": "Table"},
        {"kind": "RightOf", "a": "Chair 0", "b": "Table", "frame": "camera"},
    ]
    faults = fault_texts(plan)
    assert [fault.partition(":")[0] for fault in faults] == ["relations[5]", "relations[6]"]


def test_what_is_left_of_something_may_be_right_of_it_at_the_end() -> None:
    plan = a_plan()
    left, right = ({"kind": kind, "a": "Chair 0", "b": "Table"} for kind in ("LeftOf", "RightOf"))
    plan["relations"] += [left, {**right, "when": "end"}]
    assert fault_texts(plan) == []
    plan["relations"][-1]["when"] = "always"
    assert any("contradicts it" in fault for fault in fault_texts(plan))


def test_a_cycle_over_several_objects_names_them_all() -> None:
    plan = a_plan()
    plan["relations"] += [
        {"kind": "OnTopOf", "a": "Chair 1", "b": "Bowl"},
        {"kind": "OnTopOf", "a": "Table", "b": "Chair 1"},
    ]
    assert any("'Table' on 'Chair 1' on 'Bowl' on 'Table'" in fault for fault in fault_texts(plan))


def with_phases(count: int) -> dict[str, Any]:
    """A plan in which one chair does everything at once."""
    plan = a_plan()
    phases = [
        {"name": f"p{n}", "actor": "Chair 0", "kind": "hold", "start": 1, "end": 2} for n in range(count)
    ]
    return {**plan, "frame_end": 9, "motion": {"phases": phases}}


def test_of_phases_at_one_time_each_is_told_once() -> None:
    overlaps = [fault for fault in fault_texts(with_phases(4)) if "overlaps" in fault]
    assert [fault.partition(":")[0] for fault in overlaps] == [f"motion.phases[{n}]" for n in (1, 2, 3)]


def test_a_plan_that_is_too_large_to_compare_in_pairs_is_refused() -> None:
    assert len(fault_texts(with_phases(1000))) == 200
    for plan in (with_phases(1001), json.dumps(with_phases(1001))):
        assert list(map(str, read_plan(plan)[1])) == [
            "motion.phases: It has 1001 entries; the limit is 1000."
        ]
    unknown = {**a_plan(), **{f"field {n}": n for n in range(1000)}}
    assert len(read_plan(unknown)[1]) == 200


def test_a_tower_stands_in_whichever_order_it_is_planned() -> None:
    chair = {"systems": ["furniture"], **CHAIR}
    names = ["Floor", *(f"Level {n}" for n in range(300))]
    levels = [{"name": name, **chair} for name in names[1:]]
    rests = [{"kind": "OnTopOf", "a": a, "b": b} for a, b in itertools.pairwise(names[::-1])]
    for relations in (rests, rests[::-1]):
        plan = a_plan()
        plan["objects"] += levels
        plan["relations"] += relations
        assert fault_texts(plan) == []
        plan["relations"] += [{"kind": "OnTopOf", "a": "Floor", "b": names[-1]}]
        assert [fault.count(" on 'Level ") for fault in fault_texts(plan)] == [300]


@pytest.mark.parametrize(
    "text", ["", "no json", "[]", "null", '{"title": 1}', "[" * 100_000, b"\xff\xfe", "1" * 3_000_000]
)
def test_invalid_text_gives_faults(text: Any) -> None:
    plan, faults = read_plan(text)
    assert plan is None
    assert faults
    assert all(len(str(fault)) < 1000 for fault in faults)


def test_what_is_wrong_in_several_places_is_told_once() -> None:
    faults = [Fault("a.size", "Too large."), Fault("b", "Missing."), Fault("c.size", "Too large.")]
    assert list(map(str, grouped(faults))) == ["a.size, c.size: Too large.", "b: Missing."]
    many = grouped([Fault(f"relations[{number}]", "Unknown.") for number in range(15)])
    assert [fault.path.partition(" and ")[2] for fault in many] == ["3 more"]
