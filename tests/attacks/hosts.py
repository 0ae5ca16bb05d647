"""Starts hosts: processes that own a live session in a given sandbox, as root or as somebody else."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import pytest
from places import REPO

if TYPE_CHECKING:
    from way import Kind, Tool

Who = Literal["root", "user"]
WHO: tuple[Who, ...] = ("root", "user")
_HOST = Path(__file__).with_name("host.py")
# A process that root starts as somebody else, without any capability; it may still read what root may.
_AS_USER = ("unshare", "--user", "--map-user=1000", "--map-group=1000")
_START_SECONDS = 120.0
SECRET_VARIABLE = "ANTHROPIC_API_KEY"


class HostLost(Exception):  # noqa: N818 - reads as the state it names
    """The host ended, or did not answer in time."""


class Host:
    """A running host. Raises HostLost if it does not answer, pytest.skip.Exception if it cannot run here."""

    def __init__(
        self,
        root: Path,
        kind: Kind,
        who: Who,
        *,
        read: Path,
        path: Path,
        secret: str,
        without: tuple[str, ...] = (),
        liar: bool = False,
    ) -> None:
        self.root = root
        self.kind, self.who = kind, who
        environment = {**os.environ, SECRET_VARIABLE: secret, "PATH": f"{path}:{os.environ['PATH']}"}
        environment["PYTHONPATH"] = str(REPO)
        command = [*command_as(who), sys.executable, str(_HOST)]
        self.log = root.with_suffix(".log")
        with self.log.open("wb") as log:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                env=environment,
                start_new_session=True,
            )
        self._lines: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        threading.Thread(target=self._read, daemon=True).start()
        self.refused = ""
        wanted = {"root": str(root), "kind": kind, "without": without, "read": [str(read)], "liar": liar}
        answer = self._ask(wanted, _START_SECONDS)
        if "refused" in answer:
            self.refused = answer["refused"]
        self.process: int = answer.get("process") or 0

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self._lines.put(line)
        self._process.stdout.close()
        self._lines.put(b"")

    @property
    def pid(self) -> int:
        """The host's own process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Whether it still runs."""
        return self._process.poll() is None

    def use(self, tool: Tool, seconds: float) -> dict[str, Any]:
        """Calls a tool: ``text`` and ``data``, or ``error`` and ``message``, or ``broke``: the server's own fault."""
        answer = self._ask({"tool": tool.name, "arguments": tool.arguments}, seconds)
        self.process = self.facts()["process"] or 0
        return answer

    def facts(self) -> dict[str, Any]:
        """``process``: Blender's number, None when none runs."""
        return self._ask({}, 60)

    def lie(self, source: str, lies: dict[str, str]) -> None:
        """What the program in Blender's place answers from here on."""
        self._ask({"source": source, "lies": lies}, 60)

    def clean(self, how: str) -> None:
        """Empties the workspace (``folder``), the scene too (``scene``), in a new Blender (``anew``)."""
        answer = self._ask({"clean": how}, 180)
        if "error" in answer:
            raise HostLost(f"the session is lost: {answer['message']}")
        self.process = answer["process"] or 0

    def _ask(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(request).encode() + b"\n")
            self._process.stdin.flush()
            line = self._lines.get(timeout=seconds)
        except queue.Empty:
            raise HostLost(f"the server did not answer within {seconds:g} s") from None
        except OSError as error:
            raise HostLost(f"the server has ended: {error}") from error
        if not line:
            raise HostLost(
                f"the server has ended, with {self._process.wait(10)}: {self.log.read_text()[-1500:]}"
            )
        return json.loads(line)

    def close(self) -> None:
        """Ends it, and everything that it has started."""
        assert self._process.stdin is not None
        with suppress(OSError):
            self._process.stdin.close()
        try:
            self._process.wait(10)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, signal.SIGKILL)
            self._process.wait()


def command_as(who: Who) -> tuple[str, ...]:
    """What stands before a command that runs as ``who``. Skips the test where that cannot be."""
    is_root = os.geteuid() == 0
    if who == "root":
        if not is_root:
            pytest.skip("these tests do not run as root")
        return ()
    if not is_root:
        return ()
    if subprocess.run([*_AS_USER, "true"], capture_output=True, check=False).returncode:
        pytest.skip("root cannot start a process as another user here (unshare --user)")
    return _AS_USER
