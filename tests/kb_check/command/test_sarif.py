"""Findings as SARIF, compared with what the standard says of the parts that are written."""

from __future__ import annotations

import copy
import json
from typing import TYPE_CHECKING, Any

import pytest
from jsonschema import Draft202012Validator, ValidationError

from kb_check.command.formats.sarif import as_sarif
from kb_check.command.report import FileReport, Report
from kb_check.findings import Edit, Finding, Fix, Span
from kb_check.text.source import Cell, Source

if TYPE_CHECKING:
    from collections.abc import Callable

    from kb_check.checker import Checker

TEXT = {"type": "string"}
PLACE = {"type": "integer", "minimum": 1}
INDEX = {"type": "integer", "minimum": 0}
LEVEL = {"enum": ["none", "note", "warning", "error"]}


def obj(required: str = "", **properties: Any) -> dict[str, Any]:
    """An object that has no other properties than these."""
    return {
        "type": "object", "required": required.split(), "properties": properties, "additionalProperties": False,
    }  # fmt: skip


def array(items: Any, least: int = 0, *, unique: bool = False) -> dict[str, Any]:
    return {"type": "array", "items": items, "minItems": least, "uniqueItems": unique}


MESSAGE = obj("text", text=TEXT)
LOCATION = obj(uri={"type": "string", "minLength": 1, "pattern": "^[!-~]+$"}, index=INDEX)
REGION = obj("startLine", startLine=PLACE, startColumn=PLACE, endLine=PLACE, endColumn=PLACE)
RULE = obj(
    "id", id=TEXT, shortDescription=MESSAGE, help=obj("text", text=TEXT, markdown=TEXT),
    defaultConfiguration=obj(level=LEVEL),
)  # fmt: skip
CHANGE = obj(
    "artifactLocation replacements",
    artifactLocation=LOCATION,
    replacements=array(obj("deletedRegion", deletedRegion=REGION, insertedContent=obj(text=TEXT)), 1),
)
RESULT = obj(
    "message", message=MESSAGE, ruleId=TEXT, ruleIndex=INDEX, level=LEVEL,
    locations=array(obj(physicalLocation=obj("artifactLocation", artifactLocation=LOCATION, region=REGION))),
    partialFingerprints={"type": "object", "additionalProperties": TEXT},
    fixes=array(obj("artifactChanges", description=MESSAGE, artifactChanges=array(CHANGE, 1)), unique=True),
)  # fmt: skip
RUN = obj(
    "tool", tool=obj("driver", driver=obj("name", name=TEXT, rules=array(RULE, unique=True))),
    columnKind={"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
    invocations=array(
        obj(
            "executionSuccessful", executionSuccessful={"type": "boolean"},
            toolExecutionNotifications=array(obj("message", message=MESSAGE, level=LEVEL)),
        )
    ),
    artifacts=array(obj(location=LOCATION), unique=True), results=array(RESULT), properties={"type": "object"},
    automationDetails=obj(id=TEXT),
)  # fmt: skip
LOG = obj(
    "version runs", **{"$schema": {"type": "string", "format": "uri"}},
    version={"const": "2.1.0"}, runs=array(RUN),
)  # fmt: skip


def sarif(*files: FileReport, faults: tuple[str, ...] = ()) -> dict[str, Any]:
    return json.loads(as_sarif(Report("5.1", list(files), list(faults))))


def judge(log: dict[str, Any]) -> None:
    """Raises ValidationError for what the standard does not allow, or what points nowhere."""
    Draft202012Validator(LOG).validate(log)
    for run in log["runs"]:
        rules, artifacts = run["tool"]["driver"]["rules"], run["artifacts"]
        for result in run["results"]:
            assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
            for place in result["locations"]:
                location = place["physicalLocation"]["artifactLocation"]
                assert artifacts[location["index"]]["location"]["uri"] == location["uri"]
    names = [run.get("automationDetails") for run in log["runs"]]
    assert len({str(name) for name in names}) == len(names), "a code host takes only one of them"


@pytest.fixture(scope="module")
def log() -> dict[str, Any]:
    span = Span(1, 0, 1, 1)
    fix = Fix("Write it", (Edit(span, "ü"), Edit(Span(1, 1, 1, 1), "")), sure=True)
    found = [
        Finding("unknown-name", "error", span, "wrong", fix=fix),
        Finding("unused-ignore", "note", Span(9, 0, 9, 0), "a line that is not there"),
        Finding("syntax-error", "error", Span(1, 0, 1, 0), "no \udcff letter"),
    ]
    cells = Source("x\n", cells=(Cell(3, 1),))
    return sarif(
        FileReport("a dir/ä#?.py", Source("x\n"), found),
        FileReport("/top/b.py", Source("x\n"), found[:1]),
        FileReport("c.ipynb", cells, found[:1]),
        FileReport("d.py", Source(""), []),
        faults=("e.py cannot be read.",),
    )


def test_every_kind_of_finding_is_as_the_standard_says(log: dict[str, Any]) -> None:
    judge(log)
    assert len(log["runs"][0]["results"]) == 5
    assert not log["runs"][0]["invocations"][0]["executionSuccessful"]


def test_what_is_really_found_is_too(checker: Checker) -> None:
    code = "import bpy\nbpy.context.object.draw_type = 'WIRE'\nx = bpy.context.scene.nothing\ndef f(:\n"
    found = sarif(FileReport("a.py", Source(code), checker.check(code)))
    judge(found)
    assert {result["ruleId"] for result in found["runs"][0]["results"]} >= {
        "unknown-attribute",
        "syntax-error",
    }


def test_each_of_several_versions_is_a_run_of_its_own() -> None:
    found = [Finding("unknown-name", "error", Span(1, 0, 1, 1), "wrong")]
    older, newer = (
        Report(version, [FileReport("a.py", Source("x\n"), findings)])
        for version, findings in (("4.5", []), ("5.1", found))
    )
    log = json.loads(as_sarif(older, newer))
    judge(log)
    assert [(run["properties"]["blender"], len(run["results"])) for run in log["runs"]] == [
        ("4.5", 0),
        ("5.1", 1),
    ]
    assert [run["automationDetails"]["id"] for run in log["runs"]] == [
        "simworlds-check/blender-4.5/",
        "simworlds-check/blender-5.1/",
    ]


@pytest.mark.parametrize(
    "damage",
    [
        lambda run: run.pop("tool"),
        lambda run: run["results"][0].pop("message"),
        lambda run: run["results"][0].update(level="fatal"),
        lambda run: run["results"][0]["locations"][0]["physicalLocation"]["region"].update(startColumn=0),
        lambda run: run["results"][0]["fixes"][0].update(artifactChanges=[]),
        lambda run: run["artifacts"][0]["location"].update(uri="a dir/b.py"),
        lambda run: run["invocations"][0].pop("executionSuccessful"),
        lambda run: run["tool"]["driver"].update(colour="red"),
    ],
)
def test_what_the_standard_refuses_is_refused(log: dict[str, Any], damage: Callable[[Any], object]) -> None:
    broken = copy.deepcopy(log)
    damage(broken["runs"][0])
    with pytest.raises(ValidationError):
        judge(broken)
