"""The space that a process takes with files that have no name: deleted, but still open or mapped."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from typing import NamedTuple


class NamelessFiles(NamedTuple):
    """Bytes on disk of nameless files that are open, their number, and how many more are only mapped.

    The size of a file that is only mapped cannot be known from outside without being root.
    """

    bytes: int
    open: int
    mapped: int


def nameless_files(process: int, devices: frozenset[int], *, mapped: bool = True) -> NamelessFiles:
    """Those of a process on these file systems (numbers as in st_dev). What cannot be looked at counts as none.

    Without ``mapped``, only open files are looked for, which takes a tenth of the time.
    """
    open_bytes: dict[tuple[int, int], int] = {}
    with suppress(OSError), os.scandir(f"/proc/{process}/fd") as entries:
        for entry in entries:
            with suppress(OSError):
                status = entry.stat()  # of the file itself, whatever the link's text says
                if _takes_space(status, devices):
                    open_bytes[status.st_dev, status.st_ino] = status.st_blocks * 512
    others = _mapped(process, devices) - open_bytes.keys() if mapped else ()
    return NamelessFiles(sum(open_bytes.values()), len(open_bytes), len(others))


def _takes_space(status: os.stat_result, devices: frozenset[int]) -> bool:
    return status.st_nlink == 0 and stat.S_ISREG(status.st_mode) and status.st_dev in devices


def _mapped(process: int, devices: frozenset[int]) -> set[tuple[int, int]]:
    """(device, inode) of files without a name in the process's memory."""
    found: set[tuple[int, int]] = set()
    with suppress(OSError, ValueError), open(f"/proc/{process}/maps", "rb") as rows:  # noqa: PTH123
        for row in rows:
            if not row.endswith(b" (deleted)\n"):
                continue
            major, _, minor = row.split()[3].partition(b":")
            device = os.makedev(int(major, 16), int(minor, 16))
            if device in devices:
                found.add((device, int(row.split()[4])))
    return found
