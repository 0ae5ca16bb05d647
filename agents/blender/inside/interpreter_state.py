# SPDX-License-Identifier: GPL-3.0-or-later
"""Restores the Python interpreter after each call, so that executed code cannot break the next one."""

import _thread
import contextlib
import ctypes
import faulthandler
import fcntl
import os
import signal
import sys
import time

from .kept_names import KeptNames
from .kept_settings import KeptSettings

_GRACE_SECONDS = 0.5
_STREAMS = ("stdin", "stdout", "stderr")
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF, signal.SIGCHLD)
_PACKAGES = (__package__, "simworlds")
_OF_FUNCTIONS = frozenset({"__code__", "__defaults__", "__kwdefaults__"})  # what they do
_current_frames = sys._current_frames
_count_started = _thread._count

current = None  # this process's InterpreterState


class InterpreterState:
    """Remembers the interpreter at the start. ``high``: the lowest number for the descriptors that it keeps."""

    def __init__(self, high):
        for name in _STREAMS[1:]:
            getattr(sys, name).reconfigure(errors="backslashreplace", line_buffering=True)
        self._fds = {number: fcntl.fcntl(number, fcntl.F_DUPFD_CLOEXEC, high) for number in (0, 1, 2)}
        # On a crash, writes which line of Python it was in.
        faulthandler.enable(file=self._fds[2], all_threads=False)
        self._streams = {name: getattr(sys, name) for name in _STREAMS}
        self.names = KeptNames(_PACKAGES)
        self._settings = KeptSettings()
        self._cores = getattr(os, "sched_getaffinity", lambda _: None)(0)
        # None: set by Blender itself, in C. Code that replaces it leaves Python's default behind.
        self._signals = {number: signal.getsignal(number) or signal.SIG_DFL for number in _SIGNALS}
        self._threads = self._tasks = set()
        self._started = 0
        self._flush_c = ctypes.CDLL(None).fflush
        self._audited = 0
        self._recoded = False
        sys.addaudithook(self._note_events)
        globals()["current"] = self

    def _note_events(self, event, arguments):
        if event == "sys.addaudithook":
            self._audited += 1
        elif event == "object.__setattr__" and arguments[1] in _OF_FUNCTIONS:
            self._recoded = True

    def protect_modules(self):
        """Has the functions and classes of all our modules that are loaded restored as well."""
        self.names.protect_packages()

    def before(self):
        """Call it before a call: what that leaves behind is counted from here."""
        self._threads = set(_current_frames())
        self._started = _count_started()
        self._tasks = _tasks()
        self._audited = 0

    def after(self):
        """Restores what the call changed, and flushes what it printed.

        Returns descriptions of what it left behind that cannot be undone.
        """
        self.stop_alarms_and_tracers()
        for stream in {*(getattr(sys, name, None) for name in _STREAMS[1:]), *self._streams.values()}:
            with contextlib.suppress(Exception):
                stream.flush()
        self._flush_c(None)
        self._restore()
        left = []
        if threads := self._left_threads():
            left.append(f"{threads} thread{'s' if threads > 1 else ''} of its own still running")
        if self._audited:
            left.append("an audit hook, which Python cannot remove")
        return left

    def restore_names(self):
        """Puts back names in modules, and what functions do."""
        self.names.restore(functions=self._recoded)
        self._recoded = False

    def stop_alarms_and_tracers(self):
        """Ends what code has set up to interrupt others later."""
        self._settings.stop_alarms_and_tracers()
        for number, handler in self._signals.items():
            signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, ())

    def _restore(self):
        for number, kept in self._fds.items():
            os.dup2(kept, number)
        for name, stream in self._streams.items():
            if stream is not None and stream.closed:
                self._streams[name] = self._reopened(name)
            setattr(sys, name, self._streams[name])
        self.restore_names()
        self._settings.restore()
        if self._cores is not None and os.sched_getaffinity(0) != self._cores:
            os.sched_setaffinity(0, self._cores)

    @staticmethod
    def _reopened(name):
        number = _STREAMS.index(name)
        mode = "w" if number else "r"
        return open(number, mode, encoding="utf-8", errors="backslashreplace", buffering=1, closefd=False)

    def _left_threads(self):
        """How many of the call's threads still run after a grace period."""
        self._let_threads_start()
        deadline = time.monotonic() + _GRACE_SECONDS
        while left := self._running():
            if time.monotonic() > deadline:
                return left
            time.sleep(0.005)
        return 0

    def _running(self):
        """The number of new threads: those that run Python, or those that Python started, which may run only C."""
        return max(len(set(_current_frames()) - self._threads), _count_started() - self._started)

    def _let_threads_start(self):
        """Waits until new threads reach their first line: until then Python does not know of them."""
        deadline = time.monotonic() + _GRACE_SECONDS
        new = _tasks() - self._tasks
        quiet_rounds = 0
        while new and quiet_rounds < 2 and time.monotonic() < deadline and not self._running():
            time.sleep(0.002)  # lets a waiting thread have the interpreter
            quiet_rounds = 0 if any(map(_is_about_to_run, new)) else quiet_rounds + 1


def _tasks():
    """The numbers of this process's threads, whoever made them."""
    try:
        return set(os.listdir("/proc/self/task"))
    except OSError:
        return set()


def _is_about_to_run(task):
    """Whether a thread runs, is ready to, or never waited yet: before its first line it waits for the interpreter."""
    try:
        with open(f"/proc/self/task/{task}/status") as file:
            status = file.read()
    except OSError:
        return False
    return "\nState:\tR" in status or "\nvoluntary_ctxt_switches:\t0\n" in status
