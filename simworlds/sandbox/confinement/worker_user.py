"""The user that executed code belongs to where SimWorlds runs as root, and what that user may reach.

Much of /proc/sys obeys root even without any capability, so the worker must not be root towards the kernel.
"""

from __future__ import annotations

import os
import stat
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import CannotStart
from simworlds.sandbox.hostile_ground import HostileGround

if TYPE_CHECKING:
    from collections.abc import Iterable

WORKER_ID = 65530
"""User and group in a range that neither distributions nor systemd hand out."""

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_IN_ITS_STEAD = "or run SimWorlds as a user other than root."


@cache
def worker_id() -> int | None:
    """The user that the worker becomes; None where this process is not root towards the kernel."""
    if sys.platform != "linux" or os.geteuid() != 0:
        return None
    try:
        rows = [
            [int(word) for word in line.split()]
            for line in Path("/proc/self/uid_map").read_text().splitlines()
        ]
    except (OSError, ValueError):
        return WORKER_ID
    is_root = any(inside == outside == 0 for inside, outside, _ in rows)
    return WORKER_ID if is_root else None


def hand_over(folder: Path, user: int) -> None:
    """Gives ``folder`` and all below it to ``user`` and its group: folders and files with one name, no links.

    Raises CannotStart if the folder itself cannot be given.
    """
    try:
        number = os.open(folder, _FOLDER)
    except OSError as error:
        raise CannotStart(f"{folder} cannot be opened: {error.strerror}.") from error
    try:
        _give(number, user)
    except OSError as error:
        raise CannotStart(f"{folder} cannot be given to user {user}: {error.strerror}.") from error
    finally:
        os.close(number)
    for entry in HostileGround(folder).walk():
        if entry.status.st_uid == user or not _is_plain(entry.status):
            continue
        with suppress(OSError):
            # The entry may have been replaced since: what is given is what is open, looked at again.
            inner = os.open(
                entry.name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, dir_fd=entry.parent
            )
            try:
                _give(inner, user)
            finally:
                os.close(inner)


def _give(number: int, user: int) -> None:
    status = os.fstat(number)
    if _is_plain(status) and status.st_uid != user:
        os.fchown(number, user, user)


def _is_plain(status: os.stat_result) -> bool:
    """Whether it is a folder, or a file that has no other name elsewhere."""
    return stat.S_ISDIR(status.st_mode) or (stat.S_ISREG(status.st_mode) and status.st_nlink == 1)


def check_readable(paths: Iterable[str], user: int, *, with_parents: bool) -> None:
    """Checks that ``user`` can read what lies at these paths, and enter the folders above them if ``with_parents``.

    What does not exist is not checked. Raises CannotStart, which says what to do.
    """
    for path in paths:
        place = Path(path)
        with suppress(FileNotFoundError, NotADirectoryError):
            if not _others_may(place, user, os.R_OK):
                raise CannotStart(
                    f"As root, Blender runs as user {user}, which cannot read {path}. Let others read it "
                    f"(chmod -R o+rX), {_IN_ITS_STEAD}"
                )
            closed = (above for above in place.resolve().parents if not _others_may(above, user, os.X_OK))
            if with_parents and (above := next(closed, None)) is not None:
                raise CannotStart(
                    f"As root, Blender runs as user {user}, which cannot reach {path}, because others may not "
                    f"enter {above}. Install bubblewrap (apt-get install bubblewrap), use folders elsewhere, "
                    f"{_IN_ITS_STEAD}"
                )


def _others_may(place: Path, user: int, right: int) -> bool:
    status = place.stat()
    if stat.S_ISDIR(status.st_mode):
        right |= os.X_OK
    shift = 6 if status.st_uid == user else 3 if status.st_gid == user else 0
    return status.st_mode >> shift & right == right
