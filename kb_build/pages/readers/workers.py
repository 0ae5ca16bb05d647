"""The number of processes for reading pages."""

from __future__ import annotations

import os
import threading

_FEW = 40  # pages that one process reads before a second one has started


def processes(jobs: int, pages: int) -> int:
    """``jobs``, or one where a second process is not worth its start or cannot be forked safely."""
    # A child forked while other threads hold locks may hang.
    alone = os.name == "posix" and threading.active_count() == 1
    return max(1, jobs) if alone and pages > _FEW else 1
