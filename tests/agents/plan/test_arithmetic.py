"""What a plan's own numbers say against it: told before anything is built."""

from __future__ import annotations

import copy
import json
from typing import TYPE_CHECKING, Any

import pytest
from places import REPO

from agents.blender.checks import plan_check
from agents.plan.arithmetic import doubts_of
from agents.plan.check import read_plan

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan


def an_object(name: str, size: Any, at: Any, **more: Any) -> dict[str, Any]:
    return {"name": name, "systems": ["set"], "dimensions": size, "position": at, **more}


# A floor, a table, a cup on it, a picture on a wall, a ball that drops, and a camera that sees them.
SOUND: dict[str, Any] = {
    "title": "A room",
    "frame_end": 72,
    "systems": ["ground", "set"],
    "objects": [
        an_object("Floor", (6, 6, 0.1), (0, 0, 0), systems=["ground"], role="ground"),
        an_object("Table", (1.6, 0.8, 0.75), (0, 0, 0), parts=["Top"]),
        an_object("Cup", (0.08, 0.08, 0.1), (0.3, 0, 0.75)),
        an_object("Bowl", (0.3, 0.3, 0.12), (-0.3, 0, 0.75), role="container"),
        an_object("Apple", (0.08, 0.08, 0.08), (-0.3, 0, 0.77)),
        an_object("Wall", (6, 0.1, 2.5), (0, 1.5, 0)),
        an_object("Picture", (0.6, 0.03, 0.4), (0, 1.435, 1.3)),
        an_object("Chair", (0.45, 0.45, 0.9), (0, -0.65, 0)),
        an_object("Ball", (0.1, 0.1, 0.1), (1.5, 0, 1.5), role="rigid"),
        an_object("Crate", (0.4, 0.4, 0.4), (2.2, 0.5, 0)),
    ],
    "relations": [
        {"kind": "SupportedBy", "child": "Table", "parents": ["Floor"]},
        {"kind": "SupportedBy", "child": "Cup", "parents": ["Table/Top"]},
        {"kind": "Inside", "content": "Apple", "container": "Bowl"},
        {"kind": "StableAgainst", "child": "Picture", "parent": "Wall"},
        {"kind": "OnTopOf", "a": "Bowl", "b": "Table"},
        {"kind": "NextTo", "a": "Chair", "b": "Table", "gap": (0.0, 0.1)},
        {"kind": "LeftOf", "a": "Bowl", "b": "Cup"},
        {"kind": "InFrontOf", "a": "Chair", "b": "Table", "frame": "camera"},
        {"kind": "Upright", "a": "Cup"},
        {"kind": "Distributed", "members": ["Bowl", "Cup"], "pattern": "line", "spacing": 0.6},
    ],
    "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
    "camera": {"position": (0, -6, 2), "target": "Table", "lens": 35, "subjects": ["Table"]},
    "render": {"kind": "animation", "resolution": (960, 960)},
    "motion": {
        "phases": [
            {"name": "drop", "actor": "Ball", "kind": "fall", "start": 1, "end": 14, "extent": 1.4},
            {"name": "rest", "actor": "Ball", "kind": "settle", "start": 40, "end": 72},
        ]
    },
}


def plan(**changes: Any) -> ScenePlan:
    """The sound plan with changes: Object__field=value, relation_N=…, camera=…, phase_N=…."""
    fields = copy.deepcopy(SOUND)
    fields["camera"]["subjects"] = ["Table", "Chair"]
    for name, value in changes.items():
        owner, _, field = name.partition("__")
        if owner == "camera":
            fields["camera"][field] = value
        elif owner.startswith("relation_"):
            fields["relations"][int(owner[9:])][field] = value
        elif owner == "phase":
            fields["motion"]["phases"][0][field] = value
        else:
            next(one for one in fields["objects"] if one["name"] == owner)[field] = value
    made, faults = read_plan(fields)
    assert made is not None, faults
    return made


def test_nothing_speaks_against_a_sound_plan() -> None:
    assert doubts_of(plan()) == []


@pytest.mark.parametrize(
    ("changes", "path", "why"),
    [
        ({"Cup__position": (0.3, 0, 0.85)}, "relations[1]", "0.1 m above the top of 'Table' (0.75 m)"),
        ({"Cup__position": (1.3, 0, 0.75)}, "relations[1]", "beside 'Table'"),
        ({"Apple__position": (-0.3, 0, 1.5)}, "relations[2]", "outside 'Bowl'"),
        ({"Apple__position": (-0.3, 0, 0.82)}, "relations[2]", "say that it is partly inside"),
        ({"Picture__position": (0, 1.2, 1.3)}, "relations[3]", "'Picture' and 'Wall' are 0.235 m apart"),
        ({"Bowl__position": (-0.92, 0, 0.75)}, "relations[4]", "only 10% of 'Bowl' is over 'Table'"),
        ({"Chair__position": (0, -1.2, 0)}, "relations[5]", "0.575 m apart; the gap is to be at most 0.1 m"),
        ({"relation_5__gap": (0.3, 0.5)}, "relations[5]", "the gap is to be at least 0.3 m"),
        ({"relation_6__kind": "RightOf"}, "relations[6]", "on the other side of 'Cup' (frame: world)"),
        ({"Bowl__dimensions": (1.3, 0.3, 0.12)}, "relations[6]", "'Bowl' begins"),
        ({"camera__position": (0, 6, 2)}, "relations[7]", "(frame: camera)"),
        ({"Cup__rotation": (0, 20, 0)}, "relations[8]", "tilts it by 20°"),
        ({"relation_9__spacing": 0.5}, "relations[9]", "0.6 m apart; the spacing is to be 0.5 m"),
        ({"Crate__position": (1.5, 0, 1.15)}, "objects[8]", "overlap by 0.05 m at the first frame"),
        ({"phase__end": 8}, "motion.phases[0]", "takes 0.53 s, 13 frames at 24 fps; the phase has 7"),
        ({"phase__top_speed": 2}, "motion.phases[0]", "reaches 5.2 m/s; top_speed is 2 m/s"),
        (
            {"phase__extent": 2, "phase__end": 17},
            "motion.phases[0]",
            "only 1.6 m above the ground's underside",
        ),
        ({"camera__target": (9, 0, 0)}, "camera.subjects[0]", "outside the picture at the first frame"),
        (
            {"camera__moves": True, "camera__target": (9, 0, 0)},
            "camera.subjects[0]",
            "outside the picture at the first frame",
        ),
        (
            {"camera__subjects": ["Cup"], "camera__position": (0, -9, 2)},
            "camera.subjects[0]",
            "fills at most",
        ),
        # A box along the picture's sides around what is turned would fill enough.
        (
            {
                "camera__subjects": ["Picture"],
                "camera__position": (0, -4, 1.5),
                "camera__target": "Picture",
                "Picture__dimensions": (0.9, 0.03, 0.05),
                "Picture__rotation": (0, 45, 0),
            },
            "camera.subjects[0]",
            "fills at most 0.",
        ),
    ],
)
def test_a_number_that_contradicts_the_plan_is_told(changes: dict[str, Any], path: str, why: str) -> None:
    doubts = [doubt for doubt in doubts_of(plan(**changes)) if doubt.path == path]
    assert [why in doubt.message for doubt in doubts] == [True], doubts_of(plan(**changes))


@pytest.mark.parametrize(
    "changes",
    [
        {"Apple__position": (-0.3, 0, 1.5), "relation_2__when": "end"},
        {"Wall__systems": ["ground", "set"], "relation_1__child": "Wall", "relation_1__parents": ["Floor"]},
        {"Cup__position": (0.3, 0, 0.85), "Cup__description": "Its root is in its centre."},
        {"Apple__position": (-0.3, 0, 0.82), "relation_2__partial": True},
        {"Floor__position": (0, 0, -0.1)},
        {"Crate__position": (1.5, 0, 1.3), "Crate__role": "container"},
        {"Crate__position": (1.5, 0.2, 1.3), "Crate__rotation": (0, 0, 45)},
        {"camera__subjects": ["Apple"], "camera__target": "Apple", "camera__position": (-0.3, -0.8, 0.8)},
    ],
)
def test_what_may_be_right_all_the_same_is_not_told(changes: dict[str, Any]) -> None:
    assert doubts_of(plan(**changes)) == []


@pytest.mark.parametrize("name", ["dominoes", "pour", "tablecloth"])
def test_nothing_speaks_against_the_plans_of_the_demos(name: str) -> None:
    text = (REPO / "agents" / "transcripts" / name / "01-planner.md").read_text(encoding="utf-8")
    made, faults = read_plan(text[text.index("{") : text.rindex("}") + 1])
    assert made is not None, faults
    assert doubts_of(made) == []


def test_the_tool_tells_doubts_of_a_valid_plan() -> None:
    doubtful = plan(Cup__position=(0.3, 0, 0.85)).model_dump(mode="json", exclude_defaults=True)
    answer = plan_check.answer({"plan": json.loads(json.dumps(doubtful))})
    assert answer.structured_content is not None
    assert answer.structured_content["sound"] is True
    assert [doubt["path"] for doubt in answer.structured_content["doubts"]] == ["relations[1]"]
    assert answer.content[0].type == "text"
    assert "Doubts (1):" in answer.content[0].text
