"""Each property holds of small scenes, and fails where the benchmark would let something pass."""

from __future__ import annotations

import os
import signal
import time
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from small_specs import DRAPE, POUR, ROOM, STILL, spec_like

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import PredicateVerdict
from bench.audit.untrusted_blend import Crashed
from bench.validity import variant_builder
from bench.validity.invariance.actor_names import actor_objects
from bench.validity.mutations.planning import MUTATIONS
from bench.validity.run import prove_property
from bench.validity.variant_builder import VariantBuilder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit
    from bench.validity.proof import Proof

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def drape(small_scenes: Path) -> Iterator[VariantBuilder]:
    with VariantBuilder(spec_like(DRAPE), small_scenes / "drape.blend") as builder:
        yield builder


@pytest.fixture(scope="module")
def pour(small_scenes: Path) -> Iterator[VariantBuilder]:
    with VariantBuilder(spec_like(POUR), small_scenes / "pour.blend") as builder:
        yield builder


@pytest.fixture(scope="module")
def room(small_scenes: Path) -> Iterator[VariantBuilder]:
    with VariantBuilder(spec_like(ROOM), small_scenes / "room.blend") as builder:
        yield builder


def faults(proof: Proof) -> dict[str, str]:
    assert not proof.unable
    return {row.name: row.why for row in proof.faults}


def otherwise(builder: VariantBuilder, **changed: Any) -> VariantBuilder:
    """The same builder with another spec."""
    other = object.__new__(VariantBuilder)
    other.__dict__ |= {**builder.__dict__, "spec": spec_like(DRAPE, **changed)}
    for known in ("reading", "audited"):
        other.__dict__.pop(known, None)
    return other


def state(folder: Path) -> dict[str, tuple[int, int]]:
    return {
        str(path): (path.stat().st_mtime_ns, path.stat().st_size)
        for path in folder.rglob("*")
        if path.is_file()
    }


# Satisfiable


def test_a_scene_that_meets_its_spec_is_satisfiable(
    drape: VariantBuilder, pour: VariantBuilder, room: VariantBuilder
) -> None:
    for builder in (drape, pour, room):
        assert faults(prove_property(builder, "satisfiable")) == {}


def test_an_unbaked_scene_does_not_meet_its_spec(small_scenes: Path) -> None:
    with VariantBuilder(spec_like(DRAPE), small_scenes / "slack.blend") as builder:
        [why] = faults(prove_property(builder, "satisfiable")).values()
    assert {"tablecloth: cloth_cache_baked", "domino: rigid_cache_baked"} <= set(why.split(", "))


# Counterfeits


def test_counterfeits_look_the_same_and_score_less(drape: VariantBuilder, pour: VariantBuilder) -> None:
    for builder, transferred in (
        (drape, {"moved": 2, "shaped": 1, "particles": 12}),
        (pour, {"reshaped": 1}),
    ):
        proof = prove_property(builder, "counterfeits")
        assert faults(proof) == {}
        assert [row.name for row in proof.rows] == ["keys", "files"]
        for row in proof.rows:
            assert row.values["transferred"] == transferred
            assert row.values["difference"] < 0.1 * row.values["difference_without_physics"]
            assert row.values["drop"] >= row.values["must_drop"] > 0.3


def test_a_static_scene_has_no_counterfeits(room: VariantBuilder) -> None:
    assert prove_property(room, "counterfeits").holds is None


def test_reports_checks_that_a_counterfeit_passes(
    drape: VariantBuilder,
) -> None:
    seen = [
        {"name": actor["name"], "role": "static", "must_have": ["renderable"]} for actor in DRAPE["actors"]
    ]
    builder = otherwise(drape, actors=seen)
    assert set(faults(prove_property(builder, "counterfeits"))) == {"keys", "files"}
    assert all(
        "does not tell it from the scene" in why
        for why in faults(prove_property(builder, "counterfeits")).values()
    )


def test_a_counterfeit_that_looks_different_proves_nothing(
    drape: VariantBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(VariantBuilder, "difference", lambda *_: 0.25)
    assert all(
        "does not look the same" in why for why in faults(prove_property(drape, "counterfeits")).values()
    )


# Mutations


# Of the drape, all mutations but two are seen to do so where one predicate always passes.
@pytest.mark.parametrize("name", [pytest.param("drape", marks=pytest.mark.whole), "pour", "room"])
def test_every_mutation_fails_its_check_and_no_other(name: str, request: pytest.FixtureRequest) -> None:
    builder: VariantBuilder = request.getfixturevalue(name)
    proof = prove_property(builder, "mutations")
    assert faults(proof) == {}
    broken = {row.values.get("predicate") for row in proof.rows if row.holds}
    asked = [
        check.predicate for actor in builder.spec.actors for check in (*actor.must_have, *actor.must_not_have)
    ]
    assert {*asked, *(check.predicate for check in builder.spec.assertions)} <= broken


def always(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
    del unit, stage, params
    return PredicateVerdict("passed", {})


def if_baked(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """Passes only if all cloth of the scene is baked, which has nothing to do with being renderable."""
    del unit, params
    cloths = [one.cloth for each in stage.scene.objects for one in each.modifiers if one.cloth]
    return PredicateVerdict("passed" if all(cloth.cache.is_baked for cloth in cloths) else "failed", {})


def test_detects_a_predicate_that_always_passes(
    drape: VariantBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    blind = replace(PREDICATES["cloth_cache_baked"], judge=always)
    monkeypatch.setitem(PREDICATES, "cloth_cache_baked", blind)
    found = faults(prove_property(otherwise(drape), "mutations"))
    assert set(found) == {
        "tablecloth: cloth_cache_baked by free bake CLOTH",
        "tablecloth: cloth_cache_baked by shorten cache CLOTH",
    }
    assert set(found.values()) == {"the check still passes"}


def test_detects_a_predicate_that_fails_without_a_reason(
    drape: VariantBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PREDICATES, "renderable", replace(PREDICATES["renderable"], judge=if_baked))
    few = {name: made if name == "cloth_cache_baked" else () for name, made in MUTATIONS.items()}
    monkeypatch.setattr("bench.validity.mutations.planning.MUTATIONS", few)
    found = faults(prove_property(otherwise(drape), "mutations"))
    assert "lamp: renderable" in found["tablecloth: cloth_cache_baked by free bake CLOTH"]


def test_reports_a_check_that_no_mutation_broke(
    drape: VariantBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("bench.validity.mutations.planning.MUTATIONS", dict.fromkeys(PREDICATES, ()))
    found = Counter(faults(prove_property(drape, "mutations")).values())
    assert set(found) == {"no mutation broke it"}
    assert found.total() == sum(len(actor.checks) for actor in drape.reading.audit.actors)


# Invariance


def test_a_scene_scores_the_same_after_every_rewrite(
    drape: VariantBuilder, pour: VariantBuilder, room: VariantBuilder
) -> None:
    applied: Counter[str] = Counter()
    for builder in (drape, pour, room):
        proof = prove_property(builder, "invariance")
        assert faults(proof) == {}
        applied.update(row.name for row in proof.rows if row.holds)
    assert applied == {
        **dict.fromkeys(("grouped", "renamed", "rescaled"), 3),
        **dict.fromkeys(("ungrouped", "instanced", "joined"), 2),
    }


def test_a_scene_in_centimetres_moves_as_before(drape: VariantBuilder) -> None:
    whole = drape.reading
    actors = actor_objects(drape.spec, whole.scene, whole.found)
    path, _ = drape.make("centimetres", "rewrite", kind="rescaled", actors=actors)
    scene = drape.read(path).scene
    assert scene.unit_scale == pytest.approx(0.01)
    bounds = [
        {
            (one.name, at.frame): (*(at.low or ()), *(at.high or ()))
            for one in each.objects
            for at in one.moments
        }
        for each in (whole.scene, scene)
    ]
    assert bounds[0].keys() == bounds[1].keys()
    assert all(bounds[1][key] == pytest.approx(values, abs=1e-3) for key, values in bounds[0].items())
    domino = [bounds[1]["Domino.001", frame][2] for frame in (1, 12)]
    assert domino[0] - domino[1] > 0.1, "it falls"


def test_reports_a_rewrite_that_confuses_two_actors(drape: VariantBuilder) -> None:
    table, lamp, floor = STILL
    confused = [*DRAPE["actors"][:3], table, {**lamp, "synonyms": ["ground"]}, floor]
    found = faults(prove_property(otherwise(drape, actors=confused), "invariance"))
    assert set(found) == {"renamed"}
    assert "floor: rigid_settings" in found["renamed"]


# Deterministic


def test_the_audit_is_the_same_in_every_process(drape: VariantBuilder, pour: VariantBuilder) -> None:
    for builder in (drape, pour):
        assert faults(prove_property(builder, "deterministic")) == {}


def test_reports_an_audit_that_changes_from_run_to_run(
    drape: VariantBuilder, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, runs = variant_builder.audit, Counter[str]()

    def wavering(*given: Any) -> Any:
        runs["audit"] += 1
        found = real(*given)
        return replace(found, blend={**found.blend, "run": runs["audit"]})

    monkeypatch.setattr(variant_builder, "audit", wavering)
    assert set(faults(prove_property(otherwise(drape), "deterministic"))) == {
        "another process",
        "a copy elsewhere, after other files",
    }


# The variant builder


def test_variants_leave_the_scene_and_its_caches_alone(small_scenes: Path) -> None:
    before = state(small_scenes)
    assert any("water" in name for name in before)
    with VariantBuilder(spec_like(POUR), small_scenes / "pour.blend") as builder:
        folder = builder.folder
        for change, options in (
            ("lose_fluid_files", {}),
            ("clear_fluid_bake", {}),
            ("lower_resolution", {"least": 12}),
            ("swap_fluid_type", {"kind": "DOMAIN"}),
            ("remove_domains", {}),
        ):
            path, _ = builder.make(change, "mutate", change=change, objects=["Water"], options=options)
            assert path.parent == folder
    assert state(small_scenes) == before
    assert not folder.exists()


def test_restarts_a_blender_that_crashed(room: VariantBuilder) -> None:
    blender = room._worker.opened(room.original)
    os.kill(blender._process.inner, signal.SIGKILL)
    while blender._process.alive:
        time.sleep(0.01)
    with pytest.raises(Crashed):
        blender.ask("save", doing="saving", path=str(room.folder / "dead.blend"))
    assert room.make("again", "mutate", change="hide_in_render", objects=["Floor"], options={})[1] == [
        "Floor"
    ]


def test_only_a_blender_that_had_other_files_is_asked_again(room: VariantBuilder) -> None:
    def ends(blender: Any) -> str:
        asked.append("ended")
        os.kill(blender._process.inner, signal.SIGKILL)
        while blender._process.alive:
            time.sleep(0.01)
        return blender.ask("save", doing="saving", path=str(room.folder / "dead.blend"))

    def ends_once(blender: Any) -> str:
        return "made" if asked else ends(blender)

    asked: list[str] = []
    room._worker.opened(room.original)
    assert room._worker.run(room.original, ends_once) == "made"
    room._worker.close()
    asked.clear()
    with pytest.raises(Crashed):
        room._worker.run(room.original, ends)
    assert asked == ["ended"]
