"""Finds the files to check, and the packages that they belong to: what one file registers, the others may use."""

from __future__ import annotations

import os
import stat
from dataclasses import dataclass, field
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from kb_check.gitignore import GitIgnore
from kb_check.source import NOTEBOOK
from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

SUFFIXES = (".py", ".pyw", NOTEBOOK)
_PASSED_OVER = frozenset(("__pycache__", "node_modules", "site-packages"))
_PACKAGE_MARKS = ("__init__.py", "blender_manifest.toml")
_TOP_MARKS = (".git", "pyproject.toml")  # a project's folder: what lies above belongs to others
_MOST_FILES = 50_000


@dataclass(frozen=True, slots=True)
class CodeFile:
    """A file by its path as it is shown. Of one that is not ``wanted`` only what it registers counts."""

    path: Path
    wanted: bool = True


@dataclass(frozen=True, slots=True)
class FileGroup:
    """Files of one package, or one file that belongs to none."""

    files: tuple[CodeFile, ...]


@dataclass(slots=True)
class FoundFiles:
    """The groups of files below some paths, and a sentence for each path that has nothing to check."""

    groups: list[FileGroup] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)


def find_files(
    paths: Iterable[Path], exclude: Sequence[str] = (), top: Path | None = None, *, gitignore: bool = True
) -> FoundFiles:
    """The Python files and notebooks at and below ``paths``, by package.

    ``exclude`` are patterns of names or of paths below ``top``. ``gitignore``: what git leaves out is left out. Links
    are followed where they are named, not where they are found; so are hidden files, environments and what git leaves
    out. Raises UserError for far too many files.
    """
    excluded = _Excluded(exclude, (top or Path()).absolute())
    found = FoundFiles()
    wanted: dict[Path, Path] = {}  # as it is → as it is shown
    for path in paths:
        if path.is_dir():
            below = list(_below(path, excluded, GitIgnore(path) if gitignore else None))
            if not below:
                found.faults.append(f"There are no Python files in {path}.")
        elif path.is_file():
            below = [] if excluded.has(path) else [path]
        else:
            below = []
            found.faults.append(f"There is no file or folder {path}.")
        for file in below:
            wanted.setdefault(Path(os.path.realpath(file)), file)
            if len(wanted) > _MOST_FILES:
                raise UserError(
                    f"There are more than {_MOST_FILES:,} Python files. Check a part of them at a time."
                )
    found.groups = list(_grouped(wanted, excluded))
    return found


def _grouped(wanted: dict[Path, Path], excluded: _Excluded) -> Iterator[FileGroup]:
    packages: dict[Path, list[CodeFile]] = {}
    for real, shown in wanted.items():
        root = None if real.suffix == NOTEBOOK else _package_root(real.parent)
        if root is None:
            yield FileGroup((CodeFile(shown),))
        else:
            packages.setdefault(root, []).append(CodeFile(shown))
    for root, files in packages.items():
        others = [
            CodeFile(path, wanted=False)
            for path in _below(root, excluded)
            if path.suffix != NOTEBOOK and Path(os.path.realpath(path)) not in wanted
        ]
        yield FileGroup((*files, *others[:_MOST_FILES]))


def _below(folder: Path, excluded: _Excluded, ignored: GitIgnore | None = None) -> Iterator[Path]:
    """The files below a folder, sorted; what cannot be listed is passed over."""
    for here, folders, names in os.walk(folder):
        inside = Path(here)
        folders[:] = sorted(
            name
            for name in folders
            if not name.startswith(".") and name not in _PASSED_OVER and not excluded.has(inside / name)
            and not (inside / name / "pyvenv.cfg").exists()
            and not (ignored is not None and ignored.leaves_out(inside / name, is_folder=True))
        )  # fmt: skip
        for name in sorted(names):
            path = inside / name
            if (
                name.endswith(SUFFIXES)
                and not name.startswith(".")
                and path.is_file()
                and not path.is_symlink()
                and not excluded.has(path)
                and not (ignored is not None and ignored.leaves_out(path, is_folder=False))
            ):
                yield path


@dataclass(frozen=True, slots=True)
class _Excluded:
    patterns: Sequence[str]
    top: Path

    def has(self, path: Path) -> bool:
        """Whether a pattern has the path's name, or the path itself."""
        return bool(self.patterns) and matches(path, self.patterns, self.top)


def matches(path: Path, patterns: Iterable[str], top: Path) -> bool:
    """Whether one of the patterns has the name of a path or of a folder that it lies in, or the path below ``top``."""
    whole = path.absolute()
    relative = whole.relative_to(top) if whole.is_relative_to(top) else whole
    steps = [relative, *relative.parents][:-1] or [relative]
    return any(
        fnmatch(step.name, pattern.rstrip("/")) or fnmatch(step.as_posix(), pattern.rstrip("/"))
        for pattern in patterns
        for step in steps
    )


@cache
def _package_root(folder: Path) -> Path | None:
    """The topmost folder that is marked as a package, of those that hold the folder within its project.

    A folder that Python cannot import from ends a package, and none begins in a folder that belongs to everyone.
    """
    root = None
    for here in (folder, *folder.parents):
        if _is_everyones(here):
            break
        if any((here / mark).is_file() for mark in _PACKAGE_MARKS):
            root = here
        if not here.name.isidentifier() or any((here / mark).exists() for mark in _TOP_MARKS):
            break
    return root


def _is_everyones(folder: Path) -> bool:
    """Whether a folder is a user's home, the system's, or one that anybody may put files in: no package of anybody."""
    if folder in {Path(os.path.realpath(Path.home())), Path(folder.anchor)}:
        return True
    try:
        return bool(folder.stat().st_mode & stat.S_ISVTX)
    except OSError:
        return False
