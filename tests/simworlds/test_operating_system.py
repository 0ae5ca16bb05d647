"""What differs between systems: this one's for real, Windows by a fake of its calls."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import click
import pytest
from click.testing import CliRunner
from places import REPO

from kb_build.cli import kb
from simworlds.cli import main
from simworlds.operating_system import SYSTEM, Posix, Windows, system_of

if TYPE_CHECKING:
    from pathlib import Path

SLEEP = [sys.executable, "-c", "import time; time.sleep(600)"]


@dataclass
class Kernel:
    """kernel32.dll, as far as it is called: processes with their exit codes, and what was done."""

    processes: dict[int, int] = field(default_factory=dict)
    refused: set[int] = field(default_factory=set)
    closed: list[int] = field(default_factory=list)
    priority: tuple[int, int] | None = None

    def OpenProcess(self, access: int, inherit: bool, pid: int) -> int:  # noqa: N802 - as Windows calls it
        assert not inherit
        return pid if pid in self.processes else 0

    def GetLastError(self) -> int:  # noqa: N802
        return 5 if self.refused else 87

    def GetExitCodeProcess(self, handle: int, code: Any) -> int:  # noqa: N802
        code.contents.value = self.processes[handle]
        return 1

    def CloseHandle(self, handle: int) -> None:  # noqa: N802
        self.closed.append(handle)

    def GetCurrentProcess(self) -> int:  # noqa: N802
        return -1

    def SetPriorityClass(self, handle: int, priority: int) -> None:  # noqa: N802
        self.priority = (handle, priority)


def test_each_system_is_told_by_its_name() -> None:
    assert [type(system_of(name)) for name in ("linux", "darwin", "win32")] == [Posix, Posix, Windows]


def test_windows_asks_for_a_process_and_sends_it_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "kill", lambda *_: pytest.fail("on Windows this would be Ctrl-C"))
    kernel = Kernel(processes={7: 259, 8: 0})
    system = Windows(kernel=lambda: kernel)
    assert [system.is_running(pid) for pid in (7, 8, 9)] == [True, False, False]
    assert kernel.closed == [7, 8]
    kernel.refused.add(9)
    assert system.is_running(9), "another user's process is one"


def test_windows_ends_a_process_with_its_children_by_their_parents() -> None:
    commands: list[list[str]] = []
    Windows(run=commands.append).kill_group(42)
    assert commands == [["taskkill", "/F", "/T", "/PID", "42"]]


def test_a_missing_taskkill_is_survived() -> None:
    def absent(_: list[str]) -> None:
        raise FileNotFoundError("taskkill")

    Windows(run=absent).kill_group(42)


def test_windows_waits_for_a_lock_by_trying_again(tmp_path: Path) -> None:
    tries: list[tuple[int, int]] = []

    def locking(_descriptor: int, mode: int, count: int) -> None:
        tries.append((mode, count))
        if len(tries) < 3:
            raise PermissionError(13, "locked")

    with (tmp_path / "lock").open("w") as file:
        Windows(locking=locking).lock(file, wait=True)
        assert tries == [(2, 1)] * 3
        tries.clear()
        with pytest.raises(PermissionError):
            Windows(locking=locking).lock(file, wait=False)


def test_windows_lowers_the_priority_of_this_process() -> None:
    kernel = Kernel()
    Windows(kernel=lambda: kernel).yield_to_others()
    assert kernel.priority == (-1, 0x4000)


def test_the_interpreter_of_an_environment_is_where_each_system_puts_it(tmp_path: Path) -> None:
    assert Posix().python_in(tmp_path) == tmp_path / "bin" / "python"
    assert Windows().python_in(tmp_path) == tmp_path / "Scripts" / "python.exe"


def test_a_command_of_an_environment_is_called_and_quoted_as_each_system_does(tmp_path: Path) -> None:
    assert Posix().script_in(tmp_path, "simworlds") == tmp_path / "bin" / "simworlds"
    assert Windows().script_in(tmp_path, "simworlds") == tmp_path / "Scripts" / "simworlds.exe"
    assert Posix().quoted("/a b/simworlds") == "'/a b/simworlds'"
    assert Windows().quoted(r"C:\a b\simworlds.exe") == r'"C:\a b\simworlds.exe"'
    assert Windows().quoted(r"C:\simworlds.exe") == r"C:\simworlds.exe"


def test_only_what_popen_of_the_system_takes_begins_a_group() -> None:
    assert set(Posix().own_group()) == {"start_new_session"}
    assert set(Windows().own_group()) == {"creationflags"}


def test_a_group_is_killed_here_and_is_then_not_running() -> None:
    process = subprocess.Popen(SLEEP, **SYSTEM.own_group())
    assert SYSTEM.is_running(process.pid)
    SYSTEM.kill_group(process.pid)
    process.wait()
    assert not SYSTEM.is_running(process.pid)
    SYSTEM.kill_group(process.pid)


def test_a_lock_keeps_another_process_out_until_the_file_is_closed(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    path.touch()
    code = (
        f"from simworlds.operating_system import SYSTEM\nfile = open({str(path)!r}, 'w')\n"
        "try:\n    SYSTEM.lock(file, wait=False)\nexcept OSError:\n    raise SystemExit(7)\n"
    )
    with path.open("w") as file:
        SYSTEM.lock(file, wait=False)
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 7
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


ABSENT_THERE = """
import importlib, os, signal, socket, sys
# These ask for the system by its name.
import asyncio, multiprocessing, subprocess, tempfile, platformdirs.unix, uvicorn
for name in ("fcntl", "resource", "pwd", "grp", "termios"):
    sys.modules[name] = None
for name in ("SIGKILL", "SIGHUP", "SIGSTOP", "SIGCONT", "SIGALRM"):
    delattr(signal, name)
for name in ("killpg", "fork", "getuid", "geteuid", "nice", "setsid", "chown", "O_NOFOLLOW", "O_DIRECTORY", "statvfs"):
    delattr(os, name)
del os.sched_getaffinity, os.sysconf, socket.AF_UNIX
"""
IMPORT = """
for name in sys.argv[1:]:
    importlib.import_module(name)
"""
COMMAND = """
from simworlds import operating_system
operating_system.SYSTEM = operating_system.Windows(kernel=lambda: None)
from simworlds.cli import main
main(sys.argv[1:], prog_name="simworlds")
"""
# What only some systems have, outside of the module that knows them.
OF_SOME = {
    "fork",
    "getuid",
    "geteuid",
    "killpg",
    "nice",
    "setsid",
    "sched_getaffinity",
    "sysconf",
    "statvfs",
    "mkfifo",
}
OF_SOME |= {"SIGKILL", "SIGHUP", "SIGSTOP", "SIGCONT", "SIGALRM", "AF_UNIX", "pidfd_open", "getloadavg"}
FORKS = "forked.py"  # asked for by what knows that it can fork
EVERYWHERE = (
    "kb_serve",
    "kb_check",
    "kb_build/ready",
    "simworlds/mcp_transport",
    "simworlds/terminal",
    "simworlds",
)


def test_what_windows_lacks_is_not_needed_to_answer_to_check_and_to_fetch() -> None:
    """The MCP package asks for the system by its name; all else that these commands load is here."""
    names = """simworlds.cli kb_serve.cli kb_serve.service kb_serve.rebuild kb_serve.knowledge_base kb_check.command.cli
        kb_check.command.run kb_check.tool kb_check.migrate.cli kb_check.stubs.cli kb_build.cli kb_build.ready.fetch
        kb_build.ready.export kb_build.verify simworlds.mcp_transport.connections simworlds.sandbox.runtime"""
    done = subprocess.run(
        [sys.executable, "-c", ABSENT_THERE + IMPORT, *names.split()],
        env={**os.environ, "PYTHONPATH": str(REPO)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("command", ["mcp", "make cubes", "verify x.blend", "doctor", "runs"])
def test_a_command_that_needs_a_live_blender_says_so_where_none_runs(command: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", ABSENT_THERE + COMMAND, *command.split()],
        env={**os.environ, "PYTHONPATH": str(REPO), "SIMWORLDS_HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 2
    assert "WSL" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("command", ["docs cube", "check a.py", "serve"])
def test_a_fault_of_a_command_that_needs_no_blender_is_not_laid_to_the_system(
    command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise AttributeError("a fault of ours")

    name, *arguments = command.split()
    monkeypatch.setattr("simworlds.operating_system.SYSTEM", Windows(kernel=lambda: None))
    loaded = main.get_command(click.Context(main), name)
    assert loaded is not None
    monkeypatch.setattr(loaded, "invoke", broken)
    done = CliRunner().invoke(main, [name, *arguments])
    assert isinstance(done.exception, AttributeError)


def test_what_serves_and_checks_asks_for_nothing_that_only_some_systems_have() -> None:
    asked = [
        f"{path.relative_to(REPO)}:{node.lineno}: {node.attr}"
        for folder in EVERYWHERE
        for path in ((REPO / folder).glob("*.py") if folder == "simworlds" else (REPO / folder).rglob("*.py"))
        if path.name not in {"operating_system.py", FORKS} and "inside" not in path.parts
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Attribute) and node.attr in OF_SOME
    ]
    assert asked == []


def test_cores_are_counted_where_no_affinity_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 1 <= Posix().cores() <= (os.cpu_count() or 1)
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    assert Posix().cores() == Windows().cores() == (os.cpu_count() or 1)


def test_a_build_is_refused_where_readers_cannot_be_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kb_build.cli.SYSTEM", Windows())
    done = CliRunner().invoke(kb, ["build", "5.1"])
    assert done.exit_code == 2
    assert "simworlds kb fetch" in done.output
