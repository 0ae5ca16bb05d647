"""Files that Blender may read: those of the run's folder, and of the folders that the user has allowed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from agents.blender.files.run_folder import RunFolder


@dataclass(frozen=True, slots=True)
class ReadableFile:
    """A file that may be opened: ``relative`` below ``root``, one of the folders that files may come from."""

    root: Path
    relative: str

    @property
    def path(self) -> Path:
        """The whole path."""
        return self.root / self.relative


def find_readable(name: str, folder: RunFolder, read: tuple[Path, ...]) -> ReadableFile:
    """The place of that name, relative to the run's folder or absolute, whether or not a file is there.

    Raises Refusal if it may not be read.
    """
    if "\0" in name or len(name) > 4096:
        raise Refusal(f"{name[:120]!r} is not a valid path.")
    path = folder.root / name
    if ".." in Path(name).parts:
        raise Refusal(f"{name[:120]!r} is not allowed: give a path without '..'.")
    for root in (folder.root, *read):
        for base in {root, root.resolve()}:
            if path.is_relative_to(base) and path != base:
                return ReadableFile(root, path.relative_to(base).as_posix())
    allowed = ", ".join(str(root) for root in (folder.root, *read))
    raise Refusal(f"{name[:300]} may not be opened. Files can be opened from {allowed}.")
