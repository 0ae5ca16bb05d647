"""The files of a run.

Its folder holds ``journal.jsonl``, ``plan.json``, ``checkpoints/STAGE.blend``, ``pictures/`` (what the roles saw, by
content), ``blender/`` (the worker's own), ``scene.blend`` (of the last closed stage, in the end the result), and in the
end ``video.mp4`` or ``still.png``, and ``report.html``.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.loop.errors import NoRun, RunError
from agents.loop.record.journal import PLAN_NAME
from simworlds.files import write_whole
from simworlds.llm.messages import Picture

if TYPE_CHECKING:
    from pathlib import Path

    from pydantic import BaseModel

SCENE = "scene.blend"


@dataclass(frozen=True, slots=True)
class RunFiles:
    """What is where in the folder ``root``."""

    root: Path

    @property
    def checkpoints(self) -> Path:
        """The folder of the stages' files, which tools can only read."""
        return self.root / "checkpoints"

    @property
    def of_blender(self) -> Path:
        """The folder that Blender writes to."""
        return self.root / "blender"

    @property
    def scene(self) -> Path:
        """The run's result so far."""
        return self.root / SCENE

    def checkpoint(self, name: str) -> Path:
        """The file of a stage."""
        return self.checkpoints / f"{name}.blend"

    def write_plan(self, plan: BaseModel) -> None:
        """Writes a plan as ``plan.json``. Raises RunError."""
        path = self.root / PLAN_NAME
        text = json.dumps(plan.model_dump(mode="json"), indent=2, ensure_ascii=False)
        try:
            write_whole(path, f"{text}\n", durable=False)
        except OSError as error:
            raise _unwritable(path, error) from error

    def keep(self, picture: Picture) -> str:
        """Saves a picture by its content; its path in the folder. Raises RunError."""
        name = f"pictures/{hashlib.sha256(picture.data).hexdigest()[:16]}.png"
        path = self.root / name
        try:
            if not path.exists():
                write_whole(path, picture.data, durable=False)
        except OSError as error:
            raise _unwritable(path, error) from error
        return name

    def picture(self, name: str, media_type: str = "image/png") -> Picture:
        """A picture that was kept. Raises NoRun."""
        try:
            return Picture((self.root / name).read_bytes(), media_type)
        except OSError as error:
            raise NoRun(
                f"{error.filename}, a picture of an earlier answer, cannot be read: {error.strerror}."
            ) from error


def _unwritable(path: Path, error: OSError) -> RunError:
    return RunError(f"{path} cannot be written: {error.strerror or error}.")
