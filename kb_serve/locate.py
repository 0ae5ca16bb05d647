"""Finds the knowledge base file of a Blender version."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_serve.errors import BaseMissing
from simworlds.errors import UserError
from simworlds.how_to_get_bases import how_to_get
from simworlds.releases import USUAL, minor_of
from simworlds.settings import base_path, built_bases, home_folder

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

_LONGEST_QUOTE = 40


def find_base(version: str | None, home: Path | None = None) -> Path:
    """The file of a version's base, by default of the newest. Raises BaseMissing with a list of those built."""
    folder = home or home_folder()
    built = built_bases(folder)
    if version is None:
        if not built:
            raise BaseMissing(f"There is no knowledge base in {folder}.", how_to_get(USUAL))
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
            how_to_get(wanted),
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
        raise BaseMissing(what, how_to_get(*lacking))
    for error in missing:
        raise error
    return files


def _names(built: dict[str, Path]) -> str:
    return ", ".join(built) or "none"
