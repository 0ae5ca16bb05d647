"""Whom tasks are given to: nobody (the baseline), SimWorlds, or whoever made a folder of renders."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.blenderbench.editing import SimWorlds
from bench.blenderbench.errors import BadPicture, BadResults, NoTasks, NotDone
from bench.blenderbench.making import Made, begun
from bench.blenderbench.pictures import read_picture
from bench.blenderbench.results import round_file
from bench.blenderbench.task_set import in_order

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.blenderbench.editing import Reference
    from bench.blenderbench.making import System, Tell
    from bench.blenderbench.results import Place
    from bench.blenderbench.task_scenes import RenderSettings
    from bench.blenderbench.task_set import Task

MOST_ROUNDS = 100
_FOLDER = "folder="


@dataclass(frozen=True, slots=True)
class Unedited:
    """Nobody edits anything: what the scene to be edited scores by itself."""

    rendering: RenderSettings
    kind: str = "start"
    name: str = "unedited"
    takes_over: bool = False

    @property
    def settings(self) -> dict[str, Any]:
        """Of the renders."""
        return {"samples": self.rendering.samples}

    def make(self, task: Task, place: Place, tell: Tell) -> Made:
        """The render of the scene to be edited."""
        started, loss = begun(task, place, self.rendering, tell)
        shutil.copyfile(place.start_picture, place.root / round_file(1))
        return Made((round_file(1),), loss, started.rendered, notes=started.notes)


@dataclass(frozen=True, slots=True)
class Folder:
    """Renders that anybody made: FOLDER/level1/TASK/*.png, or as the peer keeps them, …/renders/ROUND/render1.png."""

    root: Path
    kind: str = "folder"
    takes_over: bool = True

    @property
    def name(self) -> str:
        """The folder's own, as far as a table can have it."""
        plain = re.sub(r"[^A-Za-z0-9._+ -]+", "-", self.root.name)
        return re.sub(r"^[^A-Za-z0-9]+", "", plain)[:40] or "folder"

    @property
    def settings(self) -> dict[str, Any]:
        """Where they are."""
        return {"folder": str(self.root)}

    def make(self, task: Task, place: Place, tell: Tell) -> Made:
        """Copies of the rounds, in the order of their names, as people count."""
        tell("taking renders over")
        folder = self.root / task.level / task.name
        found = list(_rounds(folder))
        if not found:
            raise NotDone(f"{folder} has no render: neither *.png nor renders/*/render1.png.")
        if len(found) > MOST_ROUNDS:
            raise NotDone(f"{folder} has {len(found)} renders; at most {MOST_ROUNDS} are taken.")
        for number, path in enumerate(found, 1):
            if not path.resolve().is_relative_to(self.root.resolve()):
                raise NotDone(f"{path} is a link out of {self.root}.")
            try:
                read_picture(path)
            except BadPicture as error:
                raise NotDone(str(error)) from error
            shutil.copyfile(path, place.root / round_file(number))
        return Made(tuple(round_file(number) for number in range(1, len(found) + 1)), cost=None)


def _rounds(folder: Path) -> Iterator[Path]:
    """The renders of a task's rounds; a folder that has both kinds gives those that lie in it directly."""
    if not folder.is_dir():
        return
    found = [path for path in folder.glob("*.png") if path.is_file()]
    found = found or [path for path in folder.glob("renders/*/render1.png") if path.is_file()]
    yield from sorted(found, key=lambda path: in_order(path.relative_to(folder).as_posix()))


def system_of(
    asked: str,
    rendering: RenderSettings,
    reference: Reference,
    options: tuple[str, ...],
    limits: tuple[str, ...],
) -> System:
    """The system of that name: ``start``, ``simworlds`` or ``folder=PATH``. Raises NoTasks, BadResults."""
    if asked == "start":
        return Unedited(rendering)
    if asked == "simworlds":
        return SimWorlds(rendering, reference, options, limits)
    if asked.startswith(_FOLDER):
        root = Path(asked.removeprefix(_FOLDER)).expanduser().resolve()
        if not root.is_dir():
            raise NoTasks(f"{root} is no folder of renders.")
        return Folder(root)
    raise BadResults(f"There is no system {asked[:100]!r}: give start, simworlds or folder=DIR.")
