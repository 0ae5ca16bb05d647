# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts back what code has set in the interpreter and its process: where modules are found, hooks, the environment."""

import faulthandler
import gc
import locale
import os
import signal
import sys
import threading
import warnings

_ALARMS = tuple(
    getattr(signal, name)
    for name in ("ITIMER_REAL", "ITIMER_VIRTUAL", "ITIMER_PROF")
    if hasattr(signal, name)
)
_NUMPY_ERRORS = {
    "divide": "warn",
    "over": "warn",
    "under": "ignore",
    "invalid": "warn",
}  # as numpy has them at first


class KeptSettings:
    """Remembers the settings as they are when it is made."""

    def __init__(self):
        self._lists = [
            (kept, [*kept])
            for kept in (sys.path, sys.meta_path, sys.path_hooks, warnings.filters, gc.callbacks)
        ]
        self._importers = sys.path_importer_cache, {**sys.path_importer_cache}
        self._hooks = (sys.excepthook, sys.unraisablehook, sys.displayhook, threading.excepthook)
        self._tracers = sys.gettrace(), sys.getprofile()
        self._monitors = _monitors()
        self._alarms = [alarm for alarm in _ALARMS if not signal.getitimer(alarm)[0]]
        self._environment = {**os.environ}
        self._folder = _folder()
        self._mask = os.umask(0o077)
        os.umask(self._mask)
        self._locale = locale.setlocale(locale.LC_ALL)
        self._recursion = sys.getrecursionlimit()
        self._switch = sys.getswitchinterval()
        self._collects = gc.isenabled()
        numpy = sys.modules.get("numpy")
        self._numpy_errors = _NUMPY_ERRORS if numpy is None else numpy.geterr()

    def stop_alarms_and_tracers(self):
        """Ends what code has set up to interrupt others later."""
        for alarm in self._alarms:
            signal.setitimer(alarm, 0)
        faulthandler.cancel_dump_traceback_later()
        trace, profile = self._tracers
        sys.settrace(trace)
        sys.setprofile(profile)
        for tool in _monitors() - self._monitors:
            sys.monitoring.set_events(tool, 0)  # pyright: ignore[reportAttributeAccessIssue]
            sys.monitoring.free_tool_id(tool)  # pyright: ignore[reportAttributeAccessIssue]

    def restore(self):
        """Puts back everything."""
        for kept, content in self._lists:
            kept[:] = content  # pyright: ignore[reportCallIssue, reportIndexIssue]
        sys.path, sys.meta_path, sys.path_hooks, warnings.filters = (kept for kept, _ in self._lists[:4])
        # What is found while these are wrong is remembered: a folder of which nobody could read the modules has none.
        sys.path_importer_cache, importers = self._importers
        sys.path_importer_cache.clear()
        sys.path_importer_cache.update(importers)
        sys.excepthook, sys.unraisablehook, sys.displayhook, threading.excepthook = self._hooks
        if {**os.environ} != self._environment:
            os.environ.clear()
            os.environ.update(self._environment)
        if self._folder is not None and _folder() != self._folder:
            os.chdir(self._folder)
        os.umask(self._mask)
        sys.setrecursionlimit(self._recursion)
        sys.setswitchinterval(self._switch)
        if locale.setlocale(locale.LC_ALL) != self._locale:
            locale.setlocale(locale.LC_ALL, self._locale)
        if (numpy := sys.modules.get("numpy")) is not None:
            numpy.seterr(**self._numpy_errors)
        (gc.enable if self._collects else gc.disable)()


def _folder():
    try:
        return os.getcwd()
    except OSError:
        return None  # it was removed


def _monitors():
    """The tools of ``sys.monitoring`` that are in use."""
    monitoring = getattr(sys, "monitoring", None)
    return {tool for tool in range(6) if monitoring.get_tool(tool) is not None} if monitoring else set()
