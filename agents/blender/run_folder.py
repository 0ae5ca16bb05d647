"""The folder of a run: what Blender may write to, and what only the supervisor may."""

from __future__ import annotations

import os
import re
import secrets
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, BinaryIO

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.launch import PRIVATE
from simworlds.sandbox.untrusted_files import copy_file, open_beneath, take_beneath
from simworlds.sandbox.usage import remove

if TYPE_CHECKING:
    from collections.abc import Iterator

_NAME = re.compile(r"[\w .()+-]{1,100}")
SCENE_FILE = "scene.blend"  # in the workspace: the run's own file, as Blender has it open
_RESERVED = {"workspace": "Blender", "checkpoints": "checkpoints", PRIVATE: "Blender"}


@dataclass(frozen=True, slots=True)
class RunFolder:
    """``root`` holds ``workspace`` (for Blender, the base of relative paths), ``checkpoints`` and saved files.

    What executed code puts into the workspace is not trusted: links in it are never followed.
    """

    root: Path

    @classmethod
    def make(cls, root: Path) -> RunFolder:
        """Makes the folders that are missing."""
        folder = cls(root.absolute())
        for path in (folder.workspace, folder.checkpoints):
            path.mkdir(parents=True, exist_ok=True)
        return folder

    @property
    def workspace(self) -> Path:
        """The folder that Blender may write to."""
        return self.root / "workspace"

    @property
    def private(self) -> Path:
        """The folder of Blender's temporary files, while it runs."""
        return self.root / PRIVATE

    @property
    def checkpoints(self) -> Path:
        """The folder of checkpoints, which executed code cannot reach."""
        return self.root / "checkpoints"

    def place_for(self, name: str, suffix: str) -> Path:
        """The path of a file in the run's folder, by the name a caller gives. Raises Refusal if it leads elsewhere."""
        parts = list(PurePosixPath(name.replace("\\", "/")).parts)
        if (
            not parts
            or len(parts) > 8
            or not all(_NAME.fullmatch(part) and part.strip(". ") for part in parts)
        ):
            raise Refusal(
                f"{name[:120]!r} cannot be used as a file name: give a relative path such as "
                f"'tower{suffix}' or 'saves/tower{suffix}'."
            )
        if parts[0].lower() in _RESERVED:
            raise Refusal(
                f"{parts[0]}/ is reserved for {_RESERVED[parts[0].lower()]}; choose another folder."
            )
        path = self.root.joinpath(*parts)
        if path.suffix.lower() != suffix:
            path = path.with_name(path.name + suffix)
        if not path.parent.resolve().is_relative_to(self.root.resolve()):
            raise Refusal(f"{name[:120]!r} leads out of the run's folder; choose a path inside it.")
        return path

    def open_made(self, relative: str) -> BinaryIO:
        """Opens a regular file that Blender made, by its path in the workspace. Raises Refusal."""
        return open_beneath(self.workspace, relative)

    def take(self, relative: str, target: Path, *, durable: bool = True) -> None:
        """Moves a file that Blender made to ``target``, whole or not at all. Raises Refusal.

        It is copied, since executed code may still have it open. ``durable`` waits for the disk.
        """
        take_beneath(self.workspace, relative, target, durable=durable)

    def put(self, source: Path, name: str) -> Path:
        """Copies a file to the workspace as ``name``, replacing whatever is there. Raises Refusal."""
        target = self.workspace / name
        part = f".{name}.{secrets.token_hex(8)}.part"
        workspace = os.open(self.workspace, os.O_RDONLY | os.O_DIRECTORY)
        try:
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            with (
                source.open("rb") as read,
                os.fdopen(os.open(part, flags, 0o644, dir_fd=workspace), "wb") as copy,
            ):
                copy_file(read, copy)
            if target.is_dir() and not target.is_symlink():
                remove(target)
            os.replace(part, name, src_dir_fd=workspace, dst_dir_fd=workspace)
        except OSError as error:
            with suppress(OSError):
                os.unlink(part, dir_fd=workspace)
            raise Refusal(f"{target} cannot be written: {error.strerror or error}.") from error
        finally:
            os.close(workspace)
        return target


def roots(runs: Path) -> Iterator[Path]:
    """Paths below ``runs`` for a new run, named after the time; each may already exist."""
    stamp = datetime.now().astimezone().strftime("%Y-%m-%d-%H%M%S")
    return (runs / (stamp if number == 1 else f"{stamp}-{number}") for number in range(1, 1000))


def new_run(runs: Path) -> RunFolder:
    """A new folder below ``runs``, named after the time."""
    for root in roots(runs):
        try:
            root.mkdir(parents=True)
        except FileExistsError:
            continue
        return RunFolder.make(root)
    raise Refusal(f"No folder could be made in {runs}: 999 runs were started in one second.")
