"""What holds for every command: completion in a shell, Ctrl-C, a full disk, unusable paths, and mistyped names."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from running import environment, run_here

if TYPE_CHECKING:
    from pathlib import Path

_DOES = """
import click
from simworlds.cli import main
command = click.Command("does", callback=lambda: exec({code!r}))
main.get_command = lambda ctx, name: command
main(["does"], prog_name="simworlds")
"""
LONG = "x" * 300
needs_full_device = pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full")  # noqa: PTH110


def does(code: str, home: Path, **streams: object) -> subprocess.CompletedProcess[str]:
    """A command that does what ``code`` says."""
    return subprocess.run(
        [sys.executable, "-c", _DOES.format(code=code)],
        env=environment(home),
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        timeout=60,
        **streams,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_is_given_its_script(shell: str, tmp_path: Path) -> None:
    done = run_here([], environment(tmp_path, _SIMWORLDS_COMPLETE=f"{shell}_source"), tmp_path)
    assert done.returncode == 0
    assert b"_simworlds_completion" in done.stdout


@pytest.mark.parametrize(
    ("words", "completed"),
    [("simworlds che", "check"), ("simworlds check --sar", "--sarif"), ("simworlds kb ver", "verify")],
)
def test_words_are_completed(words: str, completed: str, tmp_path: Path) -> None:
    asked = environment(
        tmp_path,
        _SIMWORLDS_COMPLETE="bash_complete",
        COMP_WORDS=words,
        COMP_CWORD=str(len(words.split()) - 1),
    )
    assert run_here([], asked, tmp_path).stdout == f"plain,{completed}\n".encode()


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_completes(tmp_path: Path) -> None:
    own = tmp_path / "simworlds"
    own.write_text(f'#!/bin/sh\nexec {sys.executable} -m simworlds "$@"\n')
    own.chmod(0o755)
    script = (
        f'eval "$(_SIMWORLDS_COMPLETE=bash_source {own})"\n'
        f'COMP_WORDS=(simworlds mig); COMP_CWORD=1\n_simworlds_completion {own}\necho "${{COMPREPLY[@]}}"'
    )
    done = subprocess.run(
        ["bash", "-c", script],
        env=environment(tmp_path),
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.stdout == "migrate\n", done.stderr


def test_an_interrupted_command_ends_as_shells_expect(tmp_path: Path) -> None:
    done = does("import os, signal; os.kill(os.getpid(), signal.SIGINT); input()", tmp_path)
    assert (done.returncode, done.stderr) == (130, "Interrupted.\n")


def test_what_became_of_the_files_is_said_with_it(tmp_path: Path) -> None:
    done = does("raise KeyboardInterrupt('The old files are unchanged.')", tmp_path)
    assert (done.returncode, done.stderr) == (130, "Interrupted. The old files are unchanged.\n")


@needs_full_device
@pytest.mark.parametrize("code", ["click.echo('words')", "print('words')"])
def test_a_full_disk_is_an_error(code: str, tmp_path: Path) -> None:
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = does(code, tmp_path, stdout=full)
    assert (done.returncode, done.stderr) == (
        2,
        "Error: The output cannot be written: No space left on device.\n",
    )


@pytest.mark.parametrize(
    "words",
    [
        ["verify", f"{LONG}.blend"],
        ["show", LONG],
        ["mcp", "--run", LONG],
        ["extension", "install", "--blender-exe", LONG],
    ],
)
def test_a_path_that_cannot_be_used_is_an_error(words: list[str], tmp_path: Path) -> None:
    done = run_here(words, environment(tmp_path), tmp_path)
    assert done.returncode == 2
    assert re.fullmatch(rf"Error: \S*{LONG}\S* cannot be used: File name too long\.\n", done.stderr.decode())


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["verify", "~nobody-of-this-name/a.blend"], "There is no file ~nobody-of-this-name/a.blend."),
        (["verify", "a.blend", "--blender-exe", "~nobody-of-this-name/b"], "There is no Blender at "),
        (["runs"], "There are no runs in "),
    ],
)
def test_a_home_of_nobody_is_a_path_like_others(words: list[str], says: str, tmp_path: Path) -> None:
    done = run_here(words, {**environment(tmp_path), "SIMWORLDS_HOME": "~nobody-of-this-name"}, tmp_path)
    assert says in (done.stdout + done.stderr).decode()


def test_a_closed_output_changes_nothing_else(tmp_path: Path) -> None:
    done = does(
        "import sys; print(sys.stdout.isatty()); sys.exit(3)", tmp_path, preexec_fn=lambda: os.close(1)
    )
    assert (done.returncode, done.stderr) == (3, "")


def test_a_name_that_is_near_is_told(tmp_path: Path) -> None:
    done = run_here(["chek"], environment(tmp_path), tmp_path)
    assert done.returncode == 2
    assert b"No such command 'chek'. Did you mean 'check'?" in done.stderr


def test_a_letter_asks_for_the_version(tmp_path: Path) -> None:
    assert run_here(["-V"], environment(tmp_path), tmp_path).stdout.startswith(b"simworlds, version ")
