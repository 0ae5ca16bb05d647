"""``simworlds check``, and commands like it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from places import REPO
from running import run_here

if TYPE_CHECKING:
    from pathlib import Path

SIMWORLDS = [sys.executable, "-m", "simworlds"]
WRONG = 'import bpy\nbpy.context.object.draw_type = "WIRE"\n'
RIGHT = 'import bpy\nbpy.context.object.display_type = "WIRE"\n'


@dataclass(frozen=True)
class Outcome:
    """What a command printed, and how it ended."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        return json.loads(self.out)

    @property
    def places(self) -> list[tuple[str, int, str]]:
        """(path, line, rule) of each finding, of a run with --json."""
        return [(row["path"], row["line"], row["rule"]) for row in self.json["findings"]]


@dataclass(frozen=True)
class Command:
    """Runs in ``folder``, with the knowledge bases of ``home``."""

    home: Path
    folder: Path
    name: str = "check"

    def write(self, name: str, content: str | bytes) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    def read(self, name: str) -> bytes:
        return (self.folder / name).read_bytes()

    @property
    def environment(self) -> dict[str, str]:
        kept = {name: value for name, value in os.environ.items() if not name.startswith("SIMWORLDS_")}
        more = {"SIMWORLDS_HOME": str(self.home), "PYTHONPATH": str(REPO), "PYTHONWARNINGS": "error"}
        return {**kept, **more}

    def __call__(self, *arguments: str, given: bytes = b"", folder: Path | None = None) -> Outcome:
        done = run_here([self.name, *arguments], self.environment, folder or self.folder, given)
        return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())

    def bytes_of(self, *arguments: str, given: bytes = b"") -> bytes:
        """What it prints."""
        return run_here([self.name, *arguments], self.environment, self.folder, given).stdout

    def as_process(self, *arguments: str, given: bytes = b"", folder: Path | None = None) -> Outcome:
        """The same in a process of its own."""
        done = subprocess.run(
            [*SIMWORLDS, self.name, *arguments],
            input=given,
            capture_output=True,
            cwd=folder or self.folder,
            env=self.environment,
            check=False,
        )
        return Outcome(done.returncode, done.stdout.decode(), done.stderr.decode())
