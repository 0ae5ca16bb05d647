"""The commands ``simworlds kb …`` as their users meet them."""

from __future__ import annotations

import json
import os
import pty
import sqlite3
import subprocess
import sys
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from places import REPO
from running import run_here

from kb_build.cli import replaces_files_whole
from kb_build.summaries.store import SummaryStore
from kb_build.summaries.types import PageSummary, summary_key

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built

COMMAND = [sys.executable, "-m", "simworlds"]


def environment(home: Path, corpora: Path | None = None) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SIMWORLDS_")}
    extra = {"SIMWORLDS_CORPORA": str(corpora)} if corpora else {}
    return kept | extra | {"SIMWORLDS_HOME": str(home), "PYTHONPATH": str(REPO), "COLUMNS": "120"}


def run(home: Path, *words: str, corpora: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Here: how it is as a process of its own, the builds show whose output is piped or drawn."""
    done = run_here(words, environment(home, corpora), REPO)
    return subprocess.CompletedProcess(done.args, done.returncode, done.stdout.decode(), done.stderr.decode())


def run_apart(home: Path, *words: str, corpora: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *words], env=environment(home, corpora), capture_output=True, text=True, check=False
    )


def run_on_terminal(home: Path, *words: str, corpora: Path) -> tuple[int, bytes]:
    """The exit code and everything that a terminal was sent."""
    ours, theirs = pty.openpty()
    env = environment(home, corpora) | {"TERM": "xterm-256color"}
    with subprocess.Popen([*COMMAND, *words], env=env, stdin=theirs, stdout=theirs, stderr=theirs) as process:
        os.close(theirs)
        received = b""
        while chunk := read_some(ours):
            received += chunk
    os.close(ours)
    return process.returncode, received


def read_some(descriptor: int) -> bytes:
    try:
        return os.read(descriptor, 65536)
    except OSError:  # Linux's way of saying that the other side is closed
        return b""


@pytest.mark.blender
def test_a_piped_build_prints_steps_to_stderr_and_the_outcome_to_stdout(small: Built) -> None:
    (small.home / "kb").rename(small.home / "old")
    done = run_apart(small.home, "kb", "build", "--offline", corpora=small.corpora)
    assert done.returncode == 0
    assert done.stdout.startswith(f"Built the knowledge base of Blender {small.report.version} in ")
    assert str(small.path) in done.stdout
    assert "manual" in done.stdout
    assert "Writing" in done.stderr
    assert "\x1b" not in done.stdout + done.stderr


@pytest.mark.blender
def test_a_build_on_a_terminal_draws_its_progress_and_wipes_it_off(small: Built) -> None:
    (small.home / "kb").rename(small.home / "old")
    code, sent = run_on_terminal(small.home, "kb", "build", "--offline", corpora=small.corpora)
    assert code == 0
    assert b"Writing" in sent
    assert b"\x1b[2K" in sent
    assert b"Built the knowledge base" in sent
    assert b"Warning" not in sent


@pytest.mark.blender
def test_a_build_with_nothing_to_do_says_so_and_shows_no_progress(small: Built) -> None:
    done = run(small.home, "kb", "build", small.minor, "--offline", corpora=small.corpora)
    assert done.returncode == 0
    assert done.stdout.startswith("Nothing has changed")
    assert done.stderr == ""


@pytest.mark.blender
def test_missing_sources_are_the_last_thing_that_a_build_says(small: Built, tmp_path: Path) -> None:
    (tmp_path / "none").mkdir()
    (small.home / "kb").rename(small.home / "old")
    done = run(small.home, "kb", "build", "--offline", corpora=tmp_path / "none")
    assert done.returncode == 0
    warnings = done.stderr.splitlines()[-2:]
    assert warnings[0].startswith("Warning: no manual of Blender")
    assert warnings[1].startswith("Warning: no API guides of Blender")
    information = run(small.home, "kb", "info", small.minor).stdout
    assert information.count("MISSING") == 2
    assert "(missing: manual, guides)" in run(small.home, "kb", "info").stdout


@pytest.mark.blender
def test_a_required_source_that_is_missing_ends_with_code_2(small: Built, tmp_path: Path) -> None:
    (tmp_path / "none").mkdir()
    words = ("kb", "build", "--offline", "--require", "manual,guides")
    done = run(small.home, *words, corpora=tmp_path / "none")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("Error: no manual of Blender")
    assert "--require manual" in done.stderr


@pytest.mark.blender
def test_info_tells_what_is_in_a_base(built_once: Built) -> None:
    text = run(built_once.home, "kb", "info", built_once.minor).stdout
    for expected in (
        built_once.report.version,
        "operators",
        "classes",
        "source       manual",
        "sha256",
        "extractive",
    ):
        assert expected in text
    facts = json.loads(run(built_once.home, "kb", "info", built_once.minor, "--json").stdout)
    assert facts["blender"] == built_once.report.version
    assert facts["bytes"] == built_once.path.stat().st_size
    assert facts["counts"]["symbols"]["class"] > 2000
    assert facts["page_warnings"]
    listed = json.loads(run(built_once.home, "kb", "info", "--json").stdout)
    assert [one["path"] for one in listed] == [str(built_once.path)]


@pytest.mark.blender
def test_info_of_a_damaged_base_says_what_to_do(small: Built) -> None:
    small.path.write_bytes(b"SQLite format 3\x00" + b"\x07" * 5000)
    done = run(small.home, "kb", "info", small.minor)
    assert done.returncode == 2
    assert f"simworlds kb build {small.minor} --force" in done.stderr
    listed = run(small.home, "kb", "info")
    assert (listed.returncode, listed.stdout.strip(), listed.stderr) == (2, "", done.stderr)


@pytest.mark.blender
@pytest.mark.parametrize(
    "damage",
    ["DELETE FROM meta WHERE name = 'sources'", "UPDATE meta SET value = '[1]' WHERE name = 'sources'"],
)
def test_a_base_without_facts_about_itself_is_told_as_damaged(small: Built, damage: str) -> None:
    with closing(sqlite3.connect(small.path, isolation_level=None)) as connection:
        connection.execute(damage)
    done = run(small.home, "kb", "info", small.minor)
    assert (done.returncode, done.stdout) == (2, "")
    assert f"{small.path}: damaged (its facts: " in done.stderr
    assert run(small.home, "kb", "info").stderr == done.stderr
    if "UPDATE" in damage:
        exported = run(small.home, "kb", "export", small.minor, "--output", str(small.home / "x.tar.xz"))
        assert (exported.returncode, "damaged (its facts: " in exported.stderr) == (2, True)
        assert not (small.home / "x.tar.xz").exists()


@pytest.mark.blender
def test_verify_passes_a_sound_base_and_fails_a_damaged_one(small: Built) -> None:
    done = run(small.home, "kb", "verify")
    assert done.returncode == 0, done.stdout
    assert done.stdout.endswith("Sound.\n")
    with small.path.open("r+b") as file:
        file.seek(500_000)
        file.write(b"\xff" * 100_000)
    done = run(small.home, "kb", "verify", small.minor)
    assert done.returncode == 1
    assert "FAULT" in done.stdout
    assert "Traceback" not in done.stderr


@pytest.mark.blender
def test_verify_prints_its_findings_as_json(small: Built, tmp_path: Path) -> None:
    reference = tmp_path / "list.txt"
    reference.write_text("bpy.types.Mesh\nbpy.types.Nobody\n")
    done = run(small.home, "kb", "verify", str(small.path), "--reference", str(reference), "--json")
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert found["sound"] is False
    assert found["reference"]["exact"] == 1
    assert [row for rows in found["reference"]["others"].values() for row in rows] == [
        "bpy.types.Nobody → bpy.types"
    ]


@pytest.mark.blender
def test_two_blenders_are_compared(small: Built) -> None:
    """A program that passes an altered copy of this Blender's own description off as another Blender's."""
    extract = next((small.home / "extracts").glob("*.jsonl"))
    other = small.home / "blender"
    other.write_text(
        '#!/bin/sh\n[ "$1" = --version ] && echo "Blender 4.9.1" && exit\nfor word; do last=$word; done\n'
        f'sed -e \'s/bpy.types.Mesh.vertices/bpy.types.Mesh.corners/g\' -e \'s/"version":"[0-9.]*"/'
        f'"version":"4.9.1"/\' {extract} > "$last"\n'
    )
    other.chmod(0o755)
    words = ("kb", "diff", str(other), small.report.version, "--prefix", "bpy.types.Mesh")
    text = run(small.home, *words).stdout
    assert text.startswith(f"# Blender 4.9.1 → {small.report.version}")
    assert "`corners`" in text[text.index("## Removed") : text.index("## Added")]
    found = json.loads(run(small.home, *words, "--json").stdout)
    assert [one["path"] for one in found["removed"]] == ["bpy.types.Mesh.corners"]
    assert [one["path"] for one in found["added"]] == ["bpy.types.Mesh.vertices"]
    assert found["changed"] == []
    nowhere = run(small.home, *words[:-1], "bpy.types.Meshes")
    assert (nowhere.returncode, nowhere.stdout) == (2, "")
    assert "has bpy.types.Meshes" in nowhere.stderr


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("kb", "build", "five"), "'five' is not a Blender version"),
        (("kb", "build", "9.9"), "there is no bpy package for Blender 9.9"),
        (("kb", "build", "5.1", "--blender-exe", "/nowhere"), "no Blender executable at /nowhere"),
        (("kb", "build", "--require", "pictures"), "give manual, guides or both"),
        (("kb", "build", "--jobs", "0"), "--jobs"),
        (("kb", "build", "2.79"), "Blender 2.79 is older than 3.1"),
        (("kb", "info", "4.5"), "kb build 4.5 (a minute;"),
        (("kb", "verify"), "There is no knowledge base yet. Build it: "),
        (
            ("kb", "verify", "../../nowhere/passwd"),
            "neither a Blender version, as 5.1, nor the file of a base",
        ),
        (("kb", "verify", "/etc/passwd"), "/etc/passwd: not readable as a knowledge base"),
        (("kb", "export", "4.5", "--output", "/nowhere/x"), "There is no folder /nowhere."),
        (("kb", "export", "4.5", "--output", "/"), "is a directory"),
        (("kb", "build", "5.1", "--out", "/proc/base.sqlite"), "No file can be written to /proc:"),
        (("kb", "pack", "--output", "/nowhere/x.md"), "There is no folder /nowhere."),
        (("kb", "merge-summaries", "/nowhere"), "does not exist"),
        (("kb", "merge-summaries", "/etc/passwd"), "/etc/passwd cannot be read as a colleague's summaries"),
        (("kb", "diff", "4.2", "5.1", "--json", "--limit", "3"), "--limit shortens what is shown"),
        (("kb", "diff", "nonsense", "5.1"), "'nonsense' is not a Blender version"),
    ],
)
def test_errors_are_one_message_and_code_2(tmp_path: Path, words: tuple[str, ...], message: str) -> None:
    done = run(tmp_path / "home", *words)
    assert done.returncode == 2
    assert message in done.stdout + done.stderr
    assert "Traceback" not in done.stderr


def test_info_without_any_base_says_how_to_build_one(tmp_path: Path) -> None:
    done = run(tmp_path, "kb", "info")
    assert (done.returncode, done.stderr) == (0, "")
    assert "simworlds kb build" in done.stdout
    assert json.loads(run(tmp_path, "kb", "info", "--json").stdout) == []


def test_a_colleagues_summaries_are_merged(tmp_path: Path) -> None:
    theirs = SummaryStore(tmp_path / "theirs.sqlite")
    key = summary_key("0" * 64, "1", "a-model")
    theirs.add([PageSummary(key, "What it says.", "claude", "a-model", "1")])
    home = tmp_path / "home"
    assert run(home, "kb", "merge-summaries", str(theirs.path)).stdout.startswith(
        "1 summaries are new, 1 in all"
    )
    assert run(home, "kb", "merge-summaries", str(theirs.path)).stdout.startswith(
        "0 summaries are new, 1 in all"
    )


def test_the_commands_are_listed_without_being_loaded(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom simworlds.cli import main\n"
        "try:\n    main(['--help'])\nexcept SystemExit as end:\n    assert not end.code\n"
        "loaded = [name for name in sys.modules if name.startswith(('kb_build', 'kb_serve', 'sphinx', 'mcp'))]\n"
        "assert loaded == [], loaded\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(tmp_path), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    for command in ("docs", "kb", "serve"):
        assert f"  {command}" in done.stdout


def test_a_build_command_loads_nothing_heavy_before_it_knows_what_to_do(tmp_path: Path) -> None:
    code = (
        "import sys\nimport kb_build.cli, kb_build.pipeline\n"
        "heavy = {'sphinx', 'docutils', 'bs4', 'anthropic', 'mcp', 'numpy', 'sqlite_utils', 'rich', 'bpy'}\n"
        "assert not heavy & sys.modules.keys(), heavy & sys.modules.keys()\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment(tmp_path), capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_what_replaces_files_says_that_the_old_ones_are_unchanged() -> None:
    def interrupted() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt, match="The old files are unchanged"):
        replaces_files_whole(interrupted)()
