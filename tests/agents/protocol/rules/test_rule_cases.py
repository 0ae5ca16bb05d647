"""Every rule has a scene that keeps it, a twin that breaks it, and a picture of both on its page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from PIL import Image
from places import REPO
from rule_cases import CASES, judge

from agents.protocol.rules.catalogue import RULES

if TYPE_CHECKING:
    from live_session import LiveSession


PICTURES = REPO / "docs" / "rules"
IDS = [rule.id for rule in RULES]


@pytest.mark.blender
@pytest.mark.parametrize("rule", IDS)
def test_the_good_scene_keeps_the_rule_and_its_twin_breaks_it(session: LiveSession, rule: str) -> None:
    case = CASES[rule]
    good = judge(session, rule, case, good=True)
    assert [finding.message for finding in good.findings] == []
    assert good.passed == (rule,)
    session.empty()
    bad = judge(session, rule, case, good=False)
    assert bad.findings
    assert {(finding.rule, finding.outcome) for finding in bad.findings} == {(rule, "broken")}


def test_there_is_no_case_without_a_rule() -> None:
    assert sorted(CASES) == sorted(IDS)


@pytest.mark.parametrize("rule", IDS)
def test_the_picture_of_a_rule_is_there_and_small(rule: str) -> None:
    path = PICTURES / f"{rule}.png"
    assert path.is_file(), "make rule-pictures"
    assert path.stat().st_size <= 60_000
    with Image.open(path) as picture:
        assert 500 <= picture.width <= 1000
        assert 150 <= picture.height <= 700


def test_there_is_no_picture_without_a_rule() -> None:
    assert {path.stem for path in PICTURES.glob("*.png")} <= set(IDS)
