# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps code that runs in the user's own Blender from what no undo takes back: files, sockets, processes, threads.

It stops what code does by mistake, and notes it. It is not a wall against code that means harm: for that, code runs in
the sandbox first, and what this guard noted there never reaches the user's Blender.
"""

import ast
import fnmatch
import os
import re
import sys
import threading

import bpy

_WRITES = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
_MODES = frozenset("wax+")
_BEGINNINGS = {
    "socket.": "opens a socket",
    "subprocess.": "starts a process",
    "shutil.": "changes files",
    "ctypes.": "calls C",
    "urllib.": "opens an address",
    "ftplib.": "opens an address",
    "http.": "opens an address",
    "smtplib.": "opens an address",
    "webbrowser.": "opens an address",
    "sqlite3.": "opens a database",
    "tempfile.": "writes a file",
}
_EVENTS = {
    **dict.fromkeys(
        (
            "os.system",
            "os.exec",
            "os.fork",
            "os.forkpty",
            "os.posix_spawn",
            "os.spawn",
            "os.startfile",
            "pty.spawn",
        ),
        "starts a process",
    ),
    **dict.fromkeys(
        (
            *("os.remove", "os.rename", "os.rmdir", "os.mkdir", "os.link", "os.symlink", "os.truncate"),
            *("os.chmod", "os.chown", "os.utime"),
        ),
        "changes files",
    ),
    "os.kill": "ends processes",
    "os.chdir": "changes the current folder",
    "_thread.start_new_thread": "starts a thread",
    "sys.addaudithook": "watches the interpreter for good",
    "signal.pthread_kill": "ends processes",
}
_ON_FILES = {
    "save_pre": "saves a file",
    "load_pre": "opens another file, in place of the user's",
    "render_init": "renders",
}
# Operators that end Blender, replace its file, write files, ask the user, or hold the window up.
_OPERATORS = (
    *("wm.quit_blender", "wm.open_mainfile", "wm.read_*", "wm.revert_mainfile", "wm.recover_*", "wm.save_*"),
    *(
        "wm.window_close",
        "wm.url_open*",
        "wm.path_open",
        "wm.*_export",
        "wm.*export_*",
        "export_*.*",
        "file.*",
    ),
    *("preferences.*", "extensions.*", "script.*", "ed.undo*", "ed.redo", "render.render", "render.opengl"),
    *(
        "image.save*",
        "text.save*",
        "sound.mixdown",
        "screen.screenshot*",
        "screen.animation_play",
        "simworlds.*",
    ),
)
_CALL = "_op_call"  # by this bpy.ops calls every operator
_ON_DISK = frozenset({"writes a file", "changes files"})
_OF_FLUID = re.compile(r"[/\\]cache_fluid_[0-9a-f]+(?:[/\\]|$)")  # as Blender itself names its folder
_MOST = 10
_running = {"guard": None}


class CodeGuard:
    """Used in ``with`` on the thread that runs code; ``noted`` are sentences on what the code tried."""

    def __init__(self):
        self.noted = []
        self._thread = threading.get_ident()

    def __enter__(self):
        install()
        self._bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True
        self._handlers = {name: self._noting(doing) for name, doing in _ON_FILES.items()}
        for name, handler in self._handlers.items():
            getattr(bpy.app.handlers, name).append(handler)
        self._ops = sys.modules["bpy.ops"]
        self._call = getattr(self._ops, _CALL, None)
        if self._call is not None:
            setattr(self._ops, _CALL, self._called)
        _running["guard"] = self
        return self

    def __exit__(self, *_error):
        _running["guard"] = None
        if self._call is not None:
            setattr(self._ops, _CALL, self._call)
        sys.dont_write_bytecode = self._bytecode
        for name, handler in self._handlers.items():
            listed = getattr(bpy.app.handlers, name)
            if handler in listed:
                listed.remove(handler)

    def check_operators(self, code):
        """Raises PermissionError for code that names an operator that must not be called. Other spellings than
        ``bpy.ops.group.name`` are found when they are called, if this Blender lets that be watched."""
        try:
            tree = ast.parse(code)
        except (SyntaxError, ValueError):
            return  # it will not run
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Attribute):
                self._check_operator(f"{node.value.attr}.{node.attr}")

    def _check_operator(self, name):
        if any(fnmatch.fnmatchcase(name, pattern) for pattern in _OPERATORS):
            self.note(f"it calls bpy.ops.{name}")
            raise PermissionError(f"Code for the user's open Blender must not call bpy.ops.{name}.")

    def note(self, words):
        """Notes what the code tried, once."""
        if words not in self.noted and len(self.noted) < _MOST:
            self.noted.append(words)

    def check(self, event, arguments):
        """Raises PermissionError for an event of the interpreter that must not be."""
        if threading.get_ident() != self._thread:
            return
        doing = _EVENTS.get(event)
        if doing is None and event == "open":
            doing = "writes a file" if _writes(*arguments[:3]) else None
        elif doing is None and "." in event:
            doing = _BEGINNINGS.get(event[: event.index(".") + 1])
        if doing is None or (doing in _ON_DISK and arguments and is_of_fluid(arguments[0])):
            return
        subject = str(arguments[0])[:200] if arguments and isinstance(arguments[0], (str, bytes)) else event
        self.note(f"it {doing} ({subject})")
        raise PermissionError(
            f"Code for the user's open Blender {doing}: {subject}. That is not allowed there."
        )

    def _called(self, name, *arguments, **options):
        assert self._call is not None
        self._check_operator(name.lower().replace("_ot_", "."))
        return self._call(name, *arguments, **options)

    def _noting(self, doing):
        def handler(*_):
            self.note(f"it {doing}")

        return handler


def is_of_fluid(path):
    """Whether a path is in a folder of Blender's own, in which a fluid keeps frames from when it is made."""
    return isinstance(path, (str, bytes)) and _OF_FLUID.search(os.fsdecode(path)) is not None


def _writes(path, mode, flags):
    if path == os.devnull:
        return False
    if isinstance(mode, str):
        return not _MODES.isdisjoint(mode)
    return bool((flags or 0) & _WRITES)


_installed = []


def install():
    """Has the interpreter ask the guard; without effect while no code runs in one."""
    if _installed:
        return

    def hook(event, arguments):
        if (guard := _running["guard"]) is not None:
            guard.check(event, arguments)

    sys.addaudithook(hook)  # it stays as long as Blender runs
    _installed.append(hook)
