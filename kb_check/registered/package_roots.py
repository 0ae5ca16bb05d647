"""Tells which package a file belongs to, and which other packages of its project it uses."""

from __future__ import annotations

import os
import re
import stat
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from kb_check.text.source import MOST_BYTES

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping

_PACKAGE_MARKS = ("__init__.py", "blender_manifest.toml")
_PROJECT_MARKS = (".git", "pyproject.toml")  # what lies above belongs to others
_ENVIRONMENT = "pyvenv.cfg"
_SOURCES = ("", "src")  # where a project has its packages
_NAME = re.compile(rb"[A-Za-z_]\w*")
_GIVEN_NAME = re.compile(rb"""(?:\b(?:import|from)[ \t]+|["'])([A-Za-z_]\w*)""")


@cache
def package_root(folder: Path) -> Path | None:
    """The topmost folder that is marked as a package, of those that hold the folder within its project.

    A folder that Python cannot import from ends a package, and none begins in a folder that belongs to everyone.
    """
    root = None
    for here in (folder, *folder.parents):
        if _is_everyones(here):
            break
        if _is_package(here):
            root = here
        if not here.name.isidentifier() or _is_project(here):
            break
    return root


def packages_used(files: Iterable[Path], folder: Path, beside: Mapping[str, Path]) -> set[Path]:
    """The packages of the project around a folder that files name, by their folders: they import them, or have Blender
    enable them. Files are given as they are, links resolved. ``beside``: name → folder of packages of which it is not
    known that they are of that project; those it must import, or give by their name.
    """
    project = _project_top(folder)
    packages = {} if project is None else _packages_of(project)
    used: set[Path] = set()
    for file in files:
        used.update(packages[name] for name in _names_in(file, packages, _NAME))
        used.update(beside[name] for name in _names_in(file, beside, _GIVEN_NAME))
    return used


@cache
def _project_top(folder: Path) -> Path | None:
    """The nearest folder that is marked as a project; None where there is none, or an environment lies between."""
    for here in (folder, *folder.parents):
        if _is_everyones(here) or (here / _ENVIRONMENT).exists():
            return None
        if _is_project(here):
            return here
    return None


@cache
def _packages_of(project: Path) -> dict[str, Path]:
    """Name → folder of each package that other files of a project can import."""
    folders = (folder for place in _SOURCES for folder in _folders_in(project / place))
    return {folder.name: folder for folder in folders if _is_package(folder)}


def _folders_in(folder: Path) -> list[Path]:
    try:
        return [path for path in folder.iterdir() if path.is_dir() and not path.is_symlink()]
    except OSError:
        return []


def _names_in(file: Path, names: Container[str], form: re.Pattern[bytes]) -> Iterator[str]:
    """Those of the names that stand in a file in some form; none if it cannot be read, which is told elsewhere."""
    if not names:
        return
    try:
        with file.open("rb") as stream:
            code = stream.read(MOST_BYTES)
    except OSError:
        return
    yield from (name for word in set(form.findall(code)) if (name := word.decode()) in names)


def _is_package(folder: Path) -> bool:
    return any((folder / mark).is_file() for mark in _PACKAGE_MARKS)


def _is_project(folder: Path) -> bool:
    return any((folder / mark).exists() for mark in _PROJECT_MARKS)


def _is_everyones(folder: Path) -> bool:
    """Whether a folder is a user's home, the system's, or one that anybody may put files in: no package of anybody."""
    if folder in {Path(os.path.realpath(Path.home())), Path(folder.anchor)}:
        return True
    try:
        return bool(folder.stat().st_mode & stat.S_ISVTX)
    except OSError:
        return False
