"""The generated references agree with what they describe."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from running import REPO

from kb_serve.reference import outdated, references, write
from kb_serve.tool import DESCRIPTION, tool


def check(folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "kb_serve.reference", "--check", "--folder", str(folder)]
    return subprocess.run(command, cwd=REPO, capture_output=True, text=True, check=False)


def test_what_was_written_is_up_to_date(tmp_path: Path) -> None:
    write(tmp_path)
    assert outdated(tmp_path) == []
    done = check(tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_what_was_changed_or_is_absent_is_named(tmp_path: Path) -> None:
    assert outdated(tmp_path) == ["cli.md", "tools.md"]
    write(tmp_path)
    with (tmp_path / "cli.md").open("a") as file:
        file.write("edited by hand\n")
    done = check(tmp_path)
    assert done.returncode == 1
    assert "cli.md" in done.stderr
    assert "tools.md" not in done.stderr
    assert "make docs" in done.stderr


def test_every_command_has_its_help() -> None:
    text = references()["cli.md"]
    for command in (
        "simworlds",
        "simworlds kb build",
        "simworlds kb info",
        "simworlds docs",
        "simworlds serve",
    ):
        assert f"## `{command}`" in text
        assert f"Usage: {command} " in text


def test_the_tool_has_its_description_arguments_and_result() -> None:
    text = references()["tools.md"]
    entry = tool()
    assert DESCRIPTION in text
    assert entry.output_schema is not None
    for name in (*entry.input_schema["properties"], *entry.output_schema["properties"]):
        assert f"| `{name}` |" in text


def test_nothing_in_them_depends_on_where_they_were_made() -> None:
    for text in references().values():
        assert str(REPO) not in text
        assert str(Path.home()) not in text
