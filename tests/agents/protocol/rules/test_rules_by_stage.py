"""Which rules judge which stage."""

from __future__ import annotations

from itertools import pairwise

from agents.plan.part import STAGES, Stage
from agents.protocol.rules.catalogue import BY_ID, RULES
from agents.protocol.rules_by_stage import FIRST_STAGES, rules_of


def ids(stage: Stage, **more: bool) -> list[str]:
    return [rule.id for rule in rules_of(stage, **more)]


def test_a_scene_that_does_not_move_yet_is_judged_by_what_stands() -> None:
    later = {"R14", "R15", "R18", "R19", "W4", "W5", "W6"}
    still = [rule.id for rule in RULES if rule.id[0] != "T" and rule.id not in later]
    for stage in ("modeling", "uv", "texture"):
        assert ids(stage) == still


def test_solvers_are_judged_when_they_are_set_up_and_bakes_when_things_move() -> None:
    for edit in (False, True):
        setup, motion = (set(ids(stage, edit=edit)) for stage in ("deformation_setup", "motion"))
        assert "R15" in setup
        assert "R19" in motion - setup


def test_motion_is_judged_from_its_stage_on_and_framing_from_the_cameras() -> None:
    assert ids("motion") == [rule.id for rule in RULES if rule.id not in {"R14", "W4", "W5", "W6"}]
    assert ids("camera") == [rule.id for rule in RULES if rule.id != "W5"]
    for stage in ("light", "render"):
        assert ids(stage) == [rule.id for rule in RULES]


def test_what_holds_at_one_stage_must_go_on_to_hold() -> None:
    for before, after in pairwise(STAGES):
        assert set(ids(before)) <= set(ids(after))


def test_the_table_names_rules_and_families_that_there_are() -> None:
    families = {rule.id[0] for rule in RULES}
    assert set(FIRST_STAGES) <= families | set(BY_ID)


def test_an_edited_file_has_no_plan_to_be_compared_with() -> None:
    for stage in STAGES:
        assert ids(stage, edit=True) == [rule.id for rule in rules_of(stage) if not rule.needs_plan]
    assert "R15" in ids("motion", edit=True)


def test_a_file_that_knows_no_protocol_is_not_judged_by_its_layout() -> None:
    left = ids("motion", edit=True, tagged=False)
    assert not {one[0] for one in left} & {"C", "G"}
    assert {"V1", "V2", "R4", "R15"} <= set(left)
    assert ids("motion", tagged=False) == ids("motion"), "what is made always knows it"
