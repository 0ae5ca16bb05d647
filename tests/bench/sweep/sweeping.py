"""``simworlds bench`` as a process of its own, and what it leaves."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
from typing import TYPE_CHECKING, Any

from places import REPO

from simworlds.files import sha256_of_file

if TYPE_CHECKING:
    from pathlib import Path

# Small frames, nobody who judges.
CHEAP = ("--frame-size", "32x18", "--frame-samples", "1", "--judge", "none")
SCENES = "cloth_D1,rigid_D1_01,static_D1_01"
_SECONDS = 200.0


class Command:
    """Started when it is made."""

    def __init__(self, home: Path, *words: object, **environment: str) -> None:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("ANTHROPIC_")}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "simworlds", "bench", *map(str, words)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=kept | {"SIMWORLDS_HOME": str(home), "PYTHONPATH": str(REPO), **environment},
            text=True,
            start_new_session=True,
        )
        self._said: list[str] = []
        self._heard = threading.Condition()
        self._listener = threading.Thread(target=self._listen)
        self._listener.start()

    def _listen(self) -> None:
        assert self.process.stderr is not None
        for line in self.process.stderr:
            with self._heard:
                self._said.append(line)
                self._heard.notify_all()

    def until(self, said: str) -> None:
        """Waits until it has said these words on stderr."""
        with self._heard:
            assert self._heard.wait_for(lambda: said in "".join(self._said), _SECONDS), self._said

    def end(self) -> tuple[int, str, str]:
        """(exit code, stdout, stderr)."""
        assert self.process.stdout is not None
        out = self.process.stdout.read()
        code = self.process.wait(_SECONDS)
        self._listener.join(_SECONDS)
        return code, out, "".join(self._said)

    def kill(self, number: signal.Signals = signal.SIGKILL) -> None:
        """Sends a signal to it alone, and waits until it has ended."""
        self.process.send_signal(number)
        self.process.wait(_SECONDS)
        self._listener.join()
        for pipe in (self.process.stdout, self.process.stderr):
            assert pipe is not None
            pipe.close()


def record(results: Path, scene: str) -> dict[str, Any]:
    """A scene's record."""
    return json.loads((results / scene / "record.json").read_text())


def content(results: Path) -> dict[str, str]:
    """{path: SHA-256} of audits and frames: what does not depend on when it was made."""
    return {
        path.relative_to(results).as_posix(): sha256_of_file(path)
        for pattern in ("*/audit.json", "*/frames/*.png")
        for path in results.glob(pattern)
    }


def scores(results: Path) -> dict[str, tuple[Any, ...]]:
    """Scene → what the audit found, or why it did not."""
    found = {
        path.parent.name: json.loads(path.read_text())["audited"] for path in results.glob("*/record.json")
    }
    return {scene: (audited["mpr"], audited["spr"], audited["why"]) for scene, audited in found.items()}


def written(results: Path) -> dict[str, int]:
    """When each record was written."""
    return {path.parent.name: path.stat().st_mtime_ns for path in results.glob("*/record.json")}
