"""Which Blender is in use: the executable of the caller, else this environment's bpy; and what is said of a base of
another one.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from simworlds.installed import installed_bpy
from simworlds.operating_system import SYSTEM
from simworlds.own_command import own_command
from simworlds.releases import is_same_minor, minor_of, version_key
from simworlds.terminal.lines import write_line

if TYPE_CHECKING:
    from pathlib import Path


def blender_in_use(executable: Path | None = None) -> str | None:
    """The full version (``"5.1.2"``) of ``executable``, else of this environment's bpy, if there is one.

    bpy is not imported: its distribution's metadata is enough.
    """
    found = installed_bpy() if executable is None else _version_of(executable)
    return ".".join(map(str, version_key(found))) if found else None  # a wheel's may end in "a1" or ".post1"


def other_in_use(have: str, in_use: str | None) -> str:
    """That Blender ``in_use`` is of another minor version than a base, or newer; empty where it is neither."""
    if in_use is None or not version_key(have):
        return ""
    if is_same_minor(have, in_use) and not is_newer(in_use, have):
        return ""
    return f"This is Blender {have}'s knowledge base, but Blender {in_use} is in use."


def is_newer(in_use: str, have: str) -> bool:
    """Whether a Blender is newer than the one that a base is of."""
    return bool(version_key(have)) and version_key(in_use) > version_key(have)


def how_to_build(in_use: str, executable: Path | None = None) -> str:
    """How to build the base of the Blender in use."""
    option = f" --blender-exe {SYSTEM.quoted(str(executable))}" if executable else ""
    return f"Build its base: {own_command()} kb build {minor_of(in_use)}{option}"


def note_on_base(have: str) -> str:
    """What a command says whose base was not chosen by its user: empty, or that another Blender is in use."""
    in_use = blender_in_use()
    note = other_in_use(have, in_use)
    return f"{note} {how_to_build(in_use)}" if note and in_use else ""


def tell_of_other(have: str) -> None:
    """Says on stderr what ``note_on_base`` says."""
    if note := note_on_base(have):
        write_line(sys.stderr, note)


def _version_of(executable: Path) -> str | None:
    from simworlds.sandbox.errors import RuntimeMissing  # noqa: PLC0415 - most callers name no executable
    from simworlds.sandbox.runtime import executable_version  # noqa: PLC0415

    try:
        return executable_version(executable)
    except RuntimeMissing:
        return None
