"""The report: verdicts that are true, and every figure in its place."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from bench.markdown_tables import Table
from measurements.kept_parts import keep, kept_part, told_by_conditions
from measurements.main import main
from measurements.report import ReportPart, TargetFigure, markdown, targets_table, write
from measurements.targets import TARGETS, Target, format_value
from simworlds.errors import UserError

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("target", "value", "reached"),
    [
        (Target("a", "a", "share", 0.75, at_least=True), 0.75, True),
        (Target("a", "a", "share", 0.75, at_least=True), 0.7499, False),
        (Target("a", "a", "ms", 4), 4.0, True),
        (Target("a", "a", "ms", 4), 4.01, False),
        (Target("a", "a", "ms"), 4000.0, None),
    ],
)
def test_a_target_is_reached_on_one_side_only(target: Target, value: float, reached: bool | None) -> None:
    assert target.reached(value) is reached


def test_a_narrow_miss_is_not_rounded_to_reached() -> None:
    assert format_value(0.8496, "share") != "0.85"
    row = targets_table([TargetFigure("hit1", 0.8496)]).rows[0]
    assert "NOT reached" in row


def test_figures_are_in_the_order_of_targets_and_counted() -> None:
    found = targets_table(
        [TargetFigure("size", 76.0), TargetFigure("members", 1.0), TargetFigure("hit1", 0.9)]
    )
    assert [row[0] for row in found.rows] == [TARGETS[key].what for key in ("hit1", "members", "size")]
    assert found.note.startswith("1 of 2 targets reached")


def test_names_a_skipped_part_with_the_reason() -> None:
    text = markdown([ReportPart("server", skipped=("simworlds docs failed",))], {"date": "today"})
    assert "- server: simworlds docs failed" in text
    assert "- date: today" in text


def test_writes_markdown_and_json(tmp_path: Path) -> None:
    parts = [ReportPart("builds", (TargetFigure("size", 50.0, "just built"),), data={"builds": [1]})]
    text = write(tmp_path / "new" / "reports", parts, {"commit": "abc"})
    folder = tmp_path / "new" / "reports"
    assert (folder / "bench.md").read_text(encoding="utf-8") == text
    data = json.loads((folder / "bench.json").read_text(encoding="utf-8"))
    assert data["figures"][0] | {"what": ""} == {
        "key": "size", "what": "", "value": 50.0, "unit": "MB", "target": "≤ 75 MB", "reached": True,
        "peers": "", "how": "just built",
    }  # fmt: skip
    assert data["parts"]["builds"] == {"builds": [1]}


def test_rejects_an_unknown_part_and_lists_parts(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--only", "retrieval,speed"])
    assert ended.value.code == 2
    assert (
        "speed: the parts are retrieval, names, recipes, compound, invented, defaults"
        in capsys.readouterr().err
    )


def test_an_invalid_base_is_an_error_without_traceback(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "kb").mkdir()
    (tmp_path / "kb" / "blender-5.1.sqlite").write_text("not a database", encoding="utf-8")
    assert main(["--only", "retrieval", "--home", str(tmp_path), "--output", str(tmp_path)]) == 2
    assert "Error: " in capsys.readouterr().err


def test_what_was_measured_before_is_kept_with_its_conditions(tmp_path: Path) -> None:
    table = Table("Builds", ("what", "s"), (("all", "8"),), "a note")
    part = ReportPart("builds", (TargetFigure("size", 50.0, "built"),), (table,), ("old: gone",), {"a": [1]})
    facts = {"date": "today", "commit": "abc", "machine": "fast", "base": "5.1"}
    kept = keep(tmp_path, part, facts)
    again = kept_part(tmp_path, "builds")
    assert again == kept
    assert kept_part(tmp_path, "latency") is None
    other = keep(tmp_path, ReportPart("latency"), {**facts, "commit": "def"})
    assert told_by_conditions([kept, other]) == "builds: today, abc, fast; latency: today, def, fast"


@pytest.mark.parametrize("text", ["{", "[]", '{"part": {"name": 1}}'])
def test_a_damaged_part_is_told(tmp_path: Path, text: str) -> None:
    keep(tmp_path, ReportPart("builds"), dict.fromkeys(("date", "commit", "machine"), "x"))
    (tmp_path / "parts" / "builds.json").write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="measure the part again"):
        kept_part(tmp_path, "builds")
