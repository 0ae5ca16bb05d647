"""What the audit's and the report's options take, and what is said of a file that cannot be audited."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from bench.commands.audit import audit
from bench.commands.report import report

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--memory", "nan"),
        ("--memory", "inf"),
        ("--memory", "0.01"),
        ("--memory", "-1"),
        ("--seconds", "-1"),
        ("--seconds", "0"),
        ("--seconds", "nan"),
    ],
)
def test_impossible_limits_are_refused(option: str, value: str) -> None:
    done = CliRunner().invoke(audit, ["scene.blend", "--scene", "cloth_D1_01", option, value])
    assert done.exit_code == 2
    assert f"'{option}'" in done.stderr
    assert "range" in done.stderr or "finite" in done.stderr


def test_a_file_that_is_not_there_is_named_on_stderr(tmp_path: Path) -> None:
    done = CliRunner().invoke(audit, [str(tmp_path / "absent.blend"), "--scene", "cloth_D1_01"])
    assert (done.exit_code, done.stdout) == (2, "")
    assert f"Error: {tmp_path / 'absent.blend'} was not scored: there is no such file" in done.stderr


@pytest.mark.parametrize("option", ["--html", "--markdown", "--json"])
def test_a_report_makes_no_folders(tmp_path: Path, option: str) -> None:
    done = CliRunner().invoke(report, [str(tmp_path), option, str(tmp_path / "slip" / "a")])
    assert done.exit_code == 2
    assert "There is no folder" in done.stderr
    assert not (tmp_path / "slip").exists()
