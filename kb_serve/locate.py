"""Finds the knowledge base file of a Blender version."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.errors import BaseMissing
from simworlds.errors import UserError
from simworlds.own_command import own_command
from simworlds.releases import USUAL, minor_of
from simworlds.settings import base_path, built_bases, home_folder

if TYPE_CHECKING:
    from pathlib import Path

_LONGEST_QUOTE = 40


def find_base(version: str | None, home: Path | None = None) -> Path:
    """The file of a version's base, by default of the newest. Raises BaseMissing with a list of those built."""
    folder = home or home_folder()
    built = built_bases(folder)
    if version is None:
        if not built:
            raise BaseMissing(f"There is no knowledge base in {folder}.", _how_to_get(USUAL))
        return list(built.values())[-1]
    try:
        wanted = minor_of(version.strip().removeprefix("v"))
    except UserError:
        raise BaseMissing(
            f"{version[:_LONGEST_QUOTE]!r} is not a Blender version. Write it as 5.1. Built are: {_names(built)}."
        ) from None
    path = base_path(folder, wanted)
    if not path.is_file():
        raise BaseMissing(
            f"There is no knowledge base for Blender {wanted}. Built are: {_names(built)}.",
            _how_to_get(wanted),
        )
    return path


def _how_to_get(version: str) -> str:
    command = own_command()
    return (
        f"Build it: {command} kb build {version} (a minute; without Blender in this environment, its bpy package is "
        f"fetched first, 350 MB). Or fetch a ready one: {command} kb fetch {version} --from URL|FILE."
    )


def _names(built: dict[str, Path]) -> str:
    return ", ".join(built) or "none"
