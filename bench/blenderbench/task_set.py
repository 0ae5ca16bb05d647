"""BlenderBench's layout on disk: which tasks there are, and what is wrong with those that cannot be used.

    SET/level1/TASK/blender_file.blend         the raw scene; its camera may be the goal's: start.py comes first
    SET/level1/TASK/start.py                   code that makes the scene to be edited of it
    SET/level1/TASK/task.txt                   the instruction
    SET/level1/TASK/renders/goal/render1.png   what is asked for; visprompt1.png beside it, in some tasks
    SET/level1/TASK/renders/start/render1.png  the scene to be edited (may be missing)

``goal.py``, the authors' own edit, may lie there; it is never read. Nothing is executed here, and nothing leads out
of the set: a task one of whose files is a link to elsewhere is left out, and named.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.audit.untrusted_blend import NotScored, resolve_blend
from bench.blenderbench.errors import BadPicture, NoTasks
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
    """Why a task cannot be used."""


@dataclass(frozen=True, slots=True)
class Task:
    """A task whose files are there. ``size``: the goal's, in pixels. ``start``, ``visprompt``: None where missing."""

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
    """What a folder holds: tasks in order, and in words what cannot be used, each with its path."""

    root: Path
    tasks: tuple[Task, ...]
    faults: tuple[str, ...]


def read_set(root: Path) -> TaskSet:
    """The tasks in a folder. Raises NoTasks where there is none, with all that is wrong."""
    root = root.expanduser().resolve()
    if not root.is_dir():
        raise NoTasks(f"{root} is no folder. Give the folder that holds level1, level2 and level3.")
    levels = [root / level for level in LEVELS if (root / level).is_dir()]
    if not levels:
        raise NoTasks(f"{root} is no BlenderBench: it has none of {', '.join(LEVELS)}.")
    tasks: list[Task] = []
    faults: list[str] = []
    for folder in (folder for level in levels for folder in _folders(level)):
        try:
            tasks.append(_task(root, folder))
        except _Fault as fault:
            faults.append(str(fault))
    if not tasks:
        raise NoTasks("\n".join([f"{root} has no task that can be used.", *faults]))
    return TaskSet(root, tuple(tasks), tuple(faults))


def chosen(found: TaskSet, names: Sequence[str]) -> tuple[Task, ...]:
    """The tasks that are named, by level (``level2``) or id (``level1/attic``); all, if none is. Raises NoTasks."""
    if not names:
        return found.tasks
    known = {name for task in found.tasks for name in (task.level, task.id)}
    if unknown := [name for name in names if name not in known]:
        raise NoTasks(
            f"{found.root} has no {', '.join(unknown)} that can be used. Tasks: "
            f"{', '.join(task.id for task in found.tasks)}."
        )
    return tuple(task for task in found.tasks if {task.level, task.id} & set(names))


def in_order(name: str) -> list[tuple[int, str]]:
    """To sort names by, as people count: ``room9`` before ``room10``."""
    parts = re.split(r"(\d+)", name)  # every second one is a number
    return [(int(part), "") if place % 2 else (-1, part) for place, part in enumerate(parts)]


def _folders(level: Path) -> Iterator[Path]:
    """What may be tasks: folders that are not hidden."""
    found = (path for path in level.iterdir() if path.is_dir() and not path.name.startswith("."))
    yield from sorted(found, key=lambda path: in_order(path.name))


def _task(root: Path, folder: Path) -> Task:
    if not _NAME.fullmatch(folder.name):
        raise _Fault(f"{str(folder)!r} cannot be a task's name: use letters, digits, spaces and .()+-")
    goal = _within(root, folder / "renders" / "goal" / "render1.png")
    blend = _within(root, folder / "blender_file.blend")
    try:
        resolve_blend(blend)
        size = size_of(goal)
    except NotScored as error:
        raise _Fault(f"{blend}: {error}") from error
    except BadPicture as error:
        raise _Fault(str(error)) from error
    if min(size) < _SHORTEST_SIDE:
        raise _Fault(f"{goal} is {size[0]} × {size[1]}; a goal has at least {_SHORTEST_SIDE} pixels a side.")
    return Task(
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
    """The path, if a plain file of the set lies there."""
    if not path.exists():
        broken = path.is_symlink()
        raise _Fault(f"{path} {'is a link to nothing' if broken else 'is missing'}.")
    if not path.resolve().is_relative_to(root):
        raise _Fault(
            f"{path} is a link out of the set, to {path.resolve()}. Copy the files into place (a download into a "
            "folder of its own has no links)."
        )
    if not path.is_file():
        raise _Fault(f"{path} is no plain file.")
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
        raise _Fault(f"{path} is no UTF-8 text: {error}.") from error
    except OSError as error:
        raise _Fault(f"{path} cannot be read: {error.strerror or error}.") from error


def _instruction(path: Path) -> str:
    found = _text(path, _LONGEST_INSTRUCTION).replace("\r\n", "\n").strip()
    if not found:
        raise _Fault(f"{path} is empty: there is nothing to ask for.")
    if _UNPRINTED.search(found):
        raise _Fault(f"{path} holds characters that no text has.")
    return found
