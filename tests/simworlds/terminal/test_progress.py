"""Progress on a terminal: its clock goes on while a step works, processes are still forked, nothing stays behind."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import pytest
from places import REPO

from simworlds.terminal.progress import shown_progress

pty = pytest.importorskip("pty")

_WORK = """
import os, sys, time
from simworlds.forked import beside, can_fork
from simworlds.terminal.progress import shown_progress

with shown_progress() as progress:
    progress("Asking Blender for its API", 0, None)
    assert can_fork()
    with beside(os.getpid) as result:
        assert result() != os.getpid()
    time.sleep(2.5)  # longer than the clock's second
    print("seen while it works")
    progress("Writing", 1, 2)
"""


def on_terminal(columns: int, **environment: str) -> tuple[int, str]:
    """The exit code of ``_WORK``, and what a terminal of so many columns got."""
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-c", _WORK],
        env={**os.environ, "PYTHONPATH": str(REPO), "TERM": "xterm", "COLUMNS": str(columns), **environment},
        stdout=theirs,
        stderr=theirs,
    )
    os.close(theirs)
    got = b""
    while chunk := _read(ours):
        got += chunk
    os.close(ours)
    return process.wait(), got.decode()


def _read(descriptor: int) -> bytes:
    try:
        return os.read(descriptor, 4096)
    except OSError:  # Linux says so when the other end is closed
        return b""


@pytest.mark.parametrize(("columns", "environment"), [(80, {}), (30, {"NO_COLOR": "1"})])
def test_the_clock_goes_on_while_a_step_works(columns: int, environment: dict[str, str]) -> None:
    code, shown = on_terminal(columns, **environment)
    assert code == 0, shown
    assert {"0:00:00", "0:00:01", "0:00:02"} <= set(re.findall(r"0:00:0\d", shown))
    assert len(set(re.findall("[\u2800-\u28ff]", shown))) >= 4
    assert "seen while it works" in shown
    assert shown.endswith("\x1b[2K")  # the line is wiped


def test_what_takes_seconds_says_nothing_in_a_log(capsys: pytest.CaptureFixture[str]) -> None:
    with shown_progress(in_logs=False) as progress:
        progress("Writing", 1, 2)
    assert capsys.readouterr().err == ""


def test_elsewhere_it_is_lines() -> None:
    done = subprocess.run(
        [sys.executable, "-c", _WORK],
        env={**os.environ, "PYTHONPATH": str(REPO)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == "Asking Blender for its API ...\nWriting: 50 % ...\n"
