"""The command: in this process, and as one of its own."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
import tempfile
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import pytest
from places import REPO

from simworlds.cli import main

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

COMMAND = [sys.executable, "-m", "simworlds"]


def environment(home: Path, **more: str) -> dict[str, str]:
    """The environment of a command that works in ``home`` and knows nothing of the user's own settings."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith("SIMWORLDS_")}
    return {**kept, "SIMWORLDS_HOME": str(home), "PYTHONPATH": str(REPO), "PYTHONWARNINGS": "error", **more}


def run_here(
    words: Sequence[str], environment: Mapping[str, str], folder: Path, given: bytes = b""
) -> subprocess.CompletedProcess[bytes]:
    """What the command says and does in that environment and folder; a process's start is spared.

    An exception that the command does not turn into words fails the test. Its streams are files: processes that it
    starts write to them, too.
    """
    with ExitStack() as opened:
        files = [opened.enter_context(tempfile.TemporaryFile()) for _ in range(3)]
        patch = opened.enter_context(pytest.MonkeyPatch.context())
        files[0].write(given)
        files[0].seek(0)
        for name, file in zip(("stdin", "stdout", "stderr"), files, strict=True):
            errors = "backslashreplace" if name == "stderr" else "strict"
            stream = io.TextIOWrapper(file, "utf-8", errors, write_through=True)
            patch.setattr(sys, name, opened.enter_context(stream))
        for name in os.environ.keys() - environment.keys():
            patch.delenv(name)
        for name, value in environment.items():
            patch.setenv(name, value)
        patch.chdir(folder)
        patch.setattr(tempfile, "tempdir", None)
        with pytest.raises(SystemExit) as ended:
            main(list(words), prog_name="simworlds")
        for file in files[1:]:
            file.seek(0)
        code = ended.value.code
        assert code is None or isinstance(code, int)
        return subprocess.CompletedProcess(list(words), code or 0, files[1].read(), files[2].read())


class Wire:
    """The other end of a server's stdin and stdout, read and written line by line."""

    def __init__(self, words: list[str], home: Path, **more: str) -> None:
        self.process = subprocess.Popen(
            words,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=environment(home, **more),
            cwd=REPO,
        )
        self._number = 0

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Sends a request and returns what comes back."""
        self._number += 1
        self.send({"id": self._number, "method": method, "params": parameters})
        return self.receive()

    def send(self, message: dict[str, Any] | str) -> None:
        """Sends a message, or a line that is none."""
        assert self.process.stdin is not None
        line = message if isinstance(message, str) else json.dumps({"jsonrpc": "2.0", **message})
        self.process.stdin.write(line.encode() + b"\n")
        self.process.stdin.flush()

    def receive(self) -> dict[str, Any]:
        """The next message."""
        assert self.process.stdout is not None
        return json.loads(self.process.stdout.readline())

    def shake_hands(self) -> dict[str, Any]:
        """What the server says of itself."""
        client = {"name": "test", "version": "1"}
        answer = self.call("initialize", protocolVersion="2025-06-18", capabilities={}, clientInfo=client)
        self.send({"method": "notifications/initialized"})
        return answer["result"]

    def ask(self, query: str, **more: Any) -> dict[str, Any]:
        """The result of a call of the tool."""
        return self.call("tools/call", name="blender_docs", arguments={"query": query, **more})["result"]

    def close(self) -> bytes:
        """Ends the conversation as a client does. Returns what was still said."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        return self.process.stdout.read()


def _limited(descriptors: int | None) -> list[str]:
    """What begins a command that is to have so few descriptors."""
    return ["sh", "-c", f'ulimit -n {descriptors} && exec "$@"', "sh"] if descriptors is not None else []


class HttpServer:
    """``simworlds serve --http`` on a free port of the loopback address. ``url`` is what it says it serves at."""

    def __init__(
        self, home: Path, *arguments: str, descriptors: int | None = None, **environment_variables: str
    ) -> None:
        self.process = subprocess.Popen(
            [*_limited(descriptors), *COMMAND, "serve", "--http", "--port", "0", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(home, **environment_variables),
            cwd=REPO,
            text=True,
        )
        assert self.process.stderr is not None
        self.url = self.process.stderr.readline().strip().rpartition(" ")[2]

    def __enter__(self) -> HttpServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    def end(self, number: int) -> tuple[int, str, str]:
        """Sends a signal; the exit code, and what was printed meanwhile."""
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=60)
        return self.process.returncode, out, err
