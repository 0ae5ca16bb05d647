# SPDX-License-Identifier: GPL-3.0-or-later
"""Restores the Python interpreter after each call, so that executed code cannot break the next one."""

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
# Modules of which every name is restored: the tools depend on them.
_RESTORED_MODULES = (
    *("ast", "builtins", "contextlib", "ctypes", "fcntl", "functools", "gc", "hashlib", "hmac"),
    *("importlib", "io"),
    *("json", "json.decoder", "json.encoder", "linecache", "math", "os", "posixpath", "re"),
    *("signal", "struct"),
    *("threading", "time", "traceback", "types", "bpy", "bpy.ops", "bpy.path", "bpy.utils", "mathutils"),
)
_CODE = (types.FunctionType, types.BuiltinFunctionType, types.ModuleType, type)
_ABOVE = (__package__, "simworlds")
_OWN = tuple(f"{name}." for name in _ABOVE)  # how the names of our modules begin
_OF_FUNCTIONS = frozenset({"__code__", "__defaults__", "__kwdefaults__"})
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
        self._modules = {**sys.modules}
        self._names = [
            (module, {**vars(module)})
            for name in _RESTORED_MODULES
            if (module := sys.modules.get(name)) is not None
        ]
        self._code = {}
        for module, names in self._names:
            self._remember_code(module.__name__, names)
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
        if len(sys.modules) == self._seen:
            return
        self._seen = len(sys.modules)
        known = {id(module) for module, _ in self._names}
        for module in list(sys.modules.values()):
            name = str(getattr(module, "__name__", ""))
            if (name in _ABOVE or name.startswith(_OWN)) and id(module) not in known:
                code = {name: value for name, value in vars(module).items() if isinstance(value, _CODE)}
                self._names.append((module, code))
                self._remember_code(module.__name__, code)

    def forget_modules(self, loaded):
        """Forgets our modules that are not among ``loaded``: code has imported them, and may have changed them."""
        for name in [name for name in sys.modules if name.startswith(_OWN) and name not in loaded]:
            del sys.modules[name]
            above, _, last = name.rpartition(".")
            if above in sys.modules:
                vars(sys.modules[above]).pop(last, None)

    def _remember_code(self, module, names):
        """Remembers what the module's own functions and methods do: code can be put into a function as it stands."""
        own = [
            value
            for value in names.values()
            if isinstance(value, (types.FunctionType, type)) and value.__module__ == module
        ]
        classes = [value for value in own if isinstance(value, type)]
        for value in [*own, *(value for owner in classes for value in vars(owner).values())]:
            function = value
            if isinstance(value, (staticmethod, classmethod)):
                function = value.__func__
            elif isinstance(value, property):
                function = value.fget
            if isinstance(function, types.FunctionType):
                kept = (function.__code__, function.__defaults__, function.__kwdefaults__)
                self._code[id(function)] = (function, *kept)

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

    def stop_alarms_and_tracers(self):
        """Ends what code has set up to interrupt others later."""
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

    def _restore(self):
        for number, kept in self._fds.items():
            os.dup2(kept, number)
        for name, stream in self._streams.items():
            if stream is not None and stream.closed:
                self._streams[name] = self._reopened(name)
            setattr(sys, name, self._streams[name])
        self.restore_names()
        for kept, content in self._lists:
            kept[:] = content  # pyright: ignore[reportCallIssue, reportIndexIssue]
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

    def restore_names(self):
        """Restores the names in protected modules, what their functions do, the builtins, and ``sys.modules``.

        New names in modules stay: importing a submodule adds one.
        """
        for module, kept in self._names:
            now = vars(module)
            for name, value in kept.items():
                if now.get(name) is not value:
                    now[name] = value
        if self._recoded:
            for function, *kept in self._code.values():
                function.__code__, function.__defaults__, function.__kwdefaults__ = kept
            self._recoded = False
        for name in vars(builtins).keys() - self._builtins.keys():
            del vars(builtins)[name]  # pyright: ignore[reportIndexIssue]
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
