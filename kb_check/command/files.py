"""Finds the files to check, and those that they belong together with: what one file registers, the others may use."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING

from kb_check.command.gitignore import GitIgnore
from kb_check.registered.package_roots import package_root, packages_used
from kb_check.text.source import NOTEBOOK
from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

SUFFIXES = (".py", ".pyw", NOTEBOOK)
_PASSED_OVER = frozenset(("__pycache__", "node_modules", "site-packages"))
_MOST_FILES = 50_000


@dataclass(frozen=True, slots=True)
class CodeFile:
    """A file by its path as it is shown. Of one that is not ``wanted`` only what it registers counts."""

    path: Path
    wanted: bool = True


@dataclass(frozen=True, slots=True)
class FileGroup:
    """Files of one package, or one file that belongs to none, with the packages of its project that it uses, and
    whatever else uses these.
    """

    files: tuple[CodeFile, ...]


@dataclass(slots=True)
class FoundFiles:
    """The groups of files below some paths, a sentence for each path that has nothing to check, and the paths of
    which the patterns leave nothing.
    """

    groups: list[FileGroup] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    excluded: list[Path] = field(default_factory=list)


def find_files(
    paths: Iterable[Path],
    exclude: Sequence[str] = (),
    top: Path | None = None,
    *,
    gitignore: bool = True,
    unsaved: Collection[Path] = (),
) -> FoundFiles:
    """The Python files and notebooks at and below ``paths``, by package.

    ``exclude`` are patterns of names or of paths below ``top``. ``gitignore``: what git leaves out is left out. Links
    are followed where they are named, not where they are found; so are hidden files, environments and what git leaves
    out. Pipes that are named are files of no package. ``unsaved`` are paths whose content is given: they need not be
    there. Raises UserError for far too many files.
    """
    excluded = _Excluded(exclude, (top or Path()).absolute())
    found = FoundFiles()
    wanted: dict[Path, Path] = {}  # as it is → as it is shown
    for path in paths:
        ignored = GitIgnore(path) if gitignore and path.is_dir() else None
        below: list[Path] = []
        if not path.exists() and path not in unsaved:
            found.faults.append(f"There is no file or folder {path}.")
        elif excluded.has(path):
            found.excluded.append(path)
        elif path in unsaved or path.is_file():
            below = [path]
        elif path.is_dir():
            below = list(_below(path, excluded, ignored))
            if not below:
                _tell_why_none(path, excluded, ignored, found)
        else:  # a pipe can be read only once, so that nobody may look into it for what it uses
            found.groups.append(FileGroup((CodeFile(path),)))
        for file in below:
            wanted.setdefault(Path(os.path.realpath(file)), file)
            if len(wanted) > _MOST_FILES:
                raise UserError(
                    f"There are more than {_MOST_FILES:,} Python files. Check a part of them at a time."
                )
    found.groups += _grouped(wanted, excluded)
    return found


def _tell_why_none(folder: Path, excluded: _Excluded, ignored: GitIgnore | None, found: FoundFiles) -> None:
    """Tells what leaves no Python file of a folder to check."""
    if any(_below(folder, _Excluded((), folder), ignored)):
        found.excluded.append(folder)
    elif any(_below(folder, excluded)):
        found.faults.append(
            f"Git leaves out all Python files in {folder}. Those that are named are checked all the same."
        )
    else:
        found.faults.append(f"There are no Python files in {folder}.")


def _grouped(wanted: dict[Path, Path], excluded: _Excluded) -> Iterator[FileGroup]:
    # A package's folder, or a file of none → the files of it that are wanted.
    parts: dict[Path, list[Path]] = {}
    for real in wanted:
        root = None if real.suffix == NOTEBOOK else package_root(real.parent)
        parts.setdefault(root or real, []).append(real)
    for together in _joined(parts):
        files = [real for part in together for real in parts.get(part, ())]
        others = [
            path
            for part in together
            if part.is_dir()
            for path in _below(part, excluded)
            if path.suffix != NOTEBOOK and Path(os.path.realpath(path)) not in wanted
        ]
        yield FileGroup(
            (
                *(CodeFile(wanted[real]) for real in files),
                *(CodeFile(path, wanted=False) for path in others[:_MOST_FILES]),
            )
        )


def _joined(parts: Mapping[Path, Iterable[Path]]) -> Iterable[list[Path]]:
    """The parts that belong together: each with the packages that it uses. All are of one project, as long as their
    names are.
    """
    groups = {part: [part] for part in parts}
    times = Counter(part.name for part in parts)
    named = {part.name: part for part in parts if part.is_dir() and times[part.name] == 1}
    for part, files in parts.items():
        for package in sorted(packages_used(files, part.parent, named)):
            own, other = groups[part], groups.setdefault(package, [package])
            if own is not other:
                own += other
                groups |= dict.fromkeys(other, own)
    return {id(group): group for group in groups.values()}.values()


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
