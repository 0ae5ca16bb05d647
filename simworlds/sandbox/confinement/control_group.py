"""A control group of its own for each worker: the kernel counts its memory of every kind and its processes.

Without one, memory is limited only as far as a process's own limits reach: private memory, but neither memory shared
between mappings nor what pipes and page tables take.
"""

from __future__ import annotations

import os
import re
import signal
import time
import weakref
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from collections.abc import Iterable

    from simworlds.sandbox.confinement.resource_limits import ResourceLimits

_NAME = "simworlds-{owner}-{number}"
_NAMES = re.compile(r"simworlds-(\d+)-\d+")
_MORE_THREADS = 64  # so that the check from outside, which explains itself, comes before the kernel's refusal
_TRIES, _BETWEEN_TRIES = 30, 0.01  # seconds
_numbers = count()
_busy: set[Path] = set()

Version = Literal[1, 2]


@dataclass(frozen=True, slots=True)
class GroupParents:
    """Where control groups can be made: a folder for each controller, or the same for both."""

    version: Version
    memory: Path
    pids: Path | None

    @property
    def folders(self) -> tuple[Path, ...]:
        """The folders, each once."""
        return tuple(dict.fromkeys(place for place in (self.memory, self.pids) if place is not None))


class ControlGroup:
    """The group of one worker at a time; without control groups on this machine, an object that does nothing."""

    def __init__(self, limits: ResourceLimits, parents: GroupParents | None) -> None:
        self._limits = limits
        self._parents = parents
        self._folders: tuple[Path, ...] = ()
        self._remove = weakref.finalize(self, _remove_groups, ())

    @property
    def folders(self) -> tuple[Path, ...]:
        """The group's folders, which a process enters by writing its number to ``cgroup.procs`` in each; () if none."""
        return self._folders

    def renew(self) -> None:
        """Makes a new group for the next worker, in place of the one before. What cannot be limited is left out."""
        self.close()
        if self._parents is None or not self._limits.memory:
            return
        _remove_leftovers(self._parents.folders)
        name = _NAME.format(owner=os.getpid(), number=next(_numbers))
        folders: list[Path] = []
        try:
            for parent in self._parents.folders:
                (parent / name).mkdir()
                folders.append(parent / name)
            self._limit(self._parents, name)
        except OSError:
            _remove_groups(folders)
            return
        self._folders = tuple(folders)
        self._remove = weakref.finalize(self, _remove_groups, self._folders)

    def _limit(self, parents: GroupParents, name: str) -> None:
        memory, limit = parents.memory / name, str(self._limits.memory)
        if parents.version == 2:
            (memory / "memory.max").write_text(limit)
            optional = {"memory.swap.max": "0", "memory.oom.group": "1"}
        else:
            (memory / "memory.limit_in_bytes").write_text(limit)
            optional = {"memory.memsw.limit_in_bytes": limit}
        for file, value in optional.items():
            with suppress(OSError):  # without swap, or on older kernels, they do not exist
                _write(memory / file, value)
        if parents.pids is not None and self._limits.threads:
            (parents.pids / name / "pids.max").write_text(str(self._limits.threads + _MORE_THREADS))

    @property
    def ran_out_of_memory(self) -> bool:
        """Whether the kernel has ended a process of this group because the group reached its limit."""
        for folder in self._folders:
            for file in ("memory.events", "memory.oom_control"):
                with suppress(OSError, ValueError):
                    rows = dict(line.split(maxsplit=1) for line in (folder / file).read_text().splitlines())
                    if int(rows.get("oom_kill", 0)):
                        return True
        return False

    def close(self) -> None:
        """Removes the group; one that still has a process stays, and is removed by a later SimWorlds."""
        self._remove()
        self._folders = ()


def _remove_groups(folders: Iterable[Path]) -> None:
    """Removes groups and ends what still runs in them; those that stay busy are tried again later."""
    for folder in folders:
        for _ in range(_TRIES):
            try:
                folder.rmdir()
            except FileNotFoundError:
                break
            except OSError:
                _end_processes(folder)
                time.sleep(_BETWEEN_TRIES)
            else:
                break
        else:
            _busy.add(folder)


def _end_processes(folder: Path) -> None:
    with suppress(OSError, ValueError):
        for number in map(int, (folder / "cgroup.procs").read_text().split()):
            if number not in {0, os.getpid()}:  # 0: not to be seen from here
                os.kill(number, signal.SIGKILL)


def _remove_leftovers(parents: Iterable[Path]) -> None:
    """Removes the groups of processes that are gone, and of earlier workers of this one that ended late."""
    for folder in list(_busy):
        _busy.discard(folder)
        _remove_groups([folder])
    for parent in parents:
        with suppress(OSError):
            for entry in list(os.scandir(parent)):
                match = _NAMES.fullmatch(entry.name)
                if match is not None and not Path(f"/proc/{match[1]}").exists():
                    _remove_groups([parent / entry.name])


def _write(file: Path, value: str) -> None:
    """Writes to a file that must exist."""
    number = os.open(file, os.O_WRONLY)
    try:
        os.write(number, value.encode())
    finally:
        os.close(number)


@cache
def group_parents() -> GroupParents | None:
    """Where this process may make control groups that limit memory; None where it may not."""
    try:
        return find_parents(Path("/proc/self/cgroup").read_text(), Path("/proc/self/mountinfo").read_text())
    except (OSError, LookupError, ValueError):
        return None


def find_parents(groups: str, mounts: str) -> GroupParents | None:
    """See group_parents. ``groups`` and ``mounts``: the texts of /proc/self/cgroup and /proc/self/mountinfo."""
    own = {name: path for _, names, path in _group_rows(groups) for name in names.split(",")}
    places: dict[str, tuple[str, Path]] = {}
    for root, place, kind, options in _mount_rows(mounts):
        if kind == "cgroup2":
            places[""] = (root, place)
        elif kind == "cgroup":
            places |= dict.fromkeys(options.split(","), (root, place))
    if "memory" in own:
        memory = _own_folder(own["memory"], places.get("memory"))
        pids = _own_folder(own.get("pids", ""), places.get("pids")) if "pids" in own else None
        if memory is None or not _may_use(memory):
            return None
        return GroupParents(1, memory, pids if pids is not None and _may_use(pids) else None)
    group = _own_folder(own.get("", ""), places.get(""))
    return None if group is None else _unified(group, places[""][1])


def _unified(group: Path, top: Path) -> GroupParents | None:
    """The nearest of ``group`` and those above it that hands its memory controller on and belongs to this user.

    A process may move only between groups below one that it may write to.
    """
    for folder in (group, *group.parents):
        if not folder.is_relative_to(top) or not _may_use(folder):
            return None
        passed = _passed_on(folder)
        if "memory" not in passed and folder == group:
            # Allowed where no process is in the group itself, and in the topmost group of a machine.
            with suppress(OSError):
                _write(folder / "cgroup.subtree_control", "+memory +pids")
            passed = _passed_on(folder)
        if "memory" in passed:
            return GroupParents(2, folder, folder if "pids" in passed else None)
    return None


def _passed_on(folder: Path) -> list[str]:
    try:
        return (folder / "cgroup.subtree_control").read_text().split()
    except OSError:
        return []


def _may_use(folder: Path) -> bool:
    return os.access(folder, os.W_OK) and os.access(folder / "cgroup.procs", os.W_OK)


def _own_folder(path: str, mounted: tuple[str, Path] | None) -> Path | None:
    """The folder of a group at ``path``, in a hierarchy of which (root) is mounted at (place)."""
    if mounted is None or not path:
        return None
    root, place = mounted
    if not Path(path).is_relative_to(root):
        return None
    folder = place / Path(path).relative_to(root)
    return folder if folder.is_dir() else None


def _group_rows(text: str) -> list[list[str]]:
    return [line.split(":", 2) for line in text.splitlines()]


def _mount_rows(text: str) -> Iterable[tuple[str, Path, str, str]]:
    """(root, mount point, file system, its options) of each mount."""
    for line in text.splitlines():
        before, _, after = line.partition(" - ")
        words, kind = before.split(" "), after.split(" ")  # an empty word counts: a mount may have no source
        yield words[3], Path(words[4]), kind[0], kind[2]
