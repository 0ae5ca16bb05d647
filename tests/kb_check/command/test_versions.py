"""What breaks in which Blender: the table, the places, the range."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_check.command.project import LoadedFile
from kb_check.command.versions import VersionsReport, check_versions
from simworlds.errors import UserError

if TYPE_CHECKING:
    from pathlib import Path

    from kb_check.command.project import Group

OLD = b'import bpy\nbpy.context.object.draw_type = "WIRE"\n'
RIGHT = b'import bpy\nbpy.context.object.display_type = "WIRE"\n'
GROUP = (LoadedFile("addon/old.py", OLD), LoadedFile("addon/right.py", RIGHT))


def checked(base: Path, group: Group, *versions: str) -> VersionsReport:
    return check_versions([group], versions or [base.stem.removeprefix("blender-")], base.parent.parent)


def in_versions(base: Path, broken: dict[str, bool]) -> VersionsReport:
    """The report of a Blender that takes the files in some versions, and of this one in the others."""
    (bad,) = checked(base, GROUP).reports
    (good,) = checked(base, (LoadedFile("addon/old.py", RIGHT), LoadedFile("addon/right.py", RIGHT))).reports
    return VersionsReport(
        tuple(replace(bad if breaks else good, blender=version) for version, breaks in broken.items())
    )


def test_a_base_tells_what_is_wrong_in_its_version(base: Path) -> None:
    report = checked(base, GROUP)
    (version,) = report.versions
    assert report.errors() == {"addon/old.py": {version: 1}, "addon/right.py": {version: 0}}
    (found,) = report.breaks()
    assert (found.file.name, found.finding.span.line, found.versions) == ("addon/old.py", 2, (version,))
    assert report.runs_in() == []


def test_the_range_is_told_with_what_breaks_beyond(base: Path) -> None:
    report = in_versions(base, {"4.2": False, "4.5": False, "5.0": True, "5.1": True})
    assert report.runs_in() == ["4.2", "4.5"]
    assert report.verdict() == (
        "Nothing found that breaks in 4.2 and 4.5; breaks in 5.0: 1 error, first at addon/old.py:2; "
        "breaks in 5.1: 1 error, first at addon/old.py:2."
    )
    lines = list(report.text_lines())
    assert lines[0].split() == ["file", "4.2", "4.5", "5.0", "5.1"]
    assert lines[1].split() == ["addon/old.py", "–", "–", "1", "1"]
    assert lines[3].startswith("addon/old.py:2:20: in 5.0 and 5.1: [unknown-attribute]")
    assert "1 more file without errors." in lines


def test_what_is_wrong_in_several_is_said_of_none_alone(base: Path) -> None:
    report = in_versions(base, {"4.5": True, "5.1": True})
    (row,) = report.breaks()
    found = replace(
        row, finding=replace(row.finding, message="`x` does not exist in Blender 4.5: removed in 2.80.")
    )
    assert found.message == "`x` does not exist: removed in 2.80."
    assert replace(found, versions=("4.5",)).message == found.finding.message
    assert report.verdict() == (
        "Breaks in 4.5: 1 error, first at addon/old.py:2; breaks in 5.1: 1 error, first at addon/old.py:2."
    )


def test_a_file_that_could_not_be_checked_is_good_nowhere(base: Path) -> None:
    good, bad = in_versions(base, {"4.5": False, "5.1": False}).reports
    report = VersionsReport((good, replace(bad, files=bad.files[:1])))
    assert report.runs_in() == ["4.5"]
    assert report.verdict() == "Nothing found that breaks in 4.5."
    assert VersionsReport((replace(good, files=[]),)).verdict() == ""


def test_a_range_of_three_is_written_as_one(base: Path) -> None:
    report = in_versions(base, {"4.2": False, "4.3": False, "4.4": False, "4.5": True, "5.0": False})
    assert report.verdict().startswith("Nothing found that breaks in 4.2 to 4.4 and 5.0; breaks in 4.5")


def test_nothing_wrong_anywhere(base: Path) -> None:
    report = in_versions(base, {"4.2": False, "5.1": False})
    assert list(report.text_lines()) == ["Nothing found that breaks in 4.2 and 5.1."]


def test_json_has_the_same(base: Path) -> None:
    report = in_versions(base, {"4.5": False, "5.0": True}).as_json()
    assert report["runs_in"] == ["4.5"]
    assert report["errors"] == {"4.5": 0, "5.0": 1}
    (row,) = report["breaks"]
    assert (row["line"], row["column"], row["versions"]) == (2, 20, ["5.0"])


def test_what_may_break_is_told_beside_what_breaks(base: Path) -> None:
    risky = b'import bpy\nbpy.data.objects.new("Door", None).animation_data.action\n'
    (report,) = checked(base, (LoadedFile("door.py", risky),)).reports
    (warned,) = report.files[0].findings
    both = VersionsReport((replace(report, blender="4.5"), report))
    assert (warned.severity, both.breaks(), both.runs_in()) == ("warning", [], both.versions)
    (row,) = both.as_json()["warnings"]
    assert (row["line"], row["rule"], row["versions"]) == (2, warned.rule, both.versions)
    lines = list(both.text_lines())
    assert lines[:2] == ["1 warning:", f"door.py:2:{row['column']}: in {' and '.join(both.versions)}: "
                         f"[{warned.rule}] {warned.message}"]  # fmt: skip
    assert lines[-1] == both.verdict() == f"Nothing found that breaks in {' and '.join(both.versions)}."


@pytest.mark.parametrize("version", ["2.49", "five", ""])
def test_a_version_without_a_base_is_said(base: Path, version: str) -> None:
    with pytest.raises(UserError):
        checked(base, GROUP, version)
