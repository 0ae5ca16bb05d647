"""Which files a project keeps out of git: what its ``.gitignore`` files name."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from pathspec import GitIgnoreSpec

_FILE = ".gitignore"
_MOST_CHARACTERS = 1 << 20
# A pattern with more of them may take minutes to compare with one long name.
_MOST_STARS = 3  # in a name
_MOST_DEEP = 4  # ``**``


class GitIgnore:
    """The ``.gitignore`` files that hold for a folder: its own, those below, and those above in its repository.

    Where git would leave out the folder itself, it was named all the same: then only those from it on count.
    """

    def __init__(self, folder: Path) -> None:
        self._specs: dict[Path, GitIgnoreSpec | None] = {}
        self._top = folder = folder.absolute()
        top = next((here for here in (folder, *folder.parents) if (here / ".git").exists()), folder)
        steps = [here for here in (folder, *folder.parents) if here != top and here.is_relative_to(top)]
        self._top = top
        if any(self.leaves_out(here, is_folder=True) for here in steps):
            self._top = folder

    def leaves_out(self, path: Path, *, is_folder: bool) -> bool:
        """Whether a pattern has the path: the last one of the nearest file that has it decides."""
        path = path.absolute()
        for folder in path.parents:
            if folder not in self._specs:
                self._specs[folder] = _read(folder)
            if spec := self._specs[folder]:
                name = path.relative_to(folder).as_posix()
                verdict = spec.check_file(f"{name}/" if is_folder else name).include
                if verdict is not None:
                    return verdict
            if folder == self._top:
                break
        return False


def _read(folder: Path) -> GitIgnoreSpec | None:
    """What a folder's own file says; None where it has none.

    Lines that git would not take either are passed over, and those with more stars than can be compared quickly: what
    such a line leaves out is checked, and what it takes back in (``!``) is not.
    """
    try:
        with (folder / _FILE).open(encoding="utf-8", errors="replace") as file:
            lines = file.read(_MOST_CHARACTERS).splitlines()
    except OSError:
        return None
    from pathspec import GitIgnoreSpec  # noqa: PLC0415 - for projects that have such a file
    from pathspec.patterns.gitignore.spec import GitIgnoreSpecPattern  # noqa: PLC0415

    patterns: list[GitIgnoreSpecPattern] = []
    for line in lines:
        if _is_simple(line):
            try:
                patterns.append(GitIgnoreSpecPattern(line))
            except (ValueError, re.error):
                continue
    return GitIgnoreSpec(patterns) if patterns else None


def _is_simple(line: str) -> bool:
    steps = line.split("/")
    names = [step for step in steps if step != "**"]
    return len(steps) - len(names) <= _MOST_DEEP and all(name.count("*") <= _MOST_STARS for name in names)
