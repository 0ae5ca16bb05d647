"""Finds the knowledge base file of a Blender version."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.errors import BaseMissing
from simworlds.settings import base_path, built_bases, home_folder

if TYPE_CHECKING:
    from pathlib import Path

_VERSION = re.compile(r"(\d+)\.(\d+)(?:\.\d+)?")


def find_base(version: str | None, home: Path | None = None) -> Path:
    """The file of a version's base, by default of the newest. Raises BaseMissing with a list of those built."""
    folder = home or home_folder()
    built = built_bases(folder)
    if version is None:
        if not built:
            raise BaseMissing(
                f"There is no knowledge base in {folder}. Build one first: simworlds kb build 5.1"
            )
        return list(built.values())[-1]
    match = _VERSION.fullmatch(version.strip().removeprefix("v"))
    if not match:
        raise BaseMissing(
            f"{version!r} is not a Blender version. Write it as 5.1. Built are: {_names(built)}."
        )
    path = base_path(folder, f"{match[1]}.{match[2]}")
    if not path.is_file():
        raise BaseMissing(
            f"There is no knowledge base for Blender {match[1]}.{match[2]}. Built are: {_names(built)}. "
            f"Build it: simworlds kb build {match[1]}.{match[2]}"
        )
    return path


def _names(built: dict[str, Path]) -> str:
    return ", ".join(built) or "none"
