"""Finds the knowledge base file of a Blender version."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.errors import BaseMissing
from simworlds.errors import UserError
from simworlds.own_command import own_command
from simworlds.releases import USUAL, minor_of, release, releases, version_key
from simworlds.settings import base_path, built_bases, home_folder

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_LONGEST_QUOTE = 40
_OLDEST = (3, 1)  # the first Blender with Python 3.10, which what reads it needs


def find_base(version: str | None, home: Path | None = None) -> Path:
    """The file of a version's base, by default of the newest. Raises BaseMissing with a list of those built."""
    folder = home or home_folder()
    built = built_bases(folder)
    if version is None:
        if not built:
            raise BaseMissing(f"There is no knowledge base in {folder}.", _how_to_get(USUAL))
        return list(built.values())[-1]
    try:
        wanted = minor_of(version)
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


def find_bases(versions: Iterable[str], home: Path | None = None) -> dict[str, Path]:
    """Version → file, in the order given. Raises BaseMissing, which names all versions that have none."""
    files: dict[str, Path] = {}
    missing: list[BaseMissing] = []
    lacking: list[str] = []
    for version in versions:
        try:
            files[version] = find_base(version, home)
        except BaseMissing as error:
            missing.append(error)
            lacking.append(version)
    if len(missing) > 1:
        built = _names(built_bases(home or home_folder()))
        what = f"There are no knowledge bases for Blender {', '.join(lacking)}. Built are: {built}."
        raise BaseMissing(what, _how_to_get(*lacking))
    for error in missing:
        raise error
    return files


def _how_to_get(*versions: str) -> str:
    """How to get the bases of these versions: of those that have no bpy package, from an installed Blender alone."""
    command = own_command()
    usual = [version for version in versions if release(version) is not None]
    parts: list[str] = []
    if usual:
        builds = "; ".join(f"{command} kb build {version}" for version in usual)
        it, one, each = ("it", "a ready one", "") if len(usual) == 1 else ("them", "ready ones", " each")
        fetched = usual[0] if len(usual) == 1 else "VERSION"
        parts.append(
            f"Build {it}: {builds} (a minute{each}; without Blender in this environment, its bpy package is fetched "
            f"first, 350 MB). Or fetch {one}: {command} kb fetch {fetched} --from URL|FILE."
        )
    known = ", ".join(row.minor for row in releases())
    for version in versions:
        if version_key(version) < _OLDEST:
            oldest = ".".join(map(str, _OLDEST))
            parts.append(
                f"No base can be built of Blender {version}: it is older than {oldest}. Bases of newer Blenders know "
                "what became of its names: ask one of them."
            )
        elif version not in usual:
            parts.append(
                f"Blender {version} has no bpy package to build a base from (only {known} have). If it is installed, "
                f"give its program: {command} kb build {version} --blender-exe /path/to/blender."
            )
    return " ".join(parts)


def _names(built: dict[str, Path]) -> str:
    return ", ".join(built) or "none"
