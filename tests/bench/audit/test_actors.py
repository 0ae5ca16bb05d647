"""Actors are found whatever the system calls and groups them, and what cannot be told is said to be so."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from in_blender import facts_of

from bench.audit.actors import find_actors
from bench.audit.audit import Audit, audit_scene, check_predicates
from bench.audit.names import match_name, words_of
from bench.scenes.spec import BadSpec, Spec

if TYPE_CHECKING:
    from bench.audit.facts import Scene

CLOTH = ["renderable", "solver_enabled", "cloth_modifier", "cloth_cache_baked"]
RIGID = [
    "renderable",
    "solver_enabled",
    "rigid_settings",
    {"rigid_type": {"type": "ACTIVE"}},
    "rigid_cache_baked",
]
CHEATS = ["dense_transform_keys", "animated_shape_keys"]
SPEC: dict[str, Any] = {
    "id": "cloth_D3_99",
    "category": "cloth",
    "level": "D3",
    "prompt": "A tablecloth sinks onto a table while four dominoes stand by a lamp.",
    "frames": {"min": 12},
    "actors": [
        {
            "name": "tablecloth",
            "synonyms": ["linen"],
            "role": "cloth",
            "hints": {"size": [1, 5], "topology": "open"},
            "must_have": [*CLOTH, {"cloth_collision_partners": {"partners": ["table"]}}],
            "must_not_have": CHEATS,
        },
        {"name": "table", "role": "collider", "hints": {"size": [1, 3]}, "must_have": ["renderable", "solver_enabled"]},
        {
            "name": "domino",
            "synonyms": ["tile stone"],
            "role": "rigid_active",
            "count": 4,
            "hints": {"size": [0.5, 1]},
            "must_have": RIGID,
            "must_not_have": CHEATS,
        },
        {"name": "floor", "synonyms": ["ground"], "role": "rigid_passive", "must_have": ["rigid_settings"]},
        {"name": "lamp", "synonyms": ["lantern"], "role": "static", "must_have": ["renderable"]},
    ],
}  # fmt: skip
ALIKE = (
    "plain",
    "synonyms",
    "other_units",
    "nameless",
    "parented",
    "collected",
    "duplicates",
    "joined",
    "instanced",
)


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Scene]:
    return facts_of("guises.py", tmp_path_factory.mktemp("guises"))


def spec(**changed: Any) -> Spec:
    return Spec.model_validate({**SPEC, **changed})


def result(scene: Scene, asked: Spec | None = None) -> Audit:
    asked = asked or spec()
    return audit_scene(asked, scene, find_actors(asked, scene))


def failed(found: Audit) -> dict[str, list[str]]:
    return {
        actor.name: names
        for actor in found.actors
        if (names := [check.predicate for check in actor.checks if check.outcome == "failed"])
    }


@pytest.mark.blender
@pytest.mark.parametrize("guise", ALIKE)
def test_an_equivalent_scene_scores_the_same(guise: str, scenes: dict[str, Scene]) -> None:
    found = result(scenes[guise])
    assert (found.mpr, failed(found)) == (1.0, {})
    assert {actor.outcome for actor in found.actors} == {"resolved"}


@pytest.mark.blender
def test_the_audit_says_how_an_actor_was_found(scenes: dict[str, Scene]) -> None:
    by = {
        guise: {actor.name: actor.by for actor in result(scenes[guise]).actors}
        for guise in ("plain", "nameless", "collected")
    }
    assert by["plain"]["tablecloth"] == "name"
    assert by["nameless"]["domino"] == by["nameless"]["tablecloth"] == "hints"
    assert by["collected"]["domino"] == by["collected"]["lamp"] == "collection"


@pytest.mark.blender
def test_instanced_objects_are_not_separate_units(scenes: dict[str, Scene]) -> None:
    units = find_actors(spec(), scenes["instanced"])["lamp"].units
    assert [unit.name for unit in units] == ["Lamp"]
    assert units[0].names == {"Lamp", "Base", "Shade"}


@pytest.mark.blender
def test_lengths_are_metres_whatever_the_unit(scenes: dict[str, Scene]) -> None:
    sizes = [
        {one.name: one.size for one in scenes[guise].objects}["Table"] for guise in ("plain", "other_units")
    ]
    assert sizes == [pytest.approx((1, 1, 1), abs=1e-3)] * 2


@pytest.mark.blender
def test_an_actor_with_two_candidates_is_ambiguous_and_judged_by_both(
    scenes: dict[str, Scene],
) -> None:
    cloth = result(scenes["two_cloths"]).actors[0]
    assert (cloth.outcome, cloth.evidence["objects"]) == ("ambiguous", ["Object.8", "Object.9"])
    assert cloth.score == 1.0


@pytest.mark.blender
def test_a_missing_actor_scores_nothing_and_counts(scenes: dict[str, Scene]) -> None:
    stove = {"name": "stove", "role": "static", "must_have": ["renderable"]}
    found = result(scenes["plain"], spec(actors=[*SPEC["actors"], stove]))
    assert (found.actors[-1].outcome, found.actors[-1].score) == ("missing", 0.0)
    assert found.mpr == pytest.approx(5 / 6, abs=1e-6)


@pytest.mark.blender
def test_fewer_units_than_required_do_not_pass(scenes: dict[str, Scene]) -> None:
    actors = [{**actor, "count": 5} if actor["name"] == "domino" else actor for actor in SPEC["actors"]]
    found = result(scenes["plain"], spec(actors=actors))
    dominoes = next(actor for actor in found.actors if actor.name == "domino")
    assert "renderable" in failed(found)["domino"]
    assert dominoes.checks[0].seen["good"] == 4


@pytest.mark.blender
def test_an_object_in_a_hidden_collection_is_not_renderable(scenes: dict[str, Scene]) -> None:
    assert failed(result(scenes["hidden_members"])) == {"lamp": ["renderable"]}


@pytest.mark.blender
def test_a_predicate_that_must_not_hold_passes_when_it_does_not(scenes: dict[str, Scene]) -> None:
    found = result(scenes["plain"], spec(assertions=["static_has_solver", "static_has_rigid_world"]))
    assert [check.outcome for check in found.assertions] == ["failed", "failed"]
    assert [check.wanted for check in found.actors[0].checks][-2:] == ["must_not_have", "must_not_have"]
    assert [check.outcome for check in found.actors[0].checks][-2:] == ["passed", "passed"]


@pytest.mark.blender
def test_objects_shown_as_particles_belong_to_their_emitter(scenes: dict[str, Scene]) -> None:
    check = ["particle_system"]
    actors = [
        {"name": "campfire", "synonyms": ["sparks"], "role": "particle_emitter", "must_have": check},
        {"name": "snowflakes", "role": "particle_emitter", "must_have": check},
    ]
    asked = spec(id="particle_D1_99", category="particle", level="D1", actors=actors)
    found = find_actors(asked, scenes["particles_shown_as_things"])
    units = {
        name: [[each.name for each in unit.objects] for unit in one.units] for name, one in found.items()
    }
    assert units == {"campfire": [["Campfire", "Spark"]], "snowflakes": [["Plane", "Snowflake"]]}


@pytest.mark.blender
def test_what_has_an_actors_name_in_its_own_is_dressing_beside_the_actor(scenes: dict[str, Scene]) -> None:
    units = find_actors(spec(), scenes["dressing"])["lamp"].units
    assert [unit.names for unit in units] == [{"Mesh.3", "Mesh.4"}]


@pytest.mark.blender
def test_a_flow_is_found_among_the_parts_of_its_fluid(scenes: dict[str, Scene]) -> None:
    actors = [
        {"name": "water", "role": "fluid_domain", "must_have": ["fluid_modifier"]},
        {"name": "column", "role": "fluid_flow", "must_have": [{"fluid_type": {"type": "FLOW", "kind": "LIQUID"}}]},
    ]  # fmt: skip
    asked = spec(id="fluid_D1_99", category="fluid", level="D1", actors=actors)
    found = find_actors(asked, scenes["flow_in_its_fluid"])
    assert [unit.name for unit in found["column"].units] == ["Water mesh"]
    assert (found["column"].by, result(scenes["flow_in_its_fluid"], asked).mpr) == ("hints", 1.0)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("RedCushions.001", ("red", "cushion")),
        ("TABLE_cloth-02", ("table", "cloth")),
        ("LPShelves", ("lp", "shelf")),
        ("Glasses", ("glass",)),
        ("Dominoes", ("domino",)),
        ("shoes", ("shoe",)),
        ("chair [set.blend]", ("chair",)),
        ("Mesh", ("mesh",)),
        ("Tisch_ä.003", ("tisch", "ä")),
        ("123", ()),
    ],
)
def test_a_name_is_split_into_words(name: str, words: tuple[str, ...]) -> None:
    assert words_of(name) == words


@pytest.mark.parametrize(
    ("name", "better", "worse"),
    [
        ("table_cloth", "tablecloth", "table"),
        ("TableLamp.002", "lamp", "table"),
        ("cushion_on_sofa", "cushion", "sofa"),
        ("dining table", "dining table", "table"),
        ("bowl_of_milk", "bowl", "milk"),
    ],
)
def test_the_last_noun_of_a_name_decides_its_actor(name: str, better: str, worse: str) -> None:
    first, second = match_name(name, [better]), match_name(name, [worse])
    assert first is not None
    assert second is None or first > second


def test_part_of_a_word_does_not_match() -> None:
    assert match_name("stablecloth", ["table", "cloth"]) is None
    assert match_name("carpet", ["car", "pet"]) is None


@pytest.mark.parametrize(
    ("check", "said"),
    [
        ("cloth_modifer", "no predicate 'cloth_modifer'"),
        ({"fluid_resolution": {"min": 0}}, "fluid_resolution: min"),
        ({"cloth_collision_partners": {"partners": ["chair"]}}, "no actor is called chair"),
    ],
)
def test_a_spec_with_unknown_predicates_or_partners_is_refused(check: Any, said: str) -> None:
    actors = [{**SPEC["actors"][0], "must_have": [check]}, *SPEC["actors"][1:]]
    with pytest.raises(BadSpec, match=said):
        check_predicates(spec(actors=actors))
