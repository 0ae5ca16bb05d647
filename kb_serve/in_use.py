"""Finds out which Blender is in use: the executable of the caller, else this environment's bpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from simworlds.installed import installed_bpy
from simworlds.releases import version_key

if TYPE_CHECKING:
    from pathlib import Path


def blender_in_use(executable: Path | None = None) -> str | None:
    """The full version (``"5.1.2"``) of ``executable``, else of this environment's bpy, if there is one.

    bpy is not imported: its distribution's metadata is enough.
    """
    found = installed_bpy() if executable is None else _version_of(executable)
    return ".".join(map(str, version_key(found))) if found else None  # a wheel's may end in "a1" or ".post1"


def _version_of(executable: Path) -> str | None:
    from simworlds.sandbox.errors import RuntimeMissing  # noqa: PLC0415 - most callers name no executable
    from simworlds.sandbox.runtime import executable_version  # noqa: PLC0415

    try:
        return executable_version(executable)
    except RuntimeMissing:
        return None
