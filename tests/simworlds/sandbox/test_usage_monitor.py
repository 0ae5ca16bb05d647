"""The watch over disk and process: nameless files, many files, and standing still while they are counted."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.hostile_ground import DiskUsage, HostileGround
from simworlds.sandbox.watch import usage
from simworlds.sandbox.watch.nameless_files import NamelessFiles, nameless_files
from simworlds.sandbox.watch.watched_process import WatchedProcess

if TYPE_CHECKING:
    from collections.abc import Callable, Generator
    from pathlib import Path

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/proc is Linux's")


@contextmanager
def running(code: str, folder: Path) -> Generator[subprocess.Popen[str]]:
    """A process that has run ``code``, said so, and waits."""
    words = [sys.executable, "-c", f"import os, sys\n{code}\nprint('ready', flush=True)\nsys.stdin.read()"]
    with subprocess.Popen(
        words, cwd=folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        yield process
        process.kill()


OPEN = """
files = [open(str(number), "wb") for number in range(3)]
for file in files:
    file.write(bytes(5 << 20))
    file.flush()
    os.unlink(file.name)
"""
MAPPED = """
import mmap
file = open("mapped", "w+b")
file.write(bytes(30 << 20))
file.flush()
os.fsync(file.fileno())
kept = mmap.mmap(file.fileno(), 4096)
os.unlink("mapped")
# mmap keeps a descriptor of its own
for number in range(3, 50):
    try: os.close(number)
    except OSError: pass
"""


def test_deleted_files_that_are_open_are_counted(tmp_path: Path) -> None:
    with running(OPEN, tmp_path) as process:
        found = nameless_files(process.pid, frozenset({tmp_path.stat().st_dev}))
        assert found.open == 3
        assert 15 << 20 <= found.bytes < 16 << 20
        assert nameless_files(process.pid, frozenset()).open == 0


def test_a_deleted_file_that_is_only_mapped_is_known(tmp_path: Path) -> None:
    with running(MAPPED, tmp_path) as process:
        found = nameless_files(process.pid, frozenset({tmp_path.stat().st_dev}))
        assert (found.open, found.mapped) == (0, 1)


@pytest.mark.parametrize("code", [OPEN, MAPPED], ids=["open", "mapped"])
def test_nameless_files_count_toward_the_limit(tmp_path: Path, code: str) -> None:
    folder = tmp_path / "workspace"
    folder.mkdir()
    watch = usage.UsageMonitor((HostileGround(folder),), ResourceLimits(disk=10 << 20))
    with running(code, folder) as process:
        assert watch.excess(at_end=True) is None  # nobody knows of the process yet
        watch.watch(WatchedProcess(process.pid))
        assert "brought the run's files to" in (watch.excess(at_end=True) or "")


def test_mapped_files_are_looked_for_when_space_was_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[bool] = []

    def noted(*arguments: Any, mapped: bool = True) -> NamelessFiles:
        looks.append(mapped)
        return NamelessFiles(0, 0, 0)

    free = [100_000_000]
    monkeypatch.setattr(usage, "nameless_files", noted)
    monkeypatch.setattr(usage.UsageMonitor, "_free", lambda _: {1: usage.FreeSpace(free[0], 1000)})
    watch = usage.UsageMonitor((HostileGround(tmp_path),), ResourceLimits(disk=1 << 30))
    # Others take space, and give it back; what is taken from then on counts anew.
    for megabytes in (99, 80, 78, 95, 94, 88, 87):
        free[0] = megabytes * 1_000_000
        assert watch.excess(at_end=True) is None
    assert looks[1:] == [False, True, False, False, False, True, False]


def test_much_taken_space_is_noticed_in_the_pause_between_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(usage, "_CHECK_SECONDS", 1e6)
    watch = usage.UsageMonitor((HostileGround(tmp_path),), ResourceLimits(disk=100_000_000))
    assert watch.excess() is None
    with (tmp_path / "large").open("wb") as file:
        os.posix_fallocate(file.fileno(), 0, 250_000_000)
    assert "the limit is 100 MB" in (watch.excess() or "")


def test_many_new_files_are_noticed_in_the_pause_between_counts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if os.statvfs(tmp_path).f_files == 0:
        pytest.skip("this file system does not count files")
    monkeypatch.setattr(usage, "_CHECK_SECONDS", 1e6)
    monkeypatch.setattr(usage, "_MANY_FILES", 500)
    watch = usage.UsageMonitor((HostileGround(tmp_path),), ResourceLimits(files=600))
    assert watch.excess() is None
    for number in range(1000):
        (tmp_path / str(number)).touch()
    assert watch.excess() == "brought the run to more than 600 files"


@pytest.mark.parametrize(
    ("lasts", "then"),
    [
        pytest.param(time.monotonic, "brought the run to more than 600 files", id="that waits for a core"),
        pytest.param(time.thread_time, None, id="of very many files"),
    ],
)
def test_a_calls_end_is_passed_over_only_after_a_count_that_is_much_work(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, lasts: Callable[[], float], then: str | None
) -> None:
    class LongCounted(HostileGround):
        def measure(self, at_most: int = 0) -> DiskUsage:
            began = lasts()
            while lasts() - began < 0.1:
                if lasts is time.monotonic:
                    time.sleep(0.01)
            return super().measure(at_most)

    monkeypatch.setattr(usage, "_PAUSE", 1e6)
    watch = usage.UsageMonitor((LongCounted(tmp_path),), ResourceLimits(files=600))
    assert watch.excess(at_end=True) is None
    for number in range(1000):
        (tmp_path / str(number)).touch()
    assert watch.excess(at_end=True) == then


def test_a_process_stands_still_only_meanwhile(tmp_path: Path) -> None:
    def state(pid: int) -> str:
        return (tmp_path / f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]

    with running("", tmp_path) as process:
        watched = WatchedProcess(process.pid)
        with watched.standing_still():
            os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
            assert state(process.pid) == "T"
        assert state(process.pid) != "T"
        os.kill(process.pid, signal.SIGSTOP)
        os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
        with watched.standing_still():
            pass
        assert state(process.pid) == "T"  # somebody else's stop stays
    assert watched.memory_and_threads() == (0, 0)
