"""Each relation type on real meshes: where it holds, where not, and what the same scene says in other guises."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import pytest
from in_blender import run
from places import REPO

from bench.audit.actors import find_actors
from bench.audit.audit import audit, read_scene
from bench.audit.relations import RELATIONS
from bench.audit.spr import judge_relations
from bench.audit.untrusted_blend import UntrustedBlend
from bench.scenes.spec import RelationType, Spec

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.blender

Case = tuple[str, str, str, bool]
SIDES = ("LeftOf", "RightOf", "InFrontOf", "Behind")
# Type, a, b, whether it holds; with a tolerance of 2 cm, or what stands behind the type.
SPECIMENS: list[Case] = [
    ("SupportedBy", "Plate", "Floor", True),
    ("SupportedBy", "Saucer", "Floor", True),  # hovers 19 mm
    ("SupportedBy", "Tray", "Floor", False),  # hovers 21 mm
    ("SupportedBy", "Brick", "Floor", True),  # is sunk 19 mm
    ("SupportedBy", "Stone", "Floor", False),  # is sunk 21 mm
    ("SupportedBy", "Kite", "Floor", False),
    ("SupportedBy", "Cloth", "Table", True),  # hangs down around it
    ("SupportedBy", "Vase", "Table", False),  # floats beside its top
    ("SupportedBy", "Ball", "Ramp", True),  # on a slope of 45 degrees
    ("SupportedBy", "Stool", "Floor", False),  # its thin legs go through the floor
    ("OnTopOf", "Plate", "Floor", True),
    ("OnTopOf", "Cloth", "Table", False),
    ("OnTopOf", "Crown", "Wall", True),
    ("Inside", "Marble", "Bowl", True),
    ("Inside", "Pebble", "Bowl", False),
    ("Inside", "Spoon", "Bowl", False),  # sticks out by more than half
    ("Inside", "Pencil", "Bowl", True),  # by less
    ("Inside", "Coin", "Sack", True),  # in a solid
    ("InContact", "Post", "Floor", True),  # driven into the ground
    ("InContact", "Kite", "Floor", False),
    ("InContact", "Coin", "Sack", False),  # swallowed
    ("Against", "Sofa", "Wall", True),
    ("Against", "Bench", "Wall", False),  # stands in it
    ("Against", "Crown", "Wall", False),  # stands on it
    ("Against", "Sofa", "Bench", False),
    ("AttachedTo", "Peg", "Ring", True),
    ("AttachedTo", "Hook", "Ring", False),
    ("AttachedTo", "Label", "Basin", True),  # a text
    ("AttachedTo", "Rope", "Lantern", True),  # a curve
    ("NextTo:0.6", "Spout", "Basin", True),
    ("NextTo:0.3", "Spout", "Basin", False),
    ("NextTo:0.6", "Coin", "Sack", False),
    ("Above", "Kite", "Floor", True),
    ("Above", "Floor", "Kite", False),
    ("Above", "Plate", "Floor", True),
    ("Above", "Spout", "Basin", True),  # beside it in plan
    ("Above", "Lantern", "Basin", False),  # too far beside
    ("Above", "Sofa", "Bench", False),
    ("Below", "Floor", "Kite", True),
    ("Below", "Kite", "Floor", False),
    ("LeftOf", "Plate", "Saucer", True),
    ("LeftOf", "Saucer", "Plate", False),
]
BEHIND: list[Case] = [
    ("LeftOf", "Cup", "Jug", True),
    ("RightOf", "Cup", "Jug", False),
    ("InFrontOf", "Cup", "Jug", False),
    ("Behind", "Cup", "Jug", True),
]
NOBODY: list[Case] = [(kind, a, b, not holds) for kind, a, b, holds in BEHIND]
GUISES = (
    *(
        "collected",
        "collected_each",
        "parented",
        "joined",
        "instanced",
        "other_units",
        "synonyms",
        "turned_normals",
    ),
    *("ungrouped", "ungrouped_hovering"),
)
KITCHEN: list[Case] = [
    ("SupportedBy", "table", "floor", True),
    ("SupportedBy", "plate", "table", True),
    ("OnTopOf", "plate", "table", True),
    ("Above", "plate", "floor", True),
    ("NextTo:2", "table", "wall", True),
    ("NextTo:1", "table", "wall", False),
    ("Against", "table", "wall", False),
]
SYNONYMS = {"table": ["desk"], "floor": ["ground"], "plate": ["dish"]}


def spec(cases: list[Case], *, when: tuple[str, ...] = (), **roles: str) -> dict[str, Any]:
    """A spec that asks for these relations; ``roles`` of actors, by name."""
    names = dict.fromkeys(name for _, a, b, _ in cases for name in (a, b))
    return {
        "id": "static_D1_99",
        "category": "static",
        "level": "D1",
        "prompt": "Some things stand about in a room of no account.",
        "actors": [
            {
                "name": name,
                "synonyms": SYNONYMS.get(name, []),
                "role": roles.get(name, "static"),
                "count": 3 if name == "crates" else 1,
                "must_have": ["renderable"],
            }
            for name in names
        ],
        "relations": [_relation(case, when) for case in cases],
    }


def _relation(case: Case, when: tuple[str, ...]) -> dict[str, Any]:
    kind, _, tolerance = case[0].partition(":")
    told: dict[str, Any] = {"type": kind, "a": case[1], "b": case[2]}
    if tolerance:
        told["tolerance"] = float(tolerance)
    return told | ({"when": list(when)} if when else {})


RESTING: list[Case] = [("SupportedBy", "crates", "floor", True)]
HANDLE: list[Case] = [("Above", "handle", "floor", True)]
START, END = ("start",), ("end",)
ASKED: dict[str, list[dict[str, Any]]] = {
    "specimens": [spec(SPECIMENS), spec([("SupportedBy", "Plate", "Chandelier", False)])],
    "seen_from_behind": [spec(BEHIND)],
    "seen_by_nobody": [spec(NOBODY)],
    **{name: [spec(KITCHEN)] for name in GUISES},
    "baked": [spec(RESTING, when=END), spec(RESTING), spec([("Above", "crates", "floor", True)])],
    "falling": [spec(RESTING, when=END), spec(RESTING), spec(RESTING, when=START), spec(HANDLE)],
    "raining": [
        spec([("NextTo:0.1", "cloud", "floor", True)], when=START, cloud="particle_emitter"),
        spec([("NextTo:0.1", "cloud", "floor", True)], when=END, cloud="particle_emitter"),
        spec([("Above", "cloud", "floor", True)], cloud="particle_emitter"),
    ],
    "dry": [spec([("InContact", "water", "tub", False)], when=START, water="fluid_domain")],
    "broken": [spec([("NextTo", "Upper", "Lower", True)])],
    "scattered": [spec([("SupportedBy", "Pebbles", "Tray", True)])],
    "primitives": [spec([("SupportedBy", "Tower", "Floor", True)])],
}
ASKED["primitives"][0]["actors"][0]["count"] = 20


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("relations")


@pytest.fixture(scope="module")
def told(place: Path) -> dict[str, list[dict[str, Any]]]:
    (place / "asked.json").write_text(json.dumps(ASKED))
    return run("relation_scenes.py", place)


def relations(told: dict[str, Any], scene: str, number: int = 0) -> list[dict[str, Any]]:
    return told[scene][number]["relations"]


def outcomes(told: dict[str, Any], scene: str, number: int = 0) -> list[str]:
    return [one["outcome"] for one in relations(told, scene, number)]


def test_the_reference_of_relations_is_up_to_date() -> None:
    from docs.generate.benchmark_pages import relations_page

    assert (REPO / "docs" / "relations.md").read_text(encoding="utf-8") == relations_page()


def test_every_type_is_defined_and_tried_both_ways() -> None:
    tried = {(case[0].partition(":")[0], case[3]) for case in (*SPECIMENS, *BEHIND, *NOBODY)}
    assert set(RELATIONS) == set(RelationType.__args__)
    assert tried == {(kind, holds) for kind in RELATIONS for holds in (True, False)}
    assert all(len(kind.definition) > 40 for kind in RELATIONS.values())


@pytest.mark.parametrize("number", range(len(SPECIMENS)), ids=[" ".join(case[:3]) for case in SPECIMENS])
def test_a_relation_holds_only_where_it_should(told: dict[str, Any], number: int) -> None:
    found = relations(told, "specimens")[number]
    assert found["outcome"] == ("holds" if SPECIMENS[number][3] else "does not hold"), found["moments"]


def test_left_and_front_are_those_of_the_camera_or_of_the_scene(told: dict[str, Any]) -> None:
    for scene, cases in (("seen_from_behind", BEHIND), ("seen_by_nobody", NOBODY)):
        assert outcomes(told, scene) == ["holds" if holds else "does not hold" for *_, holds in cases]


def test_values_seen_are_metres_at_each_time(told: dict[str, Any]) -> None:
    hovering = relations(told, "specimens")[2]["moments"]
    assert [at["when"] for at in hovering] == ["start", "middle", "end"]
    assert [at["frame"] for at in hovering] == [1, 6, 12]
    assert {at["seen"]["gap"] for at in hovering} == {0.021}
    sunk = relations(told, "specimens")[4]["moments"][0]["seen"]
    assert sunk["depth"] == pytest.approx(0.021, abs=1e-4)


def test_a_relation_to_a_missing_actor_does_not_hold(told: dict[str, Any]) -> None:
    [found] = relations(told, "specimens", 1)
    assert (found["outcome"], found["why"]) == ("does not hold", "Chandelier is missing")


@pytest.mark.parametrize(
    "guise", [name for name in GUISES if name not in ("collected_each", "ungrouped_hovering")]
)
def test_an_equivalent_scene_gives_the_same_verdicts(told: dict[str, Any], guise: str) -> None:
    assert outcomes(told, guise) == ["holds" if holds else "does not hold" for *_, holds in KITCHEN]


def test_an_assembly_is_inferred_only_where_nothing_is_grouped(told: dict[str, Any]) -> None:
    [legs, *_] = relations(told, "ungrouped")
    assert legs["assembled"] == ["Cube.000", "Cube.001", "Cube.002", "Cube.003"]
    grouped = [one for name in GUISES if name not in ("ungrouped",) for one in relations(told, name)]
    assert not [one["assembled"] for one in grouped if one["assembled"]]
    assert outcomes(told, "collected_each")[0] == "does not hold"


def test_an_assembly_does_not_take_in_the_ground_below_it(told: dict[str, Any]) -> None:
    supported, plate, *_ = relations(told, "ungrouped_hovering")
    assert supported["outcome"] == "does not hold"
    assert plate["outcome"] == "holds"


def test_baked_physics_is_measured_where_it_has_moved(told: dict[str, Any]) -> None:
    assert outcomes(told, "baked") == ["holds"]
    assert outcomes(told, "baked", 1) == ["does not hold"]
    assert outcomes(told, "baked", 2) == ["holds"]
    [resting] = relations(told, "baked")
    assert (resting["units"], resting["holding"]) == (3, 3)


def test_relations_of_unbaked_physics_are_not_scored(told: dict[str, Any]) -> None:
    [end] = relations(told, "falling")
    assert (end["outcome"], end["why"]) == ("not scored", "motion not played: unbaked: rigid-body world")
    assert told["falling"][0]["spr"] is None
    assert outcomes(told, "falling", 1) == ["does not hold"]  # at the start it can be seen
    assert outcomes(told, "falling", 2) == ["does not hold"]
    assert outcomes(told, "falling", 3) == ["not scored"]  # the parent's motion is its own


def test_particles_count_as_part_of_their_emitter(told: dict[str, Any]) -> None:
    assert [outcomes(told, "raining", number) for number in range(3)] == [
        ["does not hold"],
        ["holds"],
        ["holds"],
    ]


def test_the_box_of_a_liquid_is_not_the_liquid(told: dict[str, Any]) -> None:
    [found] = relations(told, "dry")
    assert found["outcome"] == "does not hold"
    assert found["moments"][0]["seen"] == {"nothing_of": ["a"]}


def test_two_hundred_loose_boxes_form_their_towers(told: dict[str, Any]) -> None:
    [found] = relations(told, "primitives")
    assert (found["outcome"], found["units"]) == ("holds", 20)
    assert len(found["assembled"]) == 180


def test_corners_that_are_not_finite_are_ignored(told: dict[str, Any]) -> None:
    [found] = relations(told, "broken")
    assert found["outcome"] == "holds"
    assert found["moments"][0]["seen"]["gap"] == pytest.approx(0.01, abs=1e-5)


def test_instances_of_geometry_nodes_are_measured(told: dict[str, Any]) -> None:
    [found] = relations(told, "scattered")
    assert found["outcome"] == "holds"
    assert found["moments"][0]["seen"]["gap"] < 0.01


def test_relations_are_the_same_on_every_run(told: dict[str, Any], place: Path) -> None:
    asked = Spec.model_validate(ASKED["baked"][0])
    first, second = audit(place / "baked.blend", asked), audit(place / "baked.blend", asked)
    assert first.as_json() == second.as_json()
    assert (first.spr, first.relations[0].outcome) == (1.0, "holds")
    assert [asdict(one) for one in first.relations] == _tuples(relations(told, "baked"))


def _tuples(told: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [{**one, "moments": tuple(one["moments"]), "assembled": tuple(one["assembled"])} for one in told]


@pytest.mark.usefixtures("told")
def test_a_blender_that_ends_while_it_measures_leaves_relations_unscored(place: Path) -> None:
    asked = Spec.model_validate(ASKED["baked"][0])
    with UntrustedBlend(place / "baked.blend") as file:
        scene = read_scene(file, play=True)
    found = judge_relations(asked, scene, find_actors(asked, scene), file)
    assert [one.outcome for one in found] == ["not scored"]
