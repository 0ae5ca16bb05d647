"""Where things lie on this machine: one folder, moved by SIMWORLDS_HOME, the user's own sources, and what ~ is."""

from __future__ import annotations

import os
import re
from pathlib import Path

from simworlds.releases import minor_of

HOME_VARIABLE = "SIMWORLDS_HOME"
CORPORA_VARIABLE = "SIMWORLDS_CORPORA"
BASE_URL_VARIABLE = "SIMWORLDS_BASE_URL"
SHADERS_VARIABLE = "SIMWORLDS_SHADERS"

_BASE = re.compile(r"blender-(\d+)\.(\d+)\.sqlite")


def expanded(path: Path) -> Path:
    """The path with a home folder in place of ``~``; as it is where there is none."""
    try:
        return path.expanduser()
    except RuntimeError:  # a user that there is not, or one without a home
        return path


def home_folder() -> Path:
    """The folder that everything is kept in: what SIMWORLDS_HOME names, else the user's data folder."""
    if named := os.environ.get(HOME_VARIABLE):
        return expanded(Path(named)).absolute()
    import platformdirs  # noqa: PLC0415 - most callers name their folder

    return platformdirs.user_data_path("simworlds", appauthor=False)


def corpora_folder() -> Path | None:
    """The folder of documentation sources that SIMWORLDS_CORPORA names, if it does."""
    named = os.environ.get(CORPORA_VARIABLE)
    return expanded(Path(named)).absolute() if named else None


def ready_base_source() -> str:
    """Where ready bases can be fetched from, as SIMWORLDS_BASE_URL says; empty if nothing does."""
    named = os.environ.get(BASE_URL_VARIABLE, "").strip()
    return (
        "" if named.startswith("${") else named
    )  # a client that fills no empty setting in passes on its name


def base_path(home: Path, version: str) -> Path:
    """The knowledge base of a Blender version (its patch does not matter), whether it exists or not."""
    return home / "kb" / f"blender-{minor_of(version)}.sqlite"


def built_bases(home: Path) -> dict[str, Path]:
    """Minor version → file of every knowledge base that was built, oldest Blender first."""
    found = [
        (int(match[1]), int(match[2]), path)
        for path in (home / "kb").glob("blender-*.sqlite")
        if (match := _BASE.fullmatch(path.name)) and path.is_file()
    ]
    return {f"{major}.{minor}": path for major, minor, path in sorted(found)}


def version_of_base(path: Path) -> str:
    """The minor version of a base that is named as ``base_path`` names it; empty for a file of another name."""
    match = _BASE.fullmatch(path.name)
    return f"{int(match[1])}.{int(match[2])}" if match else ""


def cache_folder(home: Path) -> Path:
    """What can be made or fetched again: downloads, unpacked archives, pages that were read, digests."""
    return home / "cache"


def extracts_folder(home: Path) -> Path:
    """What Blender said of itself, one file a version."""
    return home / "extracts"


def summaries_path(home: Path) -> Path:
    """The summaries that were paid for; shared by all bases."""
    return home / "summaries.sqlite"
