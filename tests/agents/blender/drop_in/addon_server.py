"""``simworlds mcp --as blender-mcp`` as a process of its own, and clients that speak to its socket by hand."""

from __future__ import annotations

import contextlib
import json
import re
import signal
import socket
import struct
import subprocess
from typing import TYPE_CHECKING, Any

from serving import COMMAND, REPO, environment

if TYPE_CHECKING:
    from pathlib import Path

SECONDS = 120.0  # a reply that takes longer does not come


class RawClient:
    """A connection; what is sent is up to the caller."""

    def __init__(self, port: int) -> None:
        self.socket = socket.create_connection(("127.0.0.1", port), SECONDS)
        self._bytes = b""

    def __enter__(self) -> RawClient:
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def send(self, data: bytes) -> None:
        self.socket.sendall(data)

    def ask(self, command: str, **params: Any) -> dict[str, Any]:
        """Sends a command; its whole reply."""
        self.send(message(command, **params))
        return self.receive()

    def result(self, command: str, **params: Any) -> dict[str, Any]:
        """The result of a command that must not fail."""
        reply = self.ask(command, **params)
        assert reply["status"] == "success", reply
        return reply["result"]

    def run(self, code: str) -> str:
        """What code prints."""
        return self.result("execute_code", code=code)["result"]

    def receive(self) -> dict[str, Any]:
        """The next reply."""
        while True:
            with contextlib.suppress(ValueError):
                reply, end = json.JSONDecoder().raw_decode(self._bytes.decode())
                self._bytes = self._bytes.decode()[end:].encode()
                return reply
            data = self.socket.recv(1 << 16)
            assert data, f"closed after {self._bytes[-200:]!r}"
            self._bytes += data

    def is_closed(self) -> bool:
        """Whether the server closes the connection, with nothing more to say."""
        try:
            return not self.socket.recv(1)
        except ConnectionResetError:
            return True

    def vanish(self) -> None:
        """Goes as a killed program goes: with a reset."""
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.socket.close()


class AddonServer:
    """A server on a free port, whose temporary folder is ``temporary``."""

    def __init__(self, home: Path, *options: str) -> None:
        self.temporary = home / "temporary"
        self.temporary.mkdir(parents=True, exist_ok=True)
        self.process = subprocess.Popen(
            [*COMMAND, "--as", "blender-mcp", "--port", "0", *options],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=environment(home, TMPDIR=str(self.temporary)),
            cwd=REPO,
            text=True,
        )
        assert self.process.stderr is not None
        self.said = ""
        for line in self.process.stderr:
            self.said += line
            if line.startswith("Serving"):
                break
        found = re.search(r"127\.0\.0\.1:(\d+)", self.said)
        assert found, self.said
        self.port = int(found[1])

    def __enter__(self) -> AddonServer:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.communicate()

    def client(self) -> RawClient:
        """A new connection."""
        return RawClient(self.port)

    def end(self, number: signal.Signals = signal.SIGINT) -> tuple[int, str, str]:
        """Sends a signal; the exit code, and what was printed meanwhile."""
        self.process.send_signal(number)
        out, err = self.process.communicate(timeout=60)
        return self.process.returncode, out, err


def message(command: str, **params: Any) -> bytes:
    """A command as clients send it."""
    return json.dumps({"type": command, "params": params}).encode()
