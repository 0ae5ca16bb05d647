"""The fifty scenes, and the rules that they keep."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
import yaml
from levels import level_of
from spec_checks import PUBLISHED, faults, faults_together

from bench.audit.names import match_name
from bench.audit.predicates.catalogue import PREDICATES
from bench.scenes.spec import FOLDER, BadSpec, Spec, read_spec, spec_of, specs

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ALL = [spec.id for spec in specs()]


def written(name: str) -> dict[str, Any]:
    """A spec as its file has it, to be changed."""
    return yaml.safe_load((FOLDER / f"{name}.yaml").read_text("utf-8"))


def actor(spec: dict[str, Any], name: str) -> dict[str, Any]:
    return next(one for one in spec["actors"] if one["name"] == name)


@pytest.mark.parametrize("name", ALL)
def test_a_scene_keeps_all_rules(name: str):
    assert faults(spec_of(name)) == ()


def test_the_fifty_scenes_have_no_faults_as_a_set():
    assert len(specs()) == 50
    assert faults_together(specs()) == ()


def test_the_published_prompts_are_there_word_for_word():
    assert {"cloth_D1_01", "soft_D3_01", "static_D1_01"} == PUBLISHED
    assert spec_of("cloth_D1_01").prompt == (
        "A red tablecloth drapes over a small round wooden table in a quiet dining room."
    )
    assert spec_of("soft_D3_01").prompt == (
        "A thick green jelly slab on a wooden board is crushed under a falling heavy stone block, the jelly squashing "
        "flat under the block as it settles."
    )
    assert spec_of("static_D1_01").prompt.startswith(
        "A furnished living room interior: a three-seat sofa against the back wall with two cushions, a coffee table"
    )


@pytest.mark.parametrize("name", ALL)
def test_every_name_of_an_actor_matches_that_actor_best(name: str):
    spec = spec_of(name)
    for one in spec.actors:
        for phrase in (one.name, *one.synonyms):
            found = {other.name: match_name(phrase, (other.name, *other.synonyms)) for other in spec.actors}
            best = max((hit, who) for who, hit in found.items() if hit is not None)
            assert best[1] == one.name, phrase


@pytest.mark.parametrize("name", ALL)
def test_parameters_of_checks_are_valid(name: str):
    for one in spec_of(name).actors:
        for check in one.must_have:
            PREDICATES[check.predicate].read(check.params)
            with pytest.raises(ValueError, match=check.predicate):
                PREDICATES[check.predicate].read({**check.params, "no such parameter": 1})


# Each rule is shown to bite: a good spec, one thing changed, and a word of the fault that it must give.
BROKEN: dict[str, tuple[str, Callable[[dict[str, Any]], object], str]] = {
    "an unknown predicate": (
        "cloth_D1_01",
        lambda spec: spec["actors"][0]["must_have"].append("cloth_is_red"),
        "no predicate 'cloth_is_red'",
    ),
    "an unknown parameter": (
        "fluid_D1_01",
        lambda spec: spec["actors"][0]["must_have"].append({"fluid_flow_count": {"least": 2}}),
        "least",
    ),
    "a kind that Blender does not know": (
        "rigid_D3_01",
        lambda spec: actor(spec, "grinding wheel")["must_have"].append(
            {"rigid_constraint": {"type": "GLUE"}}
        ),
        "rigid_constraint",
    ),
    "a partner that is no actor": (
        "cloth_D1_01",
        lambda spec: actor(spec, "tablecloth")["must_have"].append(
            {"cloth_collision_partners": {"partners": ["piano"]}}
        ),
        "no actor is called piano",
    ),
    "an actor that is its own partner": (
        "cloth_D1_01",
        lambda spec: actor(spec, "tablecloth")["must_have"].__setitem__(
            -1, {"cloth_collision_partners": {"partners": ["tablecloth"]}}
        ),
        "its own partner",
    ),
    "an imitation that is asked for": (
        "cloth_D1_01",
        lambda spec: spec["actors"][0]["must_have"].append("animated_shape_keys"),
        "belongs in must_not_have",
    ),
    "a virtue that is ruled out": (
        "cloth_D1_01",
        lambda spec: spec["actors"][0]["must_not_have"].append("cloth_self_collision"),
        "does not belong in must_not_have",
    ),
    "a predicate asked for twice": (
        "soft_D1_01",
        lambda spec: spec["actors"][0]["must_have"].append("renderable"),
        "renderable is listed twice",
    ),
    "a modifier that does not deform": (
        "particle_D3_01",
        lambda spec: actor(spec, "sail")["must_have"].append(
            {"particle_from_deformed": {"deformer": "BEVEL"}}
        ),
        "BEVEL is not a deforming modifier",
    ),
    "keyframes that are not ruled out": (
        "rigid_D1_02",
        lambda spec: actor(spec, "pumpkin").pop("must_not_have"),
        "its role rigid_active needs dense_transform_keys in must_not_have",
    ),
    "a cloth that needs no bake": (
        "cloth_D2_01",
        lambda spec: actor(spec, "flag")["must_have"].remove("cloth_cache_baked"),
        "its role cloth needs cloth_cache_baked in must_have",
    ),
    "a thing that nobody needs to see": (
        "cloth_D2_01",
        lambda spec: actor(spec, "pier").update(must_have=["solver_enabled"]),
        "renderable is missing in must_have",
    ),
    "an actor without a size": (
        "cloth_D2_01",
        lambda spec: actor(spec, "pier").pop("hints"),
        "hints.size must be a range",
    ),
    "four sentences": (
        "fluid_D1_02",
        lambda spec: spec.update(prompt=spec["prompt"] + " It is cold. Nobody is about. The fire is out."),
        "4 sentences instead of 1 to 3",
    ),
    "half a sentence": (
        "fluid_D1_02",
        lambda spec: spec.update(prompt=spec["prompt"] + " and then"),
        "sentences",
    ),
    "a placeholder": (
        "rigid_D1_02",
        lambda spec: spec.update(prompt=spec["prompt"].replace("pumpkin", "pumpkin like a ball")),
        "'ball' is a placeholder",
    ),
    "no time of day": (
        "rigid_D1_02",
        lambda spec: spec.update(prompt=spec["prompt"].replace("On an October morning a", "A")),
        "no known word for a time",
    ),
    "an actor that the prompt does not name": (
        "rigid_D1_02",
        lambda spec: spec["actors"].append(
            {"name": "gnome", "role": "static", "hints": {"size": [0.2, 1]}, "must_have": ["renderable"]}
        ),
        "gnome: the prompt does not name it",
    ),
    "an implied actor that the prompt names": (
        "rigid_D1_02",
        lambda spec: actor(spec, "pumpkin").update(implied=True),
        "implied, but the prompt names it",
    ),
    "one phrase for two actors": (
        "rigid_D1_02",
        lambda spec: actor(spec, "gravel path").update(synonyms=["Steps"]),
        "'Steps' is also a name of stairway",
    ),
    "a level that asks for less than its name": (
        "cloth_D2_01",
        lambda spec: spec.update(id="cloth_D3_07", level="D3"),
        "its checks are of level D2",
    ),
    "a first level with pins": (
        "cloth_D1_01",
        lambda spec: actor(spec, "tablecloth")["must_have"].append("cloth_pin_group"),
        "its checks are of level D2",
    ),
    "a category whose solver is missing": (
        "rigid_D3_02",
        lambda spec: spec.update(id="fluid_D3_07", category="fluid"),
        "no actor has a solver of the category fluid",
    ),
    "a clip of a minute": (
        "soft_D1_01",
        lambda spec: spec.update(frames={"min": 1440}),
        "60.0 seconds instead of 2 to 6",
    ),
    "a clip in which nothing moves": (
        "soft_D1_01",
        lambda spec: spec.update(phases=[]),
        "phases: there is none",
    ),
    "a phase that runs backwards": (
        "soft_D1_01",
        lambda spec: spec["phases"][0].update(start=0.9, end=0.2),
        "ends before it starts",
    ),
    "one relation": (
        "soft_D3_01",
        lambda spec: spec.update(relations=spec["relations"][:1]),
        "1 instead of 2 to 5",
    ),
    "a relation to itself": (
        "soft_D3_01",
        lambda spec: spec["relations"][0].update(b=spec["relations"][0]["a"]),
        "itself",
    ),
    "a relation to the wind": (
        "cloth_D2_01",
        lambda spec: spec["relations"].append({"type": "NextTo", "a": "flag", "b": "wind"}),
        "wind has no surface",
    ),
    "a relation twice": (
        "soft_D3_01",
        lambda spec: spec["relations"].append({**spec["relations"][0], "when": ["start"]}),
        "is listed twice for the start",
    ),
    "two things on top of each other": (
        "soft_D3_01",
        lambda spec: spec["relations"].append(
            {"type": "SupportedBy", "a": "wooden board", "b": "jelly slab"}
        ),
        "above each other",
    ),
    "a relation at no time": (
        "soft_D3_01",
        lambda spec: spec["relations"][0].update(when=[]),
        "'when' is empty",
    ),
    "a static scene that may have physics": (
        "static_D1_02",
        lambda spec: spec["assertions"].remove("static_has_solver"),
        "static_has_solver is missing",
    ),
    "a dynamic scene that must have none": (
        "cloth_D1_01",
        lambda spec: spec.update(assertions=["static_has_cache"]),
        "only static scenes have them",
    ),
    "a still scene with a cloth": (
        "static_D1_02",
        lambda spec: actor(spec, "broom").update(role="cloth"),
        "not all are static",
    ),
    "a room with two things": (
        "static_D1_03",
        lambda spec: spec.update(actors=spec["actors"][:2], relations=[]),
        "2 in a room instead of 15 to 20",
    ),
    "a harbour the size of a room": (
        "static_D2_01",
        lambda spec: [one["hints"].update(size=[0.5, 5]) for one in spec["actors"]],
        "its checks are of level D1",
    ),
}


@pytest.mark.parametrize("case", BROKEN)
def test_a_rule_finds_its_fault(case: str):
    name, change, said = BROKEN[case]
    spec = written(name)
    change(spec)
    assert any(said in fault for fault in faults(Spec.model_validate(spec))), faults(
        Spec.model_validate(spec)
    )


def test_a_missing_scene_is_a_fault():
    rest = [spec for spec in specs() if spec.id != "fluid_D2_03"]
    told = faults_together(rest)
    assert "fluid_D2: 2 scenes instead of 3" in told
    assert "no scene uses fluid_guiding" in told
    assert "fluid_D2_03.yaml: the file is not named after its scene's id" in told


def test_a_gap_in_the_numbers_is_a_fault():
    rest = [spec for spec in specs() if spec.id != "fluid_D2_02"]
    assert "fluid_D2: the ids are numbered 1, 3, not from 01 without gaps" in faults_together(rest)


def test_a_copy_of_a_scene_under_another_id_is_a_fault():
    copy = spec_of("rigid_D2_02").model_copy(update={"id": "rigid_D2_04"})
    told = [fault for fault in faults_together([*specs(), copy]) if "rigid_D2_02 and rigid_D2_04" in fault]
    assert [fault.partition(": ")[2] for fault in told] == [
        "their prompts share too many words",
        "they share too many actors",
        "their roles and checks are the same",
    ]


def test_a_copied_mechanism_with_other_words_is_a_fault():
    spec = written("soft_D2_01")
    names = {"cactus": "reed", "gust": "draught", "pot": "vase", "windowsill": "mantelpiece"}
    text = yaml.safe_dump(
        {**spec, "id": "soft_D2_04", "prompt": "A reed in a vase bends on a mantelpiece in a draught."}
    )
    for name, other in names.items():
        text = text.replace(name, other)
    other = Spec.model_validate(yaml.safe_load(text))
    assert "soft_D2_01 and soft_D2_04: their roles and checks are the same" in faults_together(
        [*specs(), other]
    )


LEVELS: list[tuple[str, Callable[[dict[str, Any]], object], str]] = [
    ("cloth_D1_01", lambda spec: None, "D1"),
    ("rigid_D1_01", lambda spec: spec["actors"][0].update(count=12), "D2"),
    ("fluid_D1_03", lambda spec: actor(spec, "column of water").update(count=2), "D2"),
    ("soft_D1_02", lambda spec: spec["actors"][0]["must_have"].append("soft_goal_group"), "D2"),
    ("soft_D1_02", lambda spec: spec["actors"][1]["must_have"].append("rigid_settings"), "D3"),
    ("particle_D2_01", lambda spec: spec["actors"][0]["must_have"].append("cloth_modifier"), "D3"),
]


@pytest.mark.parametrize(("name", "change", "level"), LEVELS)
def test_the_level_follows_from_the_checks(name: str, change: Callable[[dict[str, Any]], object], level: str):
    spec = written(name)
    change(spec)
    assert level_of(Spec.model_validate(spec)) == level


def test_an_invalid_spec_file_says_where_it_is_wrong(tmp_path: Path):
    file = tmp_path / "cloth_D1_01.yaml"
    file.write_text(yaml.safe_dump({**written("cloth_D1_01"), "levle": "D1"}), "utf-8")
    with pytest.raises(BadSpec, match=r"cloth_D1_01\.yaml: levle"):
        read_spec(file)
