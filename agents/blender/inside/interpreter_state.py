# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts the interpreter back between two calls: executed code must not poison the next one."""

import _thread
import builtins
import contextlib
import ctypes
import faulthandler
import fcntl
import gc
import locale
import os
import signal
import sys
import threading
import time
import types
import warnings

_GRACE_SECONDS = 0.5
_STREAMS = ("stdin", "stdout", "stderr")
_ALARMS = (signal.ITIMER_REAL, signal.ITIMER_VIRTUAL, signal.ITIMER_PROF)
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM, signal.SIGVTALRM, signal.SIGPROF, signal.SIGCHLD)
# Modules whose names, all of them, are put back: this side's tools lean on them.
_LEANED_ON = (
    *(
        "ast",
        "builtins",
        "contextlib",
        "ctypes",
        "fcntl",
        "functools",
        "gc",
        "hashlib",
        "hmac",
        "importlib",
        "io",
    ),
    *(
        "json",
        "json.decoder",
        "json.encoder",
        "linecache",
        "math",
        "os",
        "posixpath",
        "re",
        "signal",
        "struct",
    ),
    *("threading", "time", "traceback", "types", "bpy", "bpy.ops", "bpy.path", "bpy.utils", "mathutils"),
)
_CODE = (types.FunctionType, types.BuiltinFunctionType, types.ModuleType, type)
_current_frames = sys._current_frames
_count_started = _thread._count

current = None  # the one of this process


class InterpreterState:
    """Remembers how things stood at the start. ``high``: lowest number for descriptors that are kept."""

    def __init__(self, high):
        for name in _STREAMS[1:]:
            getattr(sys, name).reconfigure(errors="backslashreplace", line_buffering=True)
        self._fds = {number: fcntl.fcntl(number, fcntl.F_DUPFD_CLOEXEC, high) for number in (0, 1, 2)}
        # Last words of a crash: which line of Python it was in.
        faulthandler.enable(file=self._fds[2], all_threads=False)
        self._streams = {name: getattr(sys, name) for name in _STREAMS}
        self._modules = {**sys.modules}
        self._names = [
            (module, {**vars(module)}) for name in _LEANED_ON if (module := sys.modules.get(name)) is not None
        ]
        self._seen = 0
        self._builtins = {**vars(builtins)}
        self._environment = {**os.environ}
        self._lists = [
            (kept, [*kept])
            for kept in (sys.path, sys.meta_path, sys.path_hooks, warnings.filters, gc.callbacks)
        ]
        self._folder = os.getcwd()
        self._mask = os.umask(0o077)
        os.umask(self._mask)
        self._locale = locale.setlocale(locale.LC_ALL)
        self._cores = getattr(os, "sched_getaffinity", lambda _: None)(0)
        self._recursion = sys.getrecursionlimit()
        self._switch = sys.getswitchinterval()
        self._hooks = (sys.excepthook, sys.unraisablehook, sys.displayhook, threading.excepthook)
        # None: set by Blender itself, in C. Code that replaces it leaves Python's default behind.
        self._signals = {number: signal.getsignal(number) or signal.SIG_DFL for number in _SIGNALS}
        self._threads = self._tasks = set()
        self._started = 0
        self._flush_c = ctypes.CDLL(None).fflush
        self._audited = 0
        sys.addaudithook(self._note_hooks)
        globals()["current"] = self

    def _note_hooks(self, event, _arguments):
        if event == "sys.addaudithook":
            self._audited += 1

    def lean_on(self, folder):
        """Modules that have been loaded from below ``folder`` are this side's: their functions are put back, too."""
        if len(sys.modules) == self._seen:
            return
        self._seen = len(sys.modules)
        known = {id(module) for module, _ in self._names}
        for module in list(sys.modules.values()):
            path = getattr(module, "__file__", None) or ""
            if path.startswith(folder + os.sep) and id(module) not in known:
                code = {name: thing for name, thing in vars(module).items() if isinstance(thing, _CODE)}
                self._names.append((module, code))

    def before(self):
        """A call begins: what it leaves behind will be counted from here."""
        self._threads = set(_current_frames())
        self._started = _count_started()
        self._tasks = _tasks()
        self._audited = 0

    def after(self):
        """Puts back what the call has bent, and writes out what it printed.

        Returns in words what it left behind that cannot be put back.
        """
        self._calm()
        for stream in {*(getattr(sys, name, None) for name in _STREAMS[1:]), *self._streams.values()}:
            with contextlib.suppress(Exception):
                stream.flush()
        self._flush_c(None)
        self._put_back()
        left = []
        if threads := self._left_threads():
            left.append(f"{threads} thread{'s' if threads > 1 else ''} of its own that went on")
        if self._audited:
            left.append("an audit hook, which Python cannot take back")
        return left

    def _calm(self):
        """No alarm rings any more, no tracer looks on."""
        for alarm in _ALARMS:
            signal.setitimer(alarm, 0)
        faulthandler.cancel_dump_traceback_later()
        for number, handler in self._signals.items():
            signal.signal(number, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
        sys.settrace(None)
        sys.setprofile(None)
        monitoring = getattr(sys, "monitoring", None)
        for tool in range(6) if monitoring else ():
            if monitoring.get_tool(tool) is not None:
                monitoring.set_events(tool, 0)
                monitoring.free_tool_id(tool)

    def _put_back(self):
        for number, kept in self._fds.items():
            os.dup2(kept, number)
        for name, stream in self._streams.items():
            if stream is not None and stream.closed:
                self._streams[name] = self._reopened(name)
            setattr(sys, name, self._streams[name])
        self.put_names_back()
        for kept, content in self._lists:
            kept[:] = content
        sys.path, sys.meta_path, sys.path_hooks, warnings.filters = (kept for kept, _ in self._lists[:4])
        sys.excepthook, sys.unraisablehook, sys.displayhook, threading.excepthook = self._hooks
        if {**os.environ} != self._environment:
            os.environ.clear()
            os.environ.update(self._environment)
        os.chdir(self._folder)
        os.umask(self._mask)
        sys.setrecursionlimit(self._recursion)
        sys.setswitchinterval(self._switch)
        if locale.setlocale(locale.LC_ALL) != self._locale:
            locale.setlocale(locale.LC_ALL, self._locale)
        if self._cores is not None and os.sched_getaffinity(0) != self._cores:
            os.sched_setaffinity(0, self._cores)
        if (numpy := sys.modules.get("numpy")) is not None:
            numpy.seterr(divide="warn", over="warn", under="ignore", invalid="warn")
        gc.enable()

    def put_names_back(self):
        """What names stand for in the modules that this side leans on, and which modules there are.

        Names that have come are left alone: importing a submodule makes one.
        """
        for module, kept in self._names:
            now = vars(module)
            for name, thing in kept.items():
                if now.get(name) is not thing:
                    now[name] = thing
        for name in vars(builtins).keys() - self._builtins.keys():
            del vars(builtins)[name]
        for name, module in self._modules.items():
            sys.modules.setdefault(name, module)
        for module, _ in self._names:
            sys.modules[module.__name__] = module

    @staticmethod
    def _reopened(name):
        number = _STREAMS.index(name)
        mode = "w" if number else "r"
        return open(number, mode, encoding="utf-8", errors="backslashreplace", buffering=1, closefd=False)

    def _left_threads(self):
        """How many of the call's threads go on, after a moment in which they may end."""
        self._let_begin()
        deadline = time.monotonic() + _GRACE_SECONDS
        while left := self._going_on():
            if time.monotonic() > deadline:
                return left
            time.sleep(0.005)
        return 0

    def _going_on(self):
        """Threads that run Python's code, and those that it has started: they may run C's alone."""
        return max(len(set(_current_frames()) - self._threads), _count_started() - self._started)

    def _let_begin(self):
        """Lets threads that were just made come to their first line: until then Python does not know of them."""
        deadline = time.monotonic() + _GRACE_SECONDS
        new = _tasks() - self._tasks
        calm = 0
        while new and calm < 2 and time.monotonic() < deadline and not self._going_on():
            time.sleep(0.002)  # whoever waits for the interpreter has it meanwhile
            calm = 0 if any(map(_is_about_to_run, new)) else calm + 1


def _tasks():
    """The numbers of this process's threads, whoever made them."""
    try:
        return set(os.listdir("/proc/self/task"))
    except OSError:
        return set()


def _is_about_to_run(task):
    """Whether a thread runs or is to, or has not waited yet, as it does for the interpreter before its first line."""
    try:
        with open(f"/proc/self/task/{task}/status") as file:
            status = file.read()
    except OSError:
        return False
    return "\nState:\tR" in status or "\nvoluntary_ctxt_switches:\t0\n" in status
