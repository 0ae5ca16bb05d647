"""Each predicate on real Blender data: a scene in which it holds, what ends that, and what else that ends."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from in_blender import facts_of
from places import REPO

from bench.audit.predicates.catalogue import PREDICATES, by_name
from bench.audit.predicates.predicate import (
    GROUPS,
    AuditContext,
    Predicate,
    PredicateVerdict,
    Unit,
    verdict_of,
)

if TYPE_CHECKING:
    from bench.audit.facts import Scene
    from bench.audit.predicates.predicate import PredicateParams

CATALOGUE = """
universal: renderable solver_enabled
cloth: cloth_modifier cloth_cache_baked cloth_self_collision cloth_pin_group cloth_collision_partners
fluid: fluid_modifier fluid_type fluid_domain_exists fluid_flow_count fluid_cache_baked fluid_dynamic_effector
    fluid_guiding fluid_resolution fluid_mesh
rigid body: rigid_settings rigid_type rigid_shape rigid_world_populated rigid_cache_baked rigid_constraint
    rigid_constraint_no_collision rigid_collision_modifier rigid_positive_mass
particle: particle_system particle_type particle_source particle_cache_baked particle_collision_partners
    particle_from_deformed particle_force_fields
soft body: soft_modifier soft_cache_baked soft_collision_partners soft_goal_group soft_rigid_partners
anti-cheat: dense_transform_keys animated_shape_keys static_has_cache static_has_rigid_world static_has_solver
"""
FLOW = {"type": "FLOW", "kind": "LIQUID", "behavior": "INFLOW"}
# Predicate → the scene that it is tried in, the objects of the actor, its role, the parameters.
ASKED: dict[str, tuple[str, str, str, dict[str, Any]]] = {
    "renderable": ("cloth", "Sheet", "cloth", {}),
    "solver_enabled": ("cloth", "Sheet", "cloth", {}),
    "cloth_modifier": ("cloth", "Sheet", "cloth", {}),
    "cloth_cache_baked": ("cloth", "Sheet", "cloth", {}),
    "cloth_self_collision": ("cloth", "Sheet", "cloth", {}),
    "cloth_pin_group": ("cloth", "Sheet", "cloth", {}),
    "cloth_collision_partners": ("cloth", "Sheet", "cloth", {"partners": ["Table"]}),
    "soft_modifier": ("soft", "Jelly", "soft", {}),
    "soft_cache_baked": ("soft", "Jelly", "soft", {}),
    "soft_collision_partners": ("soft", "Jelly", "soft", {"partners": ["Block"]}),
    "soft_goal_group": ("soft", "Jelly", "soft", {}),
    "soft_rigid_partners": ("soft", "Jelly", "soft", {"partners": ["Block"]}),
    "rigid_settings": ("rigid", "Left", "rigid_active", {}),
    "rigid_type": ("rigid", "Left", "rigid_active", {"type": "ACTIVE"}),
    "rigid_shape": ("rigid", "Left", "rigid_active", {}),
    "rigid_world_populated": ("rigid", "Left", "rigid_active", {"min": 3}),
    "rigid_cache_baked": ("rigid", "Left", "rigid_active", {}),
    "rigid_constraint": ("rigid", "Left", "rigid_active", {"type": "HINGE", "partners": ["Right"]}),
    "rigid_constraint_no_collision": ("rigid", "Left", "rigid_active", {"type": "HINGE"}),
    "rigid_collision_modifier": ("rigid", "Left", "rigid_active", {}),
    "rigid_positive_mass": ("rigid", "Left", "rigid_active", {"min": 0.5, "max": 10}),
    "particle_system": ("particles", "Flag", "particle_emitter", {}),
    "particle_type": ("particles", "Flag", "particle_emitter", {"type": "EMITTER"}),
    "particle_source": ("particles", "Flag", "particle_emitter", {"source": "FACE", "min": 20}),
    "particle_cache_baked": ("particles", "Flag", "particle_emitter", {}),
    "particle_collision_partners": ("particles", "Flag", "particle_emitter", {"partners": ["Wall"]}),
    "particle_from_deformed": ("particles", "Flag", "particle_emitter", {"deformer": "CLOTH"}),
    "particle_force_fields": ("particles", "Flag", "particle_emitter", {"types": ["WIND"]}),
    "fluid_modifier": ("fluid", "Water", "fluid_domain", {}),
    "fluid_type": ("fluid", "Tap", "fluid_flow", FLOW),
    "fluid_domain_exists": ("fluid", "Tap", "fluid_flow", {"kind": "LIQUID"}),
    "fluid_flow_count": ("fluid", "Water", "fluid_domain", {"min": 1}),
    "fluid_cache_baked": ("fluid", "Water", "fluid_domain", {}),
    "fluid_dynamic_effector": ("fluid", "Paddle", "fluid_effector", {}),
    "fluid_guiding": ("guided", "Smoke", "fluid_domain", {}),
    "fluid_resolution": ("fluid", "Water", "fluid_domain", {"min": 32}),
    "fluid_mesh": ("fluid", "Water", "fluid_domain", {}),
    "dense_transform_keys": ("recorded", "Ball", "static", {}),
    "animated_shape_keys": ("blended", "Slab", "soft", {}),
    "static_has_cache": ("cloth", "", "static", {}),
    "static_has_rigid_world": ("rigid", "", "static", {}),
    "static_has_solver": ("cloth", "", "static", {}),
}
GONE = {"solver_enabled"}
CLOTH = {f"cloth_{one}" for one in ("cache_baked", "self_collision", "pin_group", "collision_partners")}
# What else must end with a change, of the predicates that are tried in the same scene.
FOLLOWS: dict[str, set[str]] = {
    "cloth_modifier": GONE | CLOTH | {"static_has_cache", "static_has_solver"},
    "cloth_cache_baked": {"static_has_cache"},
    "static_has_cache": {"cloth_cache_baked"},
    "static_has_solver": GONE | CLOTH | {"cloth_modifier", "static_has_cache"},
    "soft_modifier": {
        f"soft_{one}" for one in ("cache_baked", "collision_partners", "goal_group", "rigid_partners")
    },
    "soft_collision_partners": {"soft_rigid_partners"},
    "rigid_settings": {name for name in ASKED if name.startswith("rigid_")} - {"rigid_cache_baked"},
    "rigid_world_populated": {"rigid_settings", "rigid_constraint", "rigid_constraint_no_collision"}
    | {"static_has_rigid_world"},
    "rigid_constraint": {"rigid_constraint_no_collision"},
    "particle_system": {name for name in ASKED if name.startswith("particle_")},
    "particle_type": {"particle_cache_baked"},
    "fluid_modifier": {
        "fluid_domain_exists",
        "fluid_flow_count",
        "fluid_cache_baked",
        "fluid_resolution",
        "fluid_mesh",
    },
    "static_has_rigid_world": {
        "rigid_settings",
        "rigid_world_populated",
        "rigid_cache_baked",
        "rigid_constraint",
    }
    | {"rigid_constraint_no_collision"},
    "fluid_domain_exists": {"fluid_flow_count"},
    # Blender frees a fluid's bake when its resolution is set.
    "fluid_resolution": {"fluid_cache_baked"},
}


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Scene]:
    return facts_of("predicate_scenes.py", tmp_path_factory.mktemp("predicates"))


def judge(name: str, scene: Scene) -> PredicateVerdict:
    _, one, role, given = ASKED[name]
    cast = {each.name: (Unit((each,)),) for each in scene.objects}
    unit = Unit(tuple(each for each in scene.objects if each.name == one), role)
    predicate = PREDICATES[name]
    return predicate.judge(unit, AuditContext(scene, cast, 8), predicate.read(given))


@pytest.mark.blender
@pytest.mark.parametrize("name", PREDICATES)
def test_a_predicate_holds_until_its_cause_is_removed(name: str, scenes: dict[str, Scene]) -> None:
    whole, broken = judge(name, scenes[name]), judge(name, scenes[f"{name}/broken"])
    assert (whole.outcome, broken.outcome) == ("passed", "failed"), (whole.seen, broken.seen)


@pytest.mark.blender
@pytest.mark.parametrize("name", PREDICATES)
def test_a_change_ends_only_the_predicates_that_follow(name: str, scenes: dict[str, Scene]) -> None:
    same = [other for other in ASKED if ASKED[other][0] == ASKED[name][0] and other != name]
    held = {other for other in same if judge(other, scenes[name]).outcome == "passed"}
    ended = {other for other in held if judge(other, scenes[f"{name}/broken"]).outcome == "failed"}
    assert ended <= FOLLOWS.get(name, set()), "ended too"


@pytest.mark.blender
def test_seen_values_are_json_and_include_the_deciding_ones(scenes: dict[str, Scene]) -> None:
    seen = judge("fluid_cache_baked", scenes["fluid_cache_baked/broken"]).seen["domains"][0]
    assert seen["baked"] == ["data", "noise", "mesh", "particles", "guide"]
    assert seen["on_disk"]["mesh"][2] < 5


@pytest.mark.blender
def test_a_cache_that_ends_before_the_clip_is_not_baked_over_it(scenes: dict[str, Scene]) -> None:
    scene = scenes["cloth"]
    sheet = next(one for one in scene.objects if one.name == "Sheet")
    predicate = PREDICATES["cloth_cache_baked"]
    outcomes = [
        predicate.judge(Unit((sheet,), "cloth"), AuditContext(scene, {}, least), predicate.read({})).outcome
        for least in (12, 24)
    ]
    assert outcomes == ["passed", "failed"]


@pytest.mark.blender
def test_an_actor_of_a_flow_role_without_a_flow_is_in_no_domain(scenes: dict[str, Scene]) -> None:
    scene = scenes["fluid"]
    paddle = next(one for one in scene.objects if one.name == "Paddle")
    still = replace(paddle, modifiers=())
    predicate = PREDICATES["fluid_domain_exists"]
    outcomes = {
        role: predicate.judge(Unit((still,), role), AuditContext(scene), predicate.read({})).outcome
        for role in ("fluid_flow", "fluid_effector", "static")
    }
    assert outcomes == {"fluid_flow": "failed", "fluid_effector": "failed", "static": "passed"}


# The table


@pytest.mark.blender
def test_particles_need_no_cache_before_their_birth(scenes: dict[str, Scene]) -> None:
    late = judge("particle_cache_baked", scenes["particles"])
    assert (late.outcome, late.seen["caches"][0]["cache_range"]) == ("passed", [4, 12])


@pytest.mark.blender
def test_a_force_field_with_animated_strength_counts(scenes: dict[str, Scene]) -> None:
    gust = next(one for one in scenes["particles"].objects if one.name == "Gust")
    assert gust.force is not None
    assert gust.force.strength == 0
    stage, whole = AuditContext(scenes["particles"]), PREDICATES["solver_enabled"]
    assert whole.judge(Unit((gust,), "force"), stage, whole.read({})).outcome == "passed"
    fields = PREDICATES["particle_force_fields"]
    flag = Unit(tuple(one for one in scenes["particles"].objects if one.name == "Flag"))
    assert fields.judge(flag, stage, fields.read({"types": ["TURBULENCE"]})).outcome == "passed"


@pytest.mark.blender
def test_a_body_with_struts_inside_is_closed_and_a_sheet_is_open(scenes: dict[str, Scene]) -> None:
    shapes = {one.name: one.topology for name in ("soft", "cloth") for one in scenes[name].objects}
    assert (shapes["Jelly"], shapes["Sheet"]) == ("closed", "open")


def test_the_table_has_the_predicates_of_the_catalogue_in_their_groups() -> None:
    wanted = {
        name: group
        for group, _, names in (
            line.partition(": ") for line in CATALOGUE.replace("\n    ", " ").strip().splitlines()
        )
        for name in names.split()
    }
    assert {row.name: row.group for row in PREDICATES.values()} == wanted
    assert len(PREDICATES) == 42
    assert list(dict.fromkeys(row.group for row in PREDICATES.values())) == list(GROUPS)


@pytest.mark.parametrize("row", PREDICATES.values(), ids=lambda row: row.name)
def test_every_predicate_is_defined_in_one_paragraph(row: Predicate) -> None:
    assert row.judge.__name__ == row.name
    assert 80 < len(row.definition) < 1200
    assert "\n\n" not in (row.judge.__doc__ or "")


@pytest.mark.parametrize("row", PREDICATES.values(), ids=lambda row: row.name)
def test_unknown_parameters_are_refused_by_name(row: Predicate) -> None:
    with pytest.raises(ValueError, match=f"{row.name}: .*unheard_of"):
        row.read({"unheard_of": 1})


def test_two_predicates_of_one_name_are_refused() -> None:
    def twice(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
        return verdict_of(bool(unit and stage and params))

    with pytest.raises(ValueError, match="twice"):
        by_name([Predicate("twice", "cloth", twice), Predicate("twice", "fluid", twice)])


def test_the_reference_lists_every_definition_and_is_up_to_date() -> None:
    from docs.generate.benchmark_pages import predicates_page

    text = predicates_page()
    assert all(f"### `{name}`" in text for name in PREDICATES)
    assert (REPO / "docs" / "predicates.md").read_text(encoding="utf-8") == text
