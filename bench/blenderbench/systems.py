"""The systems: the unedited start (a baseline), SimWorlds, and folders of renders."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.blenderbench.edit_system import EditOutput, prepare_start
from bench.blenderbench.errors import BadResults, NoTasks, TaskFailed, UnreadableRender
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import round_file
from bench.blenderbench.simworlds_edit import SimWorldsEdit
from bench.blenderbench.task_set import natural_key

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.blenderbench.edit_system import EditSystem, Tell
    from bench.blenderbench.results import TaskFolder
    from bench.blenderbench.simworlds_edit import Reference
    from bench.blenderbench.task_scenes import EditRenderSettings
    from bench.blenderbench.task_set import BenchTask

MOST_ROUNDS = 100
_FOLDER = "folder="


@dataclass(frozen=True, slots=True)
class UneditedStart:
    """Edits nothing: the score of the start scene."""

    rendering: EditRenderSettings
    kind: str = "start"
    name: str = "unedited"
    takes_over: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """Settings of the renders."""
        return {"samples": self.rendering.samples}

    def make(self, task: BenchTask, place: TaskFolder, tell: Tell) -> EditOutput:
        """Renders the start scene."""
        started, loss = prepare_start(task, place, self.rendering, tell)
        shutil.copyfile(place.start_picture, place.root / round_file(1))
        return EditOutput((round_file(1),), loss, started.rendered, notes=started.notes)


@dataclass(frozen=True, slots=True)
class RendersFolder:
    """Existing renders: FOLDER/level1/TASK/*.png, or as the peer keeps them, …/renders/ROUND/render1.png."""

    root: Path
    kind: str = "folder"
    takes_over: bool = True

    @property
    def name(self) -> str:
        """The folder's name, without characters that tables do not allow."""
        plain = re.sub(r"[^A-Za-z0-9._+ -]+", "-", self.root.name)
        return re.sub(r"^[^A-Za-z0-9]+", "", plain)[:40] or "folder"

    @property
    def settings(self) -> dict[str, Any]:
        """The folder."""
        return {"folder": str(self.root)}

    def make(self, task: BenchTask, place: TaskFolder, tell: Tell) -> EditOutput:
        """Copies the rounds, in natural order of their names. Raises TaskFailed."""
        tell("copying renders")
        folder = self.root / task.level / task.name
        found = list(_rounds(folder))
        if not found:
            raise TaskFailed(f"{folder} has no render: neither *.png nor renders/*/render1.png.")
        if len(found) > MOST_ROUNDS:
            raise TaskFailed(f"{folder} has {len(found)} renders; at most {MOST_ROUNDS} are taken.")
        for number, path in enumerate(found, 1):
            if not path.resolve().is_relative_to(self.root.resolve()):
                raise TaskFailed(f"{path} is a link out of {self.root}.")
            try:
                read_picture(path)
            except UnreadableRender as error:
                raise TaskFailed(str(error)) from error
            shutil.copyfile(path, place.root / round_file(number))
        return EditOutput(tuple(round_file(number) for number in range(1, len(found) + 1)), cost=None)


def _rounds(folder: Path) -> Iterator[Path]:
    """The renders of a task's rounds; if a folder has both kinds, those directly in it."""
    if not folder.is_dir():
        return
    paths = [path for path in folder.glob("*.png") if path.is_file()]
    paths = paths or [path for path in folder.glob("renders/*/render1.png") if path.is_file()]
    yield from sorted(paths, key=lambda path: natural_key(path.relative_to(folder).as_posix()))


def system_of(
    name: str,
    rendering: EditRenderSettings,
    reference: Reference,
    options: tuple[str, ...],
    limits: tuple[str, ...],
) -> EditSystem:
    """The system of that name: ``start``, ``simworlds`` or ``folder=PATH``. Raises NoTasks, BadResults."""
    if name == "start":
        return UneditedStart(rendering)
    if name == "simworlds":
        return SimWorldsEdit(rendering, reference, options, limits)
    if name.startswith(_FOLDER):
        root = Path(name.removeprefix(_FOLDER)).expanduser().resolve()
        if not root.is_dir():
            raise NoTasks(f"{root} is not a folder of renders.")
        return RendersFolder(root)
    raise BadResults(f"There is no system {name[:100]!r}: give start, simworlds or folder=DIR.")
