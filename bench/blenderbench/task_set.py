"""Reads BlenderBench's layout on disk: the usable tasks, and the faults of the others.

    SET/level1/TASK/blender_file.blend         the raw scene; its camera may be the goal's until start.py has run
    SET/level1/TASK/start.py                   code that makes the start scene from it
    SET/level1/TASK/task.txt                   the instruction
    SET/level1/TASK/renders/goal/render1.png   the goal; in some tasks with visprompt1.png beside it
    SET/level1/TASK/renders/start/render1.png  the start scene (may be missing)

``goal.py``, the authors' own edit, is never read. Nothing is executed here, and links out of the set are not followed:
such a task is left out and reported.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.audit.untrusted_blend import NotScored, resolve_blend
from bench.blenderbench.errors import NoTasks, UnreadableRender
from bench.blenderbench.pictures import size_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

LEVELS = ("level1", "level2", "level3")
_NAME = re.compile(r"\w[\w .()+-]{0,99}")
_UNPRINTED = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
_LONGEST_INSTRUCTION = 20_000  # bytes
_LONGEST_CODE = 1 << 20
_SHORTEST_SIDE = 16  # pixels of a goal


class _Fault(Exception):  # noqa: N818 - reads as what it is
    """The reason why a task cannot be used."""


@dataclass(frozen=True, slots=True)
class BenchTask:
    """A usable task. ``size``: the goal's, in pixels. ``start``, ``visprompt``: None where missing."""

    level: str
    name: str
    folder: Path
    blend: Path
    code: str
    instruction: str
    goal: Path
    size: tuple[int, int]
    start: Path | None = None
    visprompt: Path | None = None

    @property
    def id(self) -> str:
        """``level1/attic``."""
        return f"{self.level}/{self.name}"


@dataclass(frozen=True, slots=True)
class TaskSet:
    """The tasks of a folder in order, and in words the faults of others, each with its path."""

    root: Path
    tasks: tuple[BenchTask, ...]
    faults: tuple[str, ...]


def read_set(root: Path) -> TaskSet:
    """Reads the tasks in a folder. Raises NoTasks, with all faults, where there is none."""
    root = root.expanduser().resolve()
    if not root.is_dir():
        raise NoTasks(f"{root} is not a folder. Give the folder that holds level1, level2 and level3.")
    levels = [root / level for level in LEVELS if (root / level).is_dir()]
    if not levels:
        raise NoTasks(f"{root} is not a BlenderBench: it has none of {', '.join(LEVELS)}.")
    tasks: list[BenchTask] = []
    faults: list[str] = []
    for folder in (folder for level in levels for folder in _folders(level)):
        try:
            tasks.append(_task(root, folder))
        except _Fault as fault:
            faults.append(str(fault))
    if not tasks:
        raise NoTasks("\n".join([f"{root} has no usable task.", *faults]))
    return TaskSet(root, tuple(tasks), tuple(faults))


def select_tasks(task_set: TaskSet, names: Sequence[str]) -> tuple[BenchTask, ...]:
    """The tasks with these levels (``level2``) or ids (``level1/attic``); all without names. Raises NoTasks."""
    if not names:
        return task_set.tasks
    known = {name for task in task_set.tasks for name in (task.level, task.id)}
    if unknown := [name for name in names if name not in known]:
        raise NoTasks(
            f"{task_set.root} has no usable {', '.join(unknown)}. Tasks: "
            f"{', '.join(task.id for task in task_set.tasks)}."
        )
    return tuple(task for task in task_set.tasks if {task.level, task.id} & set(names))


def natural_key(name: str) -> list[tuple[int, str]]:
    """A key for natural sorting: ``room9`` before ``room10``."""
    parts = re.split(r"(\d+)", name)  # every second one is a number
    return [(int(part), "") if place % 2 else (-1, part) for place, part in enumerate(parts)]


def _folders(level: Path) -> Iterator[Path]:
    """The folders of a level that are not hidden, in natural order."""
    folders = (path for path in level.iterdir() if path.is_dir() and not path.name.startswith("."))
    yield from sorted(folders, key=lambda path: natural_key(path.name))


def _task(root: Path, folder: Path) -> BenchTask:
    if not _NAME.fullmatch(folder.name):
        raise _Fault(f"{str(folder)!r} cannot be a task's name: use letters, digits, spaces and .()+-")
    goal = _within(root, folder / "renders" / "goal" / "render1.png")
    blend = _within(root, folder / "blender_file.blend")
    try:
        resolve_blend(blend)
        size = size_of(goal)
    except NotScored as error:
        raise _Fault(f"{blend}: {error}") from error
    except UnreadableRender as error:
        raise _Fault(str(error)) from error
    if min(size) < _SHORTEST_SIDE:
        raise _Fault(f"{goal} is {size[0]} × {size[1]}; a goal has at least {_SHORTEST_SIDE} pixels a side.")
    return BenchTask(
        folder.parent.name,
        folder.name,
        folder,
        blend,
        _text(_within(root, folder / "start.py"), _LONGEST_CODE),
        _instruction(_within(root, folder / "task.txt")),
        goal,
        size,
        _optional(root, folder / "renders" / "start" / "render1.png"),
        _optional(root, folder / "renders" / "goal" / "visprompt1.png"),
    )


def _within(root: Path, path: Path) -> Path:
    """The path, if it is a plain file of the set. Raises _Fault."""
    if not path.exists():
        broken = path.is_symlink()
        raise _Fault(f"{path} {'is a link to nothing' if broken else 'is missing'}.")
    if not path.resolve().is_relative_to(root):
        raise _Fault(
            f"{path} is a link out of the set, to {path.resolve()}. Copy the files into place (a download into a "
            "folder of its own has no links)."
        )
    if not path.is_file():
        raise _Fault(f"{path} is not a plain file.")
    return path


def _optional(root: Path, path: Path) -> Path | None:
    return _within(root, path) if path.exists() or path.is_symlink() else None


def _text(path: Path, longest: int) -> str:
    try:
        with path.open("rb") as file:
            data = file.read(longest + 1)
        if len(data) > longest:
            raise _Fault(f"{path} has more than {longest:,} bytes.")
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _Fault(f"{path} is not UTF-8 text: {error}.") from error
    except OSError as error:
        raise _Fault(f"{path} cannot be read: {error.strerror or error}.") from error


def _instruction(path: Path) -> str:
    text = _text(path, _LONGEST_INSTRUCTION).replace("\r\n", "\n").strip()
    if not text:
        raise _Fault(f"{path} is empty; it must hold the instruction.")
    if _UNPRINTED.search(text):
        raise _Fault(f"{path} contains control characters.")
    return text
