"""Each property holds of small scenes, and is found wanting where the benchmark would let something pass."""

from __future__ import annotations

import os
import signal
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from small_specs import DRAPE, POUR, ROOM, STILL, spec_like

from bench.audit.predicates.catalogue import PREDICATES
from bench.audit.predicates.predicate import PredicateVerdict
from bench.audit.untrusted_blend import Crashed
from bench.validity import variant_builder as desks
from bench.validity.invariance.actor_names import cast_of
from bench.validity.run import prove_on
from bench.validity.variant_builder import Desk

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from bench.audit.predicates.predicate import AuditContext, PredicateParams, Unit
    from bench.validity.proof import Proof

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def drape(small_scenes: Path) -> Iterator[Desk]:
    with Desk(spec_like(DRAPE), small_scenes / "drape.blend") as desk:
        yield desk


@pytest.fixture(scope="module")
def pour(small_scenes: Path) -> Iterator[Desk]:
    with Desk(spec_like(POUR), small_scenes / "pour.blend") as desk:
        yield desk


@pytest.fixture(scope="module")
def room(small_scenes: Path) -> Iterator[Desk]:
    with Desk(spec_like(ROOM), small_scenes / "room.blend") as desk:
        yield desk


def faults(proof: Proof) -> dict[str, str]:
    assert not proof.unable
    return {row.name: row.why for row in proof.faults}


def otherwise(desk: Desk, **changed: Any) -> Desk:
    """The same desk, with another spec on it."""
    other = object.__new__(Desk)
    other.__dict__ |= {**desk.__dict__, "spec": spec_like(DRAPE, **changed)}
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


def test_a_scene_that_meets_its_spec_is_satisfiable(drape: Desk, pour: Desk, room: Desk) -> None:
    for desk in (drape, pour, room):
        assert faults(prove_on(desk, "satisfiable")) == {}


def test_a_scene_that_is_not_baked_does_not_meet_its_spec(small_scenes: Path) -> None:
    with Desk(spec_like(DRAPE), small_scenes / "slack.blend") as desk:
        [why] = faults(prove_on(desk, "satisfiable")).values()
    assert {"tablecloth: cloth_cache_baked", "domino: rigid_cache_baked"} <= set(why.split(", "))


# Twins


def test_twins_look_the_same_and_are_told_from_the_scene(drape: Desk, pour: Desk) -> None:
    for desk, transferred in (
        (drape, {"moved": 2, "shaped": 1, "particles": 12}),
        (pour, {"reshaped": 1}),
    ):
        proof = prove_on(desk, "twins")
        assert faults(proof) == {}
        assert [row.name for row in proof.rows] == ["keys", "files"]
        for row in proof.rows:
            assert row.values["transferred"] == transferred
            assert row.values["difference"] < 0.1 * row.values["difference_without_physics"]
            assert row.values["drop"] >= row.values["must_drop"] > 0.3


def test_a_still_scene_has_no_twins(room: Desk) -> None:
    assert prove_on(room, "twins").holds is None


def test_checks_that_see_only_what_is_shown_let_a_twin_pass_and_that_is_reported(drape: Desk) -> None:
    seen = [
        {"name": actor["name"], "role": "static", "must_have": ["renderable"]} for actor in DRAPE["actors"]
    ]
    desk = otherwise(drape, actors=seen)
    assert set(faults(prove_on(desk, "twins"))) == {"keys", "files"}
    assert all("not told" in why for why in faults(prove_on(desk, "twins")).values())


def test_a_twin_that_looks_otherwise_proves_nothing(drape: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Desk, "difference", lambda *_: 0.25)
    assert all("does not look the same" in why for why in faults(prove_on(drape, "twins")).values())


# Sabotages


def test_every_sabotage_is_seen_and_nothing_else_is(drape: Desk, pour: Desk, room: Desk) -> None:
    for desk in (drape, pour, room):
        proof = prove_on(desk, "sabotages")
        assert faults(proof) == {}
        broken = {row.values.get("predicate") for row in proof.rows if row.holds}
        asked = [
            check.predicate
            for actor in desk.spec.actors
            for check in (*actor.must_have, *actor.must_not_have)
        ]
        assert {*asked, *(check.predicate for check in desk.spec.assertions)} <= broken


def always(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
    del unit, stage, params
    return PredicateVerdict("passed", {})


def if_baked(unit: Unit, stage: AuditContext, params: PredicateParams) -> PredicateVerdict:
    """Lets a thing be seen only where all cloth of the scene is baked, which has nothing to do with it."""
    del unit, params
    cloths = [one.cloth for each in stage.scene.objects for one in each.modifiers if one.cloth]
    return PredicateVerdict("passed" if all(cloth.cache.is_baked for cloth in cloths) else "failed", {})


def test_a_predicate_that_always_passes_is_found_out(drape: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    blind = replace(PREDICATES["cloth_cache_baked"], judge=always)
    monkeypatch.setitem(PREDICATES, "cloth_cache_baked", blind)
    found = faults(prove_on(otherwise(drape), "sabotages"))
    assert set(found) == {
        "tablecloth: cloth_cache_baked by free CLOTH",
        "tablecloth: cloth_cache_baked by shorten CLOTH",
    }
    assert set(found.values()) == {"the check still passes"}


def test_a_predicate_that_fails_for_no_reason_is_found_out(
    drape: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PREDICATES, "renderable", replace(PREDICATES["renderable"], judge=if_baked))
    found = faults(prove_on(otherwise(drape), "sabotages"))
    assert "lamp: renderable" in found["tablecloth: cloth_cache_baked by free CLOTH"]


def test_a_check_that_nothing_has_broken_is_reported(drape: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("bench.validity.mutations.planning.SABOTAGES", dict.fromkeys(PREDICATES, ()))
    found = Counter(faults(prove_on(drape, "sabotages")).values())
    assert set(found) == {"nothing has broken it"}
    assert found.total() == sum(len(actor.checks) for actor in drape.reading.audit.actors)


# Fair


def test_a_scene_scores_the_same_in_every_guise(drape: Desk, pour: Desk, room: Desk) -> None:
    applied: Counter[str] = Counter()
    for desk in (drape, pour, room):
        proof = prove_on(desk, "fair")
        assert faults(proof) == {}
        applied.update(row.name for row in proof.rows if row.holds)
    assert applied == {
        **dict.fromkeys(("grouped", "renamed", "rescaled"), 3),
        **dict.fromkeys(("ungrouped", "instanced", "joined"), 2),
    }


def test_a_scene_in_centimetres_moves_as_it_did(drape: Desk) -> None:
    whole = drape.reading
    cast = cast_of(drape.spec, whole.scene, whole.found)
    path, _ = drape.make("centimetres", "guise", guise="rescaled", cast=cast)
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


def test_a_name_that_is_two_actors_makes_a_guise_unfair_and_that_is_reported(drape: Desk) -> None:
    table, lamp, floor = STILL
    confused = [*DRAPE["actors"][:3], table, {**lamp, "synonyms": ["ground"]}, floor]
    found = faults(prove_on(otherwise(drape, actors=confused), "fair"))
    assert set(found) == {"renamed"}
    assert "floor: rigid_settings" in found["renamed"]


# Deterministic


def test_an_audit_is_the_same_in_every_process(drape: Desk, pour: Desk) -> None:
    for desk in (drape, pour):
        assert faults(prove_on(desk, "deterministic")) == {}


def test_an_audit_that_changes_from_run_to_run_is_reported(
    drape: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    real, runs = desks.audit, Counter[str]()

    def wavering(*given: Any) -> Any:
        runs["audit"] += 1
        found = real(*given)
        return replace(found, blend={**found.blend, "run": runs["audit"]})

    monkeypatch.setattr(desks, "audit", wavering)
    assert set(faults(prove_on(otherwise(drape), "deterministic"))) == {
        "another process",
        "a copy elsewhere, after other files",
    }


# The desk


def test_nothing_that_is_done_touches_the_scene_or_its_caches(small_scenes: Path) -> None:
    before = state(small_scenes)
    assert any("water" in name for name in before)
    with Desk(spec_like(POUR), small_scenes / "pour.blend") as desk:
        folder = desk.folder
        for change, options in (
            ("lose_files", {}),
            ("forget_bake", {}),
            ("coarsen", {"least": 12}),
            ("swap", {"kind": "DOMAIN"}),
            ("remove_domains", {}),
        ):
            path, _ = desk.make(change, "sabotage", change=change, objects=["Water"], options=options)
            assert path.parent == folder
    assert state(small_scenes) == before
    assert not folder.exists()


def test_a_blender_that_crashes_is_started_again(room: Desk) -> None:
    shop = room._workshop.opened(room.original)
    os.killpg(shop._process.pid, signal.SIGKILL)
    with pytest.raises(Crashed):
        shop.ask("save", doing="saving", path=str(room.folder / "dead.blend"))
    assert room.make("again", "sabotage", change="hide", objects=["Floor"], options={})[1] == ["Floor"]
