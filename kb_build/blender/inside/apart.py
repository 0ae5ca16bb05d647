# SPDX-License-Identifier: GPL-3.0-or-later
"""Does work in a process of its own, that Blender outlives."""

import json
import os
import signal
import tempfile
import traceback
from contextlib import suppress

from .wire import Writer

# Of the processor: on a busy machine the same work comes to its end.
WORK_SECONDS = 5
# Until work that waits for something is ended.
SECONDS = 60
# The same where it only matters whether it crashes.
MOMENT = 3
# What ends a process that crashes.
FAULTS = frozenset({signal.SIGSEGV, signal.SIGBUS, signal.SIGFPE, signal.SIGILL, signal.SIGABRT})


def can_work_apart():
    """Whether this system has what it needs."""
    return hasattr(os, "fork")


def forked(work):
    """Starts work in a copy of this process; returns its number. Its status is 0 if what the work gives is true."""
    process = os.fork()
    if not process:
        done = False
        with suppress(BaseException):
            done = work()
        os._exit(not done)
    return process


def status_of(work, seconds):
    """The status of a process of its own, a copy of this one, that does work and is ended after some time."""

    def limited():
        signal.setitimer(signal.ITIMER_PROF, min(seconds, WORK_SECONDS))
        signal.alarm(seconds)
        return work()

    return os.waitpid(forked(limited), 0)[1]


def apart(work):
    """Whether work in a process of its own comes to its end and gives something true."""
    return status_of(work, SECONDS) == 0


def is_crash(status):
    """Whether a process with this status has crashed. One that was ended after some time has not."""
    return os.WIFSIGNALED(status) and os.WTERMSIG(status) in FAULTS


def crashes(work):
    """Whether work crashes a process of its own."""
    return is_crash(status_of(work, MOMENT))


def sent_with_status(work, seconds=SECONDS):
    """(its status, what it sent) of a process of its own that does work, and is ended after some time.

    ``work`` is given what it sends rows with; what was sent before Blender ended is there.
    """
    with tempfile.TemporaryFile("w+", encoding="utf-8") as file:

        def send(row):
            file.write(json.dumps(row) + "\n")
            file.flush()

        def sending():
            work(send)
            return True

        status = status_of(sending, seconds)
        file.seek(0)
        return status, [json.loads(line) for line in file]


def sent_apart(work):
    """The same with whether it came to its end instead of its status."""
    status, rows = sent_with_status(work)
    return status == 0, rows


def ended_at(names, do):
    """Those of some names for which doing something ends the process that does it for all of them, one after another:
    each time the next process goes on behind that.
    """
    left = list(names)

    def work(send):
        for name in left:
            send(name)
            do(name)

    while left:
        is_whole, begun = sent_apart(work)
        if is_whole or not begun:
            return
        yield begun[-1]
        del left[: len(begun)]


class Beside:
    """Writes records in a process of its own, a copy of this one, while this one goes on.

    What they tell is of Blender as it was when this was made.
    """

    def __init__(self, step, find):
        """``find`` is given what it writes records with. ``step`` names it where it fails."""
        self.file = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")
        self.process = forked(lambda: self.work(step, find))

    def work(self, step, find):
        """What the other process does. Returns whether it came to its end."""
        write = Writer(self.file)
        try:
            find(write)
        except Exception:
            write("fault", step=step, traceback=traceback.format_exc())
        write.flush()
        return True

    def lines(self):
        """Waits for the records, and returns them, a line each. Raises RuntimeError where not all are there."""
        status = os.waitpid(self.process, 0)[1]
        with self.file:
            self.file.seek(0)
            lines = self.file.read().splitlines()
        if status:
            raise RuntimeError(f"Blender ended, with status {status}")
        return lines

    def into(self, write):
        """Waits for the records, and writes them. Raises RuntimeError where not all are there."""
        write.lines(self.lines())
