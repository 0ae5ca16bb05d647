"""What a pyproject.toml says of the check."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.command.configuration import BadConfiguration, Configuration, read_configuration
from kb_check.findings import Finding, Span

if TYPE_CHECKING:
    from pathlib import Path


def configured(folder: Path, text: str) -> Configuration:
    (folder / "pyproject.toml").write_text(f"[tool.simworlds.check]\n{text}\n")
    return read_configuration(folder)


def finding(rule: str = "unknown-attribute") -> Finding:
    return Finding(rule, "error", Span(1, 0, 1, 0), "wrong")


def test_the_nearest_file_with_the_table_counts(tmp_path: Path) -> None:
    configured(tmp_path, 'blender = "4.5"')
    below = tmp_path / "a" / "b"
    below.mkdir(parents=True)
    (tmp_path / "a" / "pyproject.toml").write_text("[project]\nname = 'x'\n")
    found = read_configuration(below)
    assert (found.blender, found.folder) == (("4.5",), tmp_path)


def test_without_a_file_everything_is_asked(tmp_path: Path) -> None:
    found = read_configuration(tmp_path)
    assert found.kept(tmp_path / "a.py", [finding()]) == [finding()]
    assert found.fails(finding())


def test_versions_are_a_text_or_a_list(tmp_path: Path) -> None:
    assert configured(tmp_path, 'blender = "4.5,5.1"').blender == ("4.5", "5.1")
    assert configured(tmp_path, 'blender = ["4.5", "5.1"]').blender == ("4.5", "5.1")
    assert configured(tmp_path, "blender = []").blender == ()


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ('rules = ["unknown-attribute"]', 1),
        ('rules = ["unknown-socket"]', 0),
        ('ignore = ["unknown-attribute"]', 0),
        ('per-file-ignores = { "tests/*" = ["unknown-attribute"] }', 0),
        ('per-file-ignores = { "tests" = ["unknown-attribute"] }', 0),
        ('per-file-ignores = { "a.py" = ["unknown-attribute"] }', 0),
        ('per-file-ignores = { "other/*" = ["unknown-attribute"] }', 1),
    ],
)
def test_rules_can_be_left_out(tmp_path: Path, text: str, count: int) -> None:
    kept = configured(tmp_path, text).kept(tmp_path / "tests" / "a.py", [finding()])
    assert len(kept) == count


def test_severities_can_be_changed_and_decide_what_fails(tmp_path: Path) -> None:
    found = configured(tmp_path, 'severity = { unknown-attribute = "warning" }')
    (kept,) = found.kept(tmp_path / "a.py", [finding()])
    assert kept.severity == "warning"
    assert not found.fails(kept)
    assert configured(tmp_path, 'fail-on = "note"').fails(kept)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('blendr = "5.1"', r"check\.blendr is unknown\. There are: blender, rules, ignore, exclude"),
        ('rules = ["unknwon"]', r"check\.rules: there is no rule 'unknwon'\. There are: .*unknown-attribute"),
        ("exclude = 1", r"check\.exclude must be a list of strings"),
        ("exclude = [1]", r"check\.exclude must be a list of strings"),
        (
            "blender = 5.1",
            r'check\.blender must be a version in quotes, as "5\.1", or a list of such versions',
        ),
        ('blender = ["5.1", 4.5]', r"check\.blender must be a version in quotes"),
        ('blender = " , "', r"check\.blender must be a version in quotes"),
        (
            'severity = { unknown-socket = "fatal" }',
            r"severity\.unknown-socket must be one of: error, warning, note",
        ),
        ('severity = { nothing = "error" }', r"there is no rule 'nothing'"),
        ("per-file-ignores = []", r"per-file-ignores must be a table"),
        ('fail-on = ["error"]', r"fail-on must be one of"),
        ("= broken", r"cannot be read"),
    ],
)
def test_what_is_wrong_is_said(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(BadConfiguration, match=message):
        configured(tmp_path, text)


def test_a_misspelt_table_is_told(tmp_path: Path) -> None:
    (tmp_path / "pyproject.toml").write_text("[tool.simworlds.chek]\n")
    with pytest.raises(BadConfiguration, match=r"tool\.simworlds\.chek is unknown\. There is: check\."):
        read_configuration(tmp_path)


@pytest.mark.parametrize("text", ["[tool]\nsimworlds = 1\n", "tool = 1\n", "[tool.simworlds]\n"])
def test_other_tables_are_none_of_its_business(tmp_path: Path, text: str) -> None:
    (tmp_path / "pyproject.toml").write_text(text)
    assert read_configuration(tmp_path).rules == ()
