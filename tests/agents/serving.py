"""``simworlds mcp`` as processes of their own, and what becomes of the processes that they start."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mcp import StdioServerParameters
from places import REPO

from simworlds.settings import SHADERS_VARIABLE

if TYPE_CHECKING:
    from collections.abc import Iterable

COMMAND = [sys.executable, "-m", "simworlds", "mcp"]


def environment(home: Path, **more: str) -> dict[str, str]:
    """The environment of a server that keeps everything in ``home`` and knows nothing of the user's own settings.

    It has the shaders of all tests: each compiles its own otherwise.
    """
    dropped = ("SIMWORLDS_", "BLENDER_")
    kept = {
        name: value
        for name, value in os.environ.items()
        if name == SHADERS_VARIABLE or not name.startswith(dropped)
    }
    return {**kept, "SIMWORLDS_HOME": str(home), "PYTHONPATH": str(REPO), "PYTHONWARNINGS": "error", **more}


def over_stdio(home: Path, *options: str) -> StdioServerParameters:
    """How a client starts the server."""
    words = [*COMMAND, *options]
    return StdioServerParameters(command=words[0], args=words[1:], env=environment(home), cwd=REPO)


class ByHand:
    """A server on stdio that is spoken to line by line; ``started`` is when it was."""

    def __init__(self, home: Path, *options: str) -> None:
        self.started = time.perf_counter()
        self.process = subprocess.Popen(
            [*COMMAND, *options],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(home),
            cwd=REPO,
        )
        self._number = 0
        hello = {
            "protocolVersion": "2025-06-18",
            "capabilities": {},
            "clientInfo": {"name": "t", "version": "1"},
        }
        self.greeting = self.call("initialize", **hello)["result"]
        self.send(method="notifications/initialized")

    def __enter__(self) -> ByHand:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
            assert pipe is not None
            with contextlib.suppress(BrokenPipeError):
                pipe.close()

    def send(self, **message: Any) -> None:
        """Sends a message."""
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps({"jsonrpc": "2.0", **message}).encode() + b"\n")
        self.process.stdin.flush()

    def ask(self, method: str, **parameters: Any) -> int:
        """Sends a request; returns its number."""
        self._number += 1
        self.send(id=self._number, method=method, params=parameters)
        return self._number

    def receive(self) -> dict[str, Any]:
        """The next message."""
        assert self.process.stdout is not None
        return json.loads(self.process.stdout.readline())

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Sends a request and returns its answer; nothing else may come before."""
        number = self.ask(method, **parameters)
        answer = self.receive()
        assert answer["id"] == number
        return answer

    def run(self, code: str) -> str:
        """The value of a piece of code in Blender."""
        answer = self.call("tools/call", name="blender_execute", arguments={"code": code})
        return answer["result"]["structuredContent"]["value"]

    def begin(self, code: str) -> None:
        """Sends a piece of code, of which nothing is waited for but that it has begun."""
        begun = self.run("import os; os.getcwd()").strip("'") + "/begun"
        self.ask(
            "tools/call", name="blender_execute", arguments={"code": f"open({begun!r}, 'w').close()\n{code}"}
        )
        await_file(Path(begun))

    def hang_up(self) -> bytes:
        """Ends the conversation as a client does. Returns what was still said."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        return self.process.stdout.read()

    def said(self) -> str:
        """What it says on stderr until it ends."""
        assert self.process.stderr is not None
        return self.process.stderr.read().decode()


class OverHttp:
    """A server on a free port of the loopback address. ``url`` is what it says it serves at, ``said`` all before."""

    def __init__(self, home: Path, *options: str, **variables: str) -> None:
        self.process = subprocess.Popen(
            [*COMMAND, "--http", "--port", "0", *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(home, **variables),
            cwd=REPO,
            text=True,
        )
        assert self.process.stderr is not None
        self.said = ""
        for line in self.process.stderr:
            self.said += line
            if line.startswith("Serving"):
                break
        self.url = self.said.strip().rpartition(" ")[2]
        assert self.url.startswith("http"), self.said

    def __enter__(self) -> OverHttp:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    def end(self, number: signal.Signals = signal.SIGTERM) -> tuple[int, str, str]:
        """Sends a signal; the exit code, and what was printed meanwhile."""
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=60)
        return self.process.returncode, out, err


def below(pid: int) -> dict[int, str]:
    """Every process that descends from one, and its command line."""
    parents: dict[int, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            parents[int(folder.name)] = int((folder / "stat").read_text().rpartition(")")[2].split()[1])
    found: dict[int, str] = {}
    for one in parents:
        line, at = [one], parents[one]
        while at and at != pid:
            line.append(at)
            at = parents.get(at, 0)
        if at == pid:
            with contextlib.suppress(OSError):
                found[one] = Path(f"/proc/{one}/cmdline").read_bytes().replace(b"\0", b" ").decode()
    return found


def blenders(pid: int) -> set[int]:
    """The processes of Blenders (and of what confines them) that a server has started."""
    return {one for one, words in below(pid).items() if "simworlds_worker" in words}


def have_ended(pids: Iterable[int], seconds: float = 60.0) -> bool:
    """Whether processes end within some time."""
    deadline = time.monotonic() + seconds
    for pid in pids:
        try:
            watched = os.pidfd_open(pid)
        except ProcessLookupError:
            continue
        try:
            ready = select.select([watched], [], [], max(0.0, deadline - time.monotonic()))[0]
        finally:
            os.close(watched)
        if not ready:
            return False
    return True


def await_file(path: Path, seconds: float = 60.0) -> None:
    """Waits until a file is there."""
    deadline = time.monotonic() + seconds
    while not path.exists():
        assert time.monotonic() < deadline, f"{path} never came"
        time.sleep(0.01)
