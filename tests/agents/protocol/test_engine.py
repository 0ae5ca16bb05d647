"""The engine: what becomes of rules that find, raise, cannot measure, or have nothing to judge."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from scenes import a_plan

from agents.protocol.engine import verify
from agents.protocol.facts import CollectionFacts, ObjectFacts, SceneFacts
from agents.protocol.measures.geometry import GapRequest
from agents.protocol.measures.requests import Measures, Unmeasured
from agents.protocol.rule import NotApplicable, Rule, RuleContext
from agents.protocol.rules.catalogue import BY_ID, RULES, select_rules
from agents.protocol.structure import SceneStructure
from agents.protocol.tolerances import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from agents.protocol.findings import Finding, Report, Severity
    from agents.protocol.measures.requests import Request

EMPTY = SceneFacts(version="5.1.2", scene="Scene", frame=1, frame_start=1, frame_end=1, fps=24)
LEG, TOP = GapRequest(("Leg",), ("Floor",)), GapRequest(("Top",), ("Leg",))
NEAR = {"value": {"distance": 0.5, "here": (0, 0, 0), "there": (0, 0, 0.5)}}


def no_blender(_requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
    pytest.fail("nothing was to be measured")


def rule(
    judge: Callable[[RuleContext, Measures], Iterable[Finding]],
    *requests: Request[Any],
    name: str = "X1",
    severity: Severity = "hard",
    needs_plan: bool = False,
) -> Rule:
    return Rule(name, name, severity, "about", "why", "Mend it.", judge, lambda _: requests, needs_plan)


def finds_nothing(_context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    yield from ()


def finds_one(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    del context
    yield rule(finds_nothing).finding(("Leg",), "It is loose.", measured=1.0)


def run(*rules: Rule, answers: list[dict[str, Any]] | None = None, plan: Any = None) -> Report:
    return verify(EMPTY, no_blender if answers is None else lambda _: answers, rules, plan)


def test_a_rule_that_finds_nothing_is_passed() -> None:
    report = run(rule(finds_nothing))
    assert (report.findings, report.passed, report.not_applicable) == ((), ("X1",), {})
    assert report.ok
    assert report.decided


def test_a_finding_of_a_hard_rule_is_not_ok_and_one_of_a_soft_rule_is() -> None:
    report = run(rule(finds_one))
    assert [one.message for one in report.findings] == ["It is loose."]
    assert report.findings[0].fix == "Mend it."
    assert (report.passed, report.ok, report.decided) == ((), False, True)

    def softly(_context: RuleContext, _measures: Measures) -> Iterator[Finding]:
        yield rule(finds_nothing, severity="soft").finding((), "Hm.")

    assert run(rule(softly, severity="soft")).ok


def fails(_context: RuleContext, _measures: Measures) -> Iterator[Finding]:
    yield from finds_one(_context, _measures)
    raise ZeroDivisionError("division by zero")


def test_a_rule_that_raises_is_an_error_and_never_passed_and_keeps_what_it_found() -> None:
    report = run(rule(fails), rule(finds_nothing, name="X2"))
    assert [(one.outcome, one.message) for one in report.findings] == [
        ("broken", "It is loose."),
        ("error", "The rule failed: ZeroDivisionError: division by zero."),
    ]
    assert report.passed == ("X2",)
    assert not report.ok
    assert not report.decided


def test_a_rule_that_cannot_say_what_it_needs_is_an_error() -> None:
    def asks(_context: RuleContext) -> Iterator[GapRequest]:
        yield LEG
        raise KeyError("Leg")

    broken = Rule("X1", "X1", "hard", "", "", "", finds_nothing, asks)
    report = run(broken, rule(finds_nothing, name="X2"))
    assert [(one.rule, one.outcome) for one in report.findings] == [("X1", "error")]
    assert report.passed == ("X2",)


def measures_one(request: GapRequest) -> Callable[[RuleContext, Measures], Iterator[Finding]]:
    def judge(_context: RuleContext, measures: Measures) -> Iterator[Finding]:
        found = measures[request]
        yield rule(finds_nothing).finding(("Leg",), "It is loose.", measured=found.distance)

    return judge


def test_what_is_asked_for_twice_is_measured_once_and_answered_by_its_own_type() -> None:
    asked: list[dict[str, Any]] = []

    def ask(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        asked.extend(requests)
        return [NEAR] * len(requests)

    rules = [
        rule(measures_one(LEG), LEG, TOP),
        rule(measures_one(LEG), LEG, GapRequest(("Leg",), ("Floor",))),
    ]
    report = verify(EMPTY, ask, rules)
    assert [one.measured for one in report.findings] == [0.5, 0.5]
    assert asked == [
        {"kind": "gap", "a": ("Leg",), "b": ("Floor",), "frame": None, "enough": 0.0},
        {"kind": "gap", "a": ("Top",), "b": ("Leg",), "frame": None, "enough": 0.0},
    ]


@pytest.mark.parametrize(
    ("answers", "reason"),
    [
        ([{"unmeasured": "'Leg' has no surface"}], "'Leg' has no surface"),
        ([{"unmeasured": ""}], "Blender gave no answer"),
        ([{}], "Blender gave no answer"),
        ([{"value": {"distance": "near"}}], "Blender's answer is invalid"),
        ([], "Blender gave 0 answers to 1 requests"),
        ([NEAR, NEAR], "Blender gave 2 answers to 1 requests"),
    ],
)
def test_what_could_not_be_measured_is_never_passed(answers: list[dict[str, Any]], reason: str) -> None:
    report = run(rule(measures_one(LEG), LEG), answers=answers)
    assert [(one.rule, one.severity, one.outcome) for one in report.findings] == [("X1", "hard", "undecided")]
    assert reason in report.findings[0].message
    assert report.findings[0].fix == "Mend it."
    assert (report.passed, report.ok, report.decided) == ((), False, False)


def test_one_answer_that_is_none_hides_no_other_one() -> None:
    answers = [{"value": {}}, NEAR]
    report = run(rule(measures_one(TOP), LEG, TOP), answers=answers)
    assert [(one.outcome, one.measured) for one in report.findings] == [("broken", 0.5)]


def test_what_a_rule_has_not_asked_for_is_not_measured() -> None:
    assert "it was not requested" in run(rule(measures_one(LEG))).findings[0].message


def test_a_blender_that_is_gone_is_no_finding() -> None:
    def lost(_requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        raise ConnectionError("Blender is gone")

    with pytest.raises(ConnectionError):
        verify(EMPTY, lost, [rule(measures_one(LEG), LEG)])


def test_rules_without_anything_to_judge_are_idle_and_not_passed() -> None:
    def has_nothing_to_judge(_context: RuleContext) -> Iterator[GapRequest]:
        raise NotApplicable("there are no legs")
        yield LEG

    def lazy(_context: RuleContext, _measures: Measures) -> Iterator[Finding]:
        raise NotApplicable("there is no floor")
        yield

    def late(_context: RuleContext, _measures: Measures) -> Iterator[Finding]:
        yield from finds_one(_context, _measures)
        raise NotApplicable("there is nothing else")

    report = run(
        Rule("X1", "X1", "hard", "", "", "", finds_nothing, has_nothing_to_judge),
        rule(lazy, name="X2"),
        rule(late, name="X3"),
        rule(finds_nothing, name="X4", needs_plan=True),
    )
    assert report.not_applicable == {
        "X1": "there are no legs",
        "X2": "there is no floor",
        "X4": "no plan was given",
    }
    assert report.passed == ()
    assert [one.message for one in report.findings] == ["It is loose."]


def test_a_plan_tightens_tolerances_and_loosens_none() -> None:
    seen: list[Any] = []

    def looks(context: RuleContext, _measures: Measures) -> Iterator[Finding]:
        seen.append(context.tolerances)
        yield from ()

    plan = a_plan(
        {"kind": "Upright", "a": "Lamp"},
        tolerances={"contact": 0.001, "turn": 9.0, "footprint": 0.5, "balance_share": 0.01, "wobble": 1.0},
    )
    report = run(rule(looks), plan=plan)
    assert seen[0].contact == 0.001
    assert seen[0].footprint == 0.5  # what must be there at least is tighter if it is more
    assert (seen[0].turn, seen[0].balance_share) == (TOLERANCES.turn, TOLERANCES.balance_share)
    messages = " ".join(one.message for one in report.findings)
    for told in ("turn cannot be loosened", "balance_share cannot be loosened", "no tolerance 'wobble'"):
        assert told in messages
    assert all((one.rule, one.outcome) == ("plan", "error") for one in report.findings)


@pytest.mark.parametrize(
    ("diagonal", "epsilon"),
    [(0.0, 0.002), (0.4, 0.002), (0.5, 0.0025), (1.9, 0.0095), (2.1, 0.01), (100, 0.01)],
)
def test_the_gap_of_a_contact_grows_with_the_smaller_one(diagonal: float, epsilon: float) -> None:
    assert TOLERANCES.contact_gap(diagonal) == pytest.approx(epsilon)


@pytest.mark.parametrize(("smallest", "noise"), [(0.0, 0.001), (0.1, 0.001), (0.2, 0.002), (3.0, 0.03)])
def test_noise_grows_with_the_smallest_dimension(smallest: float, noise: float) -> None:
    assert TOLERANCES.noise(smallest) == pytest.approx(noise)


def test_rules_are_chosen_by_name_and_family_in_their_order() -> None:
    assert [one.id for one in select_rules(["v2", " C ", "V1", ""])] == [
        "C1",
        "C2",
        "C3",
        "C4",
        "C5",
        "C6",
        "V1",
        "V2",
    ]
    assert len(BY_ID) == len(RULES)
    with pytest.raises(KeyError, match="Q"):
        select_rules(["C", "Q"])


# The structure that rules see


def scene(*objects: ObjectFacts, collections: tuple[CollectionFacts, ...]) -> SceneStructure:
    return SceneStructure(EMPTY.model_copy(update={"objects": objects, "collections": collections}))


def thing(name: str, kind: str = "MESH", **more: Any) -> ObjectFacts:
    return ObjectFacts(name=name, type=kind, matrix=(1.0,) * 16, surface=kind == "MESH", **more)


CHAIR = CollectionFacts(name="Chair", parents=("set",), role="object", objects=("Root", "Seat", "Leg"))
SET = CollectionFacts(name="set", parents=("",), role="system")


def test_names_stand_for_surfaces() -> None:
    found = scene(
        thing("Root", "EMPTY", is_root=True),
        thing("Seat"),
        thing("Leg", rendered=False),
        thing("Stray"),
        collections=(SET, CHAIR),
    )
    assert found.surfaces_of("Chair") == found.surfaces_of("Root") == ("Seat",)  # what renders show
    assert found.surfaces_of("Chair/Leg") == found.surfaces_of("Leg") == ("Leg",)
    assert found.surfaces_of("Stray") == ("Stray",)
    assert found.surfaces_of("Chair/Stray") == found.surfaces_of("Nobody") == found.surfaces_of("set") == ()
    assert found.systems_of(CHAIR) == {"set"}


def test_chains_and_collections_that_close_a_circle_come_to_an_end() -> None:
    loop = CollectionFacts(name="Loop", parents=("Chair", "Loop"), objects=("Leg",))
    found = scene(thing("Seat", parent="Leg"), thing("Leg", parent="Seat"), collections=(SET, CHAIR, loop))
    assert list(found.parents_of("Seat")) == ["Leg"]
    assert [one.name for one in found.by_name["Chair"].meshes] == ["Seat", "Leg"]
    assert found.can_move("Seat") is False
    assert found.systems_of(loop) == {"set"}


def test_unmeasured_says_why() -> None:
    with pytest.raises(Unmeasured, match="too far"):
        Measures({LEG: "too far"})[LEG]
