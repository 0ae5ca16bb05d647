# SPDX-License-Identifier: GPL-3.0-or-later
"""Leaves the Python of the user's Blender, which add-ons share, as it was before code ran in it."""

import signal
import sys

from ...kept_names import KeptNames
from ...kept_settings import KeptSettings

_PACKAGE = __package__.partition(".worker.")[0]
_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGALRM", "SIGCHLD") if hasattr(signal, name)
)


class UserPython:
    """Remembers it as it is when it is made. What code has imported stays; what it has set or removed does not."""

    def __init__(self):
        self._names = KeptNames((_PACKAGE,))
        self._names.protect_packages()
        self._settings = KeptSettings()
        self._streams = sys.stdin, sys.stdout, sys.stderr
        self._signals = {number: signal.getsignal(number) for number in _SIGNALS}

    def restore(self):
        """Puts back what the code has changed."""
        self._settings.stop_alarms_and_tracers()
        for number, handler in self._signals.items():
            if signal.getsignal(number) is not handler:
                # None: it was set by Blender itself, in C, where Python cannot put it back.
                signal.signal(number, handler or signal.SIG_DFL)
        sys.stdin, sys.stdout, sys.stderr = self._streams
        self._names.restore()
        self._settings.restore()
