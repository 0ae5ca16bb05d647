"""The Blenders of this user that listen: where they are, and which one is meant."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from pydantic import Field, ValidationError

from agents.blender.inside.attached.connection import announcement
from simworlds.operating_system import SYSTEM
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.replies import Claim, Name, Place

OPEN, AUTO = "open", "auto"
"""The open Blender, which must be the only one; or the same if there is one."""

_HOW = (
    "Open Blender, press N over the 3D view, choose the tab SimWorlds, and press Start. Without that tab: "
    "simworlds extension install."
)
_LARGEST = 100_000


class Rights(Claim):
    """What the user allows."""

    change: bool
    code: bool
    unrehearsed: bool


class About(Claim):
    """What an open Blender says of itself."""

    process: int = Field(ge=1)
    blender: Name
    executable: Place
    extension: Name
    file: Place
    scene: Name
    may: Rights

    @property
    def version(self) -> str:
        """Its version's numbers: 3.4.1."""
        return self.blender.split()[0]

    def __str__(self) -> str:
        name = Path(self.file).name if self.file else "an unsaved file"
        return f"Blender {self.version} with {name} (process {self.process})"


class _Announced(About):
    port: int = Field(ge=1, le=65535)
    token: str = Field(min_length=32, max_length=200)


@dataclass(frozen=True, slots=True)
class OpenBlender:
    """One that listens on ``port``, to whoever knows ``token``."""

    about: About
    port: int
    token: str


def open_blenders() -> list[OpenBlender]:
    """Those that listen, by process; files of others' making or of ended processes do not count."""
    found: list[OpenBlender] = []
    try:
        paths = sorted(Path(announcement.folder()).glob("*.json"))
    except OSError:
        return found
    for path in paths:
        try:
            announced = _Announced.model_validate(_read(path))
        except (OSError, ValueError, ValidationError):
            continue
        if not SYSTEM.is_running(announced.process):
            path.unlink(missing_ok=True)
            continue
        about = About.model_validate(announced.model_dump(exclude={"port", "token"}))
        found.append(OpenBlender(about, announced.port, announced.token))
    return found


def _read(path: Path) -> object:
    """Raises OSError, and ValueError if others can read or may have written the file."""
    with path.open("rb") as file:
        status = os.fstat(file.fileno())
        if sys.platform != "win32" and (status.st_uid != os.getuid() or status.st_mode & 0o077):
            raise ValueError("others can read it")
        return json.loads(file.read(_LARGEST))


def choose(wanted: str) -> OpenBlender:
    """The Blender that is meant: ``open``, ``auto``, a process's number, (part of) its file's name. Raises Refusal."""
    candidates = open_blenders()
    if wanted not in {OPEN, AUTO}:
        candidates = [
            blender
            for blender in candidates
            if wanted == str(blender.about.process)
            or wanted == blender.about.file
            or wanted in Path(blender.about.file).name
        ]
    if len(candidates) == 1:
        return candidates[0]
    if not candidates:
        which = "No open Blender listens" if wanted in {OPEN, AUTO} else f"No open Blender is {wanted!r}"
        raise Refusal(f"{which}. {_HOW}")
    listed = "; ".join(str(blender.about) for blender in candidates)
    raise Refusal(
        f"Several Blenders listen: {listed}. Say which: simworlds mcp --attach={candidates[0].about.process}, or a "
        "part of its file's name."
    )
