"""What the verifier found, in all the forms in which it is told."""

from __future__ import annotations

import io
import json
import math
from typing import Any

import pytest
from rich.console import Console

from agents.protocol.findings import Finding, Report
from agents.protocol.report.grouping import group_findings
from agents.protocol.report.json_report import as_json, dump_json, read_findings
from agents.protocol.report.markdown import as_text
from agents.protocol.report.sarif import as_sarif, sarif_failure
from agents.protocol.report.summary import VerificationScope, coverage, exit_code, verdict
from agents.protocol.report.table import as_table
from agents.protocol.report.text_format import fold_names, format_rule_ids, format_value
from agents.protocol.rule import NO_PLAN, NO_ROLES
from agents.protocol.rules.catalogue import BY_ID, RULES
from simworlds.terminal.text import plain

V1, V2, C3, W2, W4 = (BY_ID[name] for name in ("V1", "V2", "C3", "W2", "W4"))
GAP = V1.finding(
    ("Leg", "Floor"),
    "'Leg' and 'Floor' are declared to touch (contact_with of 'Leg'), but are 5.0 mm apart.",
    measured=0.005,
    tolerance=0.002,
    unit="m",
    at=(1.0, 2.0, 0.0),
)


def crossing(a: str, b: str, depth: float) -> Finding:
    return V2.finding(
        (a, b),
        f"{a!r} and {b!r} penetrate each other by {depth * 1000:.1f} mm.",
        measured=depth,
        tolerance=0.001,
        unit="m",
        at=(0.0, 0.0, depth),
    )


def homeless(name: str) -> Finding:
    return C3.finding((name,), f"The mesh {name!r} is not in any object.", measured=0.0)


def checked(*names: str, **more: Any) -> VerificationScope:
    return VerificationScope(tuple(BY_ID[name] for name in names) if names else RULES, **more)


def report(*findings: Finding, passed: tuple[str, ...] = (), **not_applicable: str) -> Report:
    return Report(findings, passed, not_applicable, 1.25)


def shown(found: Report, what: VerificationScope, width: int = 132) -> str:
    console = Console(width=width, file=io.StringIO(), highlight=False)
    console.print(as_table(found, what, width))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


# Exit codes


@pytest.mark.parametrize(
    ("findings", "code"),
    [
        ((), 0),
        ((W4.finding((), "The scene has no camera."),), 0),
        ((GAP,), 1),
        ((W2.undecided(("Chair",), "it is open"),), 2),
        ((V2.undecided((), "it is open"),), 2),
        ((V2.undecided((), "it is open"), GAP), 1),
        ((Finding("V2", "hard", (), "The rule failed: ZeroDivisionError: x.", outcome="error"),), 2),
    ],
)
def test_the_exit_code_is_1_for_what_is_broken_and_2_for_what_could_not_be_told(
    findings: tuple[Finding, ...], code: int
) -> None:
    assert exit_code(report(*findings)) == code


# Folding


def test_findings_that_say_the_same_are_one_row_with_names_and_counts() -> None:
    names = ["Cube", *(f"Cube.{number:03d}" for number in range(1, 200))]
    (row,) = group_findings(homeless(name) for name in names)
    assert row.message == "The mesh … is not in any object."
    assert row.objects() == "Cube … Cube.199 (200)"
    assert len(row.findings) == 200


def test_the_worst_comes_first_and_ranges_are_told() -> None:
    (row,) = group_findings([crossing("A", "B", 0.002), crossing("C", "D", 0.25), crossing("E", "F", 0.01)])
    assert row.worst.objects == ("C", "D")
    assert row.objects().splitlines() == ["C · D", "E · F", "A · B"]
    assert (row.measured, row.tolerance) == ("2–250 mm", "1 mm")


def test_what_all_of_a_row_share_is_kept_in_its_message() -> None:
    findings = [
        V1.finding(("Leg", "Floor"), f"'Leg' and 'Floor' are {number} mm apart.") for number in (5, 7)
    ]
    (row,) = group_findings(findings)
    assert row.message == "'Leg' and 'Floor' are … mm apart."


def test_other_words_or_another_outcome_make_another_row() -> None:
    other = C3.finding(("Cube",), "The mesh 'Cube' is in 2 objects: 'A', 'B'.", measured=2.0)
    unsure = C3.undecided(("Cube",), "it is open")
    assert [len(row.findings) for row in group_findings([homeless("A"), other, homeless("B"), unsure])] == [
        2,
        1,
        1,
    ]


def test_hard_rows_come_before_soft_ones_and_broken_before_undecided() -> None:
    soft, unsure = W4.finding((), "The scene has no camera."), V1.undecided(("A", "B"), "it is open")
    assert [row.worst for row in group_findings([soft, unsure, GAP])] == [GAP, unsure, soft]


def test_names_with_quotes_and_numbers_do_not_come_apart() -> None:
    (row,) = group_findings([homeless("Bob's 3 chairs"), homeless('the "big" one')])
    assert row.message == "The mesh … is not in any object."


def test_a_part_that_all_share_is_told_once() -> None:
    findings = [
        BY_ID["G1"].finding((f"Leg.{number:03d}", "Chair"), f"The mesh 'Leg.{number:03d}' has no parent.")
        for number in range(5)
    ]
    (row,) = group_findings(findings)
    assert row.objects() == "Leg.000 … Leg.004 (5) · Chair"


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["A"], "A"),
        (["A", "B"], "A, B"),
        (["Leg.001", "Leg.002"], "Leg.001, Leg.002"),
        (["Wall 2", "Wall 10", "Wall 1"], "Wall 1 … Wall 10 (3)"),
        (["1", "2", "3"], "1, 2, 3"),
        (["A", "B", "C", "D", "E", "F"], "A, B, C, D and 2 more"),
        (["x.1", "x.2", "x.3", "A", "B", "C", "D"], "x.1 … x.3 (3), A, B, C and 1 more"),
        ([], ""),
    ],
)
def test_names_are_folded_by_their_numbers(names: list[str], told: str) -> None:
    assert fold_names(names) == told


def test_rules_that_follow_each_other_are_told_by_their_ends() -> None:
    order = ["C1", "C2", "C3", "C4", "G1", "G2", "V1"]
    assert format_rule_ids(["C1", "C2", "C3", "G1", "V1"], order) == "C1–C3, G1, V1"
    assert format_rule_ids(["C4", "G1", "G2"], order) == "C4, G1, G2"
    with_a_gap = ["T1", "T2", "T3", "T5", "T6", "T7"]
    assert format_rule_ids(with_a_gap, with_a_gap) == "T1–T3, T5–T7"


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (0.005, "m", "5 mm"),
        (0.0123456, "m", "12.3 mm"),
        (1.5, "m", "1.5 m"),
        (12.34, "°", "12.3°"),
        (3, "", "3"),
        (1, "frames", "1 frame"),
        (2, "frames", "2 frames"),
    ],
)
def test_small_lengths_are_told_in_millimetres(value: float, unit: str, told: str) -> None:
    assert format_value(value, unit) == told


def test_what_steers_terminals_or_is_no_text_is_taken_out() -> None:
    assert plain("a\x1b[31mb\nc\udcff") == "a�[31mb�c�"


# JSON


def test_json_keeps_every_finding_and_the_state_of_every_rule() -> None:
    found = report(
        *(homeless(f"Cube.{number:03d}") for number in range(200)), GAP, passed=("W4",), V2="there are fewer"
    )
    data = json.loads(dump_json(as_json(found, checked("C3", "V1", "V2", "W4", file="a.blend", frame=3))))
    assert len(data["findings"]) == 201
    assert data["findings"][-1] == {
        "rule": "V1",
        "severity": "hard",
        "objects": ["Leg", "Floor"],
        "message": GAP.message,
        "fix": V1.fix,
        "outcome": "broken",
        "frame": None,
        "measured": 0.005,
        "tolerance": 0.002,
        "unit": "m",
        "at": [1.0, 2.0, 0.0],
    }
    assert {rule["id"]: (rule["state"], rule["findings"]) for rule in data["rules"]} == {
        "C3": ("broken", 200),
        "V1": ("broken", 1),
        "V2": ("idle", 0),
        "W4": ("holds", 0),
    }
    assert data["rules"][2]["reason"] == "there are fewer"
    assert (data["ok"], data["decided"], data["file"], data["frame"]) == (False, True, "a.blend", 3)


def test_findings_are_read_from_json_as_they_were_written() -> None:
    named = V1.finding(("a\udcffb",), "It is named as nobody would.")
    found = report(GAP, homeless("Cube"), V2.undecided(("Leg",), "it is open"), named)
    data = json.loads(dump_json(as_json(found, checked())))
    assert read_findings(data) == found.findings


def test_json_is_json_whatever_was_measured_and_named() -> None:
    strange = V1.finding(("a\udcffb",), "x", measured=math.inf, tolerance=math.nan)
    text = dump_json(as_json(report(strange), checked("V1")))
    data = json.loads(text.encode())
    assert (data["findings"][0]["measured"], data["findings"][0]["tolerance"]) == (None, None)
    assert data["findings"][0]["objects"] == ["a\udcffb"]


# SARIF


def test_sarif_has_what_its_schema_requires() -> None:
    failed = Finding("V2", "hard", (), "The rule failed: ZeroDivisionError: x.", outcome="error")
    unsure, soft = V2.undecided(("A",), "it is open"), W4.finding((), "The scene has no camera.")
    what = checked("V1", "V2", "W4", file="scenes/a room.blend")
    data = json.loads(dump_json(as_sarif(report(GAP, unsure, failed, soft), what)))
    assert data["version"] == "2.1.0"
    assert data["$schema"].endswith("sarif-schema-2.1.0.json")
    (run,) = data["runs"]
    driver = run["tool"]["driver"]
    assert driver["name"]
    ids = [rule["id"] for rule in driver["rules"]]
    assert ids == ["V1", "V2", "W4"]
    for rule in driver["rules"]:
        assert all(rule[field]["text"] for field in ("shortDescription", "fullDescription", "help"))
        assert rule["defaultConfiguration"]["level"] in {"error", "warning"}
    assert [(one["kind"], one["level"]) for one in run["results"]] == [
        ("fail", "error"),
        ("open", "none"),  # the standard allows no other level for what is open
        ("fail", "warning"),
    ]
    for result in run["results"]:
        assert result["message"]["text"]
        assert ids[result["ruleIndex"]] == result["ruleId"]
        (location,) = result["locations"]
        place = location["physicalLocation"]["artifactLocation"]
        assert place == {"uri": "scenes/a%20room.blend", "index": 0}
        assert run["artifacts"][place["index"]]["location"]["uri"] == place["uri"]
    names = [one["name"] for one in run["results"][0]["locations"][0]["logicalLocations"]]
    assert names == ["Leg", "Floor"]
    assert run["results"][0]["properties"] == {
        "measured": 0.005,
        "tolerance": 0.002,
        "unit": "m",
        "at": [1.0, 2.0, 0.0],
    }
    (invocation,) = run["invocations"]
    assert invocation["executionSuccessful"] is False
    (notification,) = invocation["toolExecutionNotifications"]
    assert notification["level"] == "error"
    assert notification["associatedRule"] == {"id": "V2"}


def test_the_same_finding_has_the_same_fingerprint_wherever_it_is_measured_anew() -> None:
    def fingerprint(finding: Finding) -> dict[str, str]:
        run = as_sarif(report(finding), checked("V2"))["runs"][0]
        return run["results"][0]["partialFingerprints"]

    assert fingerprint(crossing("A", "B", 0.01)) == fingerprint(crossing("A", "B", 0.02))
    assert fingerprint(crossing("A", "B", 0.01)) != fingerprint(crossing("A", "C", 0.01))


def test_an_absolute_path_is_a_uri_and_an_open_scene_has_none() -> None:
    run = as_sarif(report(GAP), checked("V1", file="/tmp/a b.blend"))["runs"][0]
    assert run["artifacts"][0]["location"]["uri"] == "file:///tmp/a%20b.blend"
    run = as_sarif(report(GAP), checked("V1"))["runs"][0]
    assert "artifacts" not in run
    assert "physicalLocation" not in run["results"][0]["locations"][0]


def test_a_relative_path_that_is_not_utf_8_is_a_uri_too() -> None:
    run = as_sarif(report(GAP), checked("V1", file="scenes/a\udcff.blend"))["runs"][0]
    assert run["artifacts"][0]["location"]["uri"] == "scenes/a%3F.blend"


def test_a_run_that_came_to_nothing_is_sarif_too() -> None:
    (run,) = sarif_failure("There is no file x.")["runs"]
    assert run["results"] == []
    assert run["invocations"][0]["executionSuccessful"] is False
    assert run["invocations"][0]["toolExecutionNotifications"][0]["message"]["text"] == "There is no file x."


# Words


def test_the_table_says_rule_objects_measured_tolerance_and_what_to_do() -> None:
    text = shown(report(GAP, passed=("W4",)), checked("V1", "W4", file="room.blend", frame=1))
    for told in (
        "room.blend, frame 1",
        "V1",
        "contact",
        "Leg · Floor",
        "5 mm",
        "2 mm",
        "Move one of the two",
    ):
        assert told in text
    assert "Not ok: 1 hard finding of 1 rule." in text


def test_the_table_fits_a_narrow_terminal_and_tells_markup_as_it_is() -> None:
    text = shown(report(homeless("[bold]Cube[/bold]")), checked("C3"), width=72)
    assert "[bold]Cube[/bold]" in text
    assert max(map(len, text.splitlines())) <= 72


def test_what_was_not_checked_is_told_with_its_reason() -> None:
    lines = coverage(
        report(
            passed=("W4",),
            C1=NO_ROLES,
            R1=NO_PLAN,
            R6="the plan has no StableAgainst",
            R8="the plan has no Aperture",
        ),
        checked("C1", "W4", "R1", "R6", "R8"),
    )
    assert lines == [
        "Checked: W4.",
        "Passed: W4.",
        f"Not checked: C1 ({NO_ROLES}); R1 (no plan was given); R6, R8 (nothing to judge).",
    ]


def test_a_scene_without_tags_is_told_first_by_what_it_is_judged() -> None:
    found, scope = (
        report(homeless("Cube"), passed=("V2", "W4"), C1=NO_ROLES),
        checked("C1", "C3", "V2", "W4", file="room.blend"),
    )
    told = " ".join(shown(found, scope, width=400).split())
    assert told.index("gaps and missing support are not checked") < told.index("Not ok")
    assert "What needs no tags: penetration (V2), camera (W4)." in told
    assert "simworlds verify room.blend --rules V2,W4" in told
    assert "blender_group" not in told
    assert "blender_group" in as_text(found, scope)
    assert "tags" not in shown(report(passed=("W4",)), checked("W4"))


def test_what_was_not_decided_does_not_count_as_checked() -> None:
    unsure = V2.undecided((), "it is open")
    assert coverage(report(unsure, passed=("W4",)), checked("V2", "W4")) == [
        "Checked: W4.",
        "Passed: W4.",
        "Undecided, at least in part: V2.",
    ]
    assert coverage(report(unsure, crossing("A", "B", 0.1)), checked("V2"))[0] == "Checked: V2."


def test_the_verdict_counts_what_is_hard_soft_and_undecided() -> None:
    soft, unsure = W4.finding((), "The scene has no camera."), V2.undecided((), "it is open")
    assert verdict(report()) == "Ok: no hard finding."
    assert verdict(report(soft)) == "Ok: no hard finding, 1 soft finding."
    assert verdict(report(unsure)) == "Undecided: no hard finding, 1 could not be decided."
    told = verdict(report(GAP, homeless("A"), homeless("B"), soft, unsure))
    assert told == "Not ok: 3 hard findings of 2 rules, 1 soft finding, 1 could not be decided."


def test_the_text_for_models_names_everything_once() -> None:
    found = report(crossing("A", "B", 0.002), crossing("C", "D", 0.25), GAP)
    text = as_text(found, checked("V1", "V2"))
    assert "**V2 penetration** (hard), 2 times: … and … penetrate each other by … mm." in text
    assert "Objects: C · D; A · B." in text
    assert "[measured 2–250 mm, tolerance 1 mm]" in text
    assert GAP.message in text
    assert text.count(V2.fix) == 1
    assert text.count(V1.fix) == 1
