"""Runs one of the two servers over HTTP on a free port."""

from __future__ import annotations

import contextlib
import queue
import subprocess
import threading
from typing import IO, TYPE_CHECKING

from measurements.setting import REPO, environment

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence

    from measurements.setting import Setting

_START_SECONDS = 120  # of a machine that others use as well
_END_SECONDS = 30.0


class NoServer(Exception):  # noqa: N818 - reads as the state it names
    """The HTTP server did not start; the message has its output."""


@contextlib.contextmanager
def running(
    command: Sequence[str], setting: Setting, variables: Mapping[str, str] | None = None
) -> Generator[tuple[str, subprocess.Popen[str]]]:
    """A server: its address and process. ``variables`` are more of its environment's. Raises NoServer."""
    process = subprocess.Popen(
        [*command, "--http", "--port", "0"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**environment(setting.home), **(variables or {})},
        cwd=REPO,
    )
    try:
        assert process.stderr is not None
        yield _address_printed(process.stderr), process
    finally:
        process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(_END_SECONDS)
        process.kill()
        process.wait()


def _address_printed(stream: IO[str]) -> str:
    """Reads the address that the server prints on stderr; later output is read and dropped."""
    addresses: queue.Queue[str] = queue.Queue()
    lines: list[str] = []

    def read() -> None:
        for line in stream:
            lines.append(line.strip())
            if "http://" in line:
                addresses.put("http://" + line.split("http://", 1)[1].split()[0])
        addresses.put("")

    threading.Thread(target=read, daemon=True).start()
    try:
        url = addresses.get(timeout=_START_SECONDS)
    except queue.Empty:
        url = ""
    if not url:
        raise NoServer(f"The server printed no address: {' '.join(lines[-3:]) or 'it printed nothing'}")
    return url
