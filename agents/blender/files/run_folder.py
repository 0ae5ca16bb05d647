"""The folder of a run: what Blender may write to, and what only the supervisor may."""

from __future__ import annotations

import re
import tempfile
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.launch import LENT, PRIVATE

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

_NAME = re.compile(r"[\w .()+-]{1,100}")
SCENE_FILE = "scene.blend"  # in the workspace: the run's own file, as Blender has it open
_RESERVED = {"workspace": "Blender", "checkpoints": "checkpoints", PRIVATE: "Blender", LENT: "Blender"}


@dataclass(frozen=True, slots=True)
class RunFolder:
    """``root`` holds ``workspace`` (for Blender, the base of relative paths), ``checkpoints`` and saved files."""

    root: Path

    @classmethod
    def make(cls, root: Path) -> RunFolder:
        """Makes the folders that are missing."""
        folder = cls(root.absolute())
        folder.workspace.make()
        folder.checkpoints.mkdir(parents=True, exist_ok=True)
        return folder

    @staticmethod
    def is_foreign(root: Path) -> bool:
        """Whether the folder has files of somebody else in it, and no run."""
        return root.is_dir() and any(root.iterdir()) and not (root / "checkpoints").is_dir()

    @property
    def workspace(self) -> HostileGround:
        """The folder that Blender may write to."""
        return HostileGround(self.root / "workspace")

    @property
    def private(self) -> HostileGround:
        """The folder of Blender's temporary files, while it runs."""
        return HostileGround(self.root / PRIVATE)

    @contextmanager
    def lending(self) -> Generator[Path]:
        """An empty folder for files that Blender is to load and cannot change, gone afterwards. Raises OSError."""
        with tempfile.TemporaryDirectory(dir=self.root / LENT, ignore_cleanup_errors=True) as lent:
            Path(lent).chmod(0o755)  # as root, Blender runs as another user
            yield Path(lent)

    @property
    def saved(self) -> Iterator[Path]:
        """The .blend files that were saved in this run."""
        for path in self.root.iterdir():
            if path.name.lower() in _RESERVED or path.name.startswith(".") or path.is_symlink():
                continue
            found = path.rglob("*.blend") if path.is_dir() else [path]
            yield from (file for file in found if file.suffix == ".blend" and file.is_file())

    @property
    def checkpoints(self) -> Path:
        """The folder of checkpoints, which executed code cannot reach."""
        return self.root / "checkpoints"

    def owner_of(self, relative: str) -> str:
        """Whom the folder that a relative path begins with is reserved for; "" if for nobody."""
        return _RESERVED.get(PurePosixPath(relative).parts[0].lower(), "")

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


def new_root(runs: Path) -> Path:
    """Makes a folder below ``runs`` for a new run, named after the time. Raises Refusal, OSError."""
    stamp = datetime.now().astimezone().strftime("%Y-%m-%d-%H%M%S")
    for number in range(1, 1000):
        root = runs / (stamp if number == 1 else f"{stamp}-{number}")
        try:
            root.mkdir(parents=True)
        except FileExistsError:
            continue
        return root
    raise Refusal(f"No folder could be made in {runs}: 999 runs were started in one second.")


def new_run(runs: Path) -> RunFolder:
    """A new folder below ``runs``, named after the time. Raises Refusal, OSError."""
    return RunFolder.make(new_root(runs))
