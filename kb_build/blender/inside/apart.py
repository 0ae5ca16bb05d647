# SPDX-License-Identifier: GPL-3.0-or-later
"""Does work in a process of its own, that Blender outlives."""

import os
import signal
from contextlib import suppress

# Of the processor: on a busy machine the same work comes to its end.
WORK_SECONDS = 5
# Until work that waits for something is ended.
SECONDS = 60


def can_work_apart():
    """Whether this system has what it needs."""
    return hasattr(os, "fork")


def apart(work):
    """Whether work in a process of its own, a copy of this one, comes to its end and gives something true."""
    process = os.fork()
    if not process:
        signal.setitimer(signal.ITIMER_PROF, WORK_SECONDS)
        signal.alarm(SECONDS)
        done = False
        with suppress(BaseException):
            done = work()
        os._exit(not done)
    return os.waitpid(process, 0)[1] == 0
