"""Finds out which Blender is in use: the executable of the caller, else this environment's bpy."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

_SECONDS = 20.0
_VERSION = re.compile(r"^Blender (\d+\.\d+\.\d+)", re.MULTILINE)


def blender_in_use(executable: Path | None = None) -> str | None:
    """The full version (``"5.1.2"``) of ``executable``, else of this environment's bpy, if there is one.

    bpy is not imported: its distribution's metadata is enough.
    """
    return _version_of(executable) if executable is not None else _installed()


def _installed() -> str | None:
    from importlib import metadata  # noqa: PLC0415 - not needed where there is only one base

    try:
        return metadata.version("bpy")
    except metadata.PackageNotFoundError:
        return None


def _version_of(executable: Path) -> str | None:
    import subprocess  # noqa: PLC0415 - most callers name no executable

    try:
        done = subprocess.run(
            [str(executable), "--version"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    match = _VERSION.search((done.stdout + done.stderr).decode(errors="replace"))
    return match[1] if match else None


def minor(version: str) -> str:
    """``"5.1.2"`` → ``"5.1"``."""
    return ".".join(version.split(".")[:2])
