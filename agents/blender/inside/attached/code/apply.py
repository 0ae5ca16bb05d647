# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs code in the user's open Blender, and in the copy where it is rehearsed."""

import contextlib
import ctypes
import os
import threading

import bpy

from ...changes import listen
from ...execute import run_watched
from .code_guard import CodeGuard, is_of_fluid
from .undo_steps import MOST_BLOCKS
from .user_python import UserPython

_interrupt = ctypes.pythonapi.PyThreadState_SetAsyncExc


def apply(arguments, report):
    """Runs ``code`` for at most ``seconds``: as ``execute`` does, but guarded. Adds ``noted`` to its result.

    The interpreter is left as it was.
    """
    del report
    guard, python = CodeGuard(), UserPython()

    @contextlib.contextmanager
    def guarded():
        with guard, _deadline(arguments["seconds"]):
            guard.check_operators(arguments["code"])
            yield

    result = run_watched(
        arguments["code"], restore=lambda _loaded: python.restore(), around=guarded, most=MOST_BLOCKS
    )
    return {**result, "noted": guard.noted}


def rehearse(arguments, report):
    """The same in a sandbox. ``wrote`` lists files that appeared below ``folders`` meanwhile, whoever wrote them;
    ``stays`` what undo would not take back."""
    listen()
    before, kept = _files(arguments["folders"]), _stays()
    result = apply(arguments, report)
    after = _files(arguments["folders"])
    wrote = sorted(
        path for path, state in after.items() if before.get(path) != state and not is_of_fluid(path)
    )
    stays = [f"{now - kept[name]} more {name}" for name, now in _stays().items() if now > kept[name]]
    return {**result, "wrote": wrote[:20], "stays": stays}


def _stays():
    """How many there are of what undo does not take back."""
    lists = (getattr(bpy.app.handlers, name, None) for name in dir(bpy.app.handlers))
    return {
        "handlers": sum(len(handlers) for handlers in lists if isinstance(handlers, list)),
        "registered classes": len(bpy.types.Operator.__subclasses__())
        + len(bpy.types.Panel.__subclasses__()),
    }


def _files(folders):
    found = {}
    for folder in folders:
        for place, _, names in os.walk(folder):
            for name in names:
                path = os.path.join(place, name)
                with contextlib.suppress(OSError):
                    status = os.lstat(path)
                    found[path] = (status.st_size, status.st_mtime_ns)
    return found


class OutOfTime(BaseException):
    """The code ran past its deadline."""


@contextlib.contextmanager
def _deadline(seconds):
    """Ends Python code that runs on, at its next line: what Blender itself does cannot be interrupted."""
    main, done = ctypes.c_ulong(threading.get_ident()), threading.Event()

    def watch():
        if not done.wait(seconds):
            _interrupt(main, ctypes.py_object(OutOfTime))

    watcher = threading.Thread(target=watch, name="simworlds-deadline", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join(1.0)
        # At the end of a loop Python raises what it was told to: here, and not in what comes after.
        for _ in range(2):
            pass
