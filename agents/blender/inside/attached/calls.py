# SPDX-License-Identifier: GPL-3.0-or-later
"""Listens to clients and runs their calls, one at a time, from a timer of Blender's."""

import contextlib
import importlib
import io
import os
import queue
import secrets
import sys
import time
import traceback
from collections import deque

import bpy
from bpy.app.handlers import persistent

from simworlds.sandbox.inside.refusal import Refused

from .code.undo_steps import UndoSteps, digest
from .connection import announcement
from .connection.listener import Listener
from .files import copies
from .long_work import LongWork
from .user import busy, marks
from .user_state import main_window

LOOK, SHOW, CHANGE, CODE, LONG = "look", "show", "change", "run code", "work long"
# Tool → (module of the worker's package, function, what it needs).
TOOLS = {
    "user_digests": ("attached.user_state", "digests", LOOK),
    "user_state": ("attached.user.window", "user_state", LOOK),
    "screenshot": ("attached.user.window", "screenshot", LOOK),
    "write_copy": ("attached.files.copies", "write_copy", LOOK),
    "write_part": ("attached.files.parts", "write_part", LOOK),
    "scene_state": ("attached.user.window", "scene_state", LOOK),
    "present": ("api_presence", "present", LOOK),
    "opened": ("", "", LOOK),
    "show": ("attached.user.show", "show", SHOW),
    "mark": ("attached.user.show", "mark", LOOK),
    "undo": ("", "", CHANGE),
    "tag": ("tag", "tag", CHANGE),
    "group": ("group", "group", CHANGE),
    "fluids": ("physics.bake", "fluids", LOOK),
    "bake": ("attached.bakes", "bake_in_steps", LONG),
    "free_bake": ("attached.bakes", "free", CHANGE),
    "apply": ("attached.code.apply", "apply", CODE),
}
_IN_WORDS = {
    "user_state": "read what is selected",
    "screenshot": "looked at the window",
    "write_copy": "copied the scene",
    "write_part": "copied a part of the scene",
    "scene_state": "read the scene",
    "present": "looked names up",
    "fluids": "looked for fluids",
    "undo": "undid steps",
    "mark": "marked objects",
}
_LONGEST_STEP = 100
_WORKER = __package__.rpartition(".")[0]
_PATIENCE_SECONDS = 1.5  # in which what the user does may end before a call is refused
_QUICK, _SLOW = 0.01, 0.1  # seconds between two looks into the queue
_LIVELY_SECONDS = 20.0  # after a call, more are expected
_LOGGED = 12
_LONGEST = 20_000


class LogEntry:
    """A call in the log: ``text``, its ``seconds``, and whether it went ``well``."""

    def __init__(self, text, seconds, *, well):
        self.text, self.seconds, self.well = text, seconds, well


class Rights:
    """What clients may do, as the user has set it."""

    change = True
    code = True
    unrehearsed = False
    several = False
    ignore_addons = False


class CallRunner:
    """Listens and runs calls from ``start`` to ``stop``. ``rights`` is asked at every call."""

    def __init__(self, rights, version, redraw=lambda: None):
        self.log = deque(maxlen=_LOGGED)
        self.undo_steps = UndoSteps()
        self.listener = None
        self._rights, self._version, self._redraw = rights, version, redraw
        self._head = None
        self._work = None
        self._lively = 0.0
        self._opened = 1  # files, one after the other
        self._wanted = deque()

    @property
    def clients(self):
        """The names of the clients."""
        return [client.name for client in self.listener.clients] if self.listener else []

    def start(self):
        """Begins to listen. Raises OSError."""
        if self.listener is not None:
            return
        self._token = secrets.token_hex(32)
        self.listener = Listener(self._token, {})
        try:
            self.announce()
        except OSError:
            self.listener.stop("It could not say where it listens.")
            self.listener = None
            raise
        for name, handler in self._handlers().items():
            getattr(bpy.app.handlers, name).append(handler)
        bpy.app.timers.register(self.tick, first_interval=_QUICK, persistent=True)

    def stop(self, why="The user has stopped SimWorlds in Blender's panel."):
        """Ends all connections; clients are told ``why``."""
        if self.listener is None:
            return
        if self._work is not None:
            self._end_work({"refused": why})
        self.leave(why)
        self._head = None
        marks.set_marks([])
        for name, handler in self._handlers().items():
            with contextlib.suppress(ValueError):
                getattr(bpy.app.handlers, name).remove(handler)
        if bpy.app.timers.is_registered(self.tick):
            bpy.app.timers.unregister(self.tick)

    def leave(self, why):
        """Ends all connections without touching Blender, which may be ending."""
        announcement.remove()
        if self.listener is not None:
            self.listener.stop(why)
            self.listener = None

    def announce(self):
        """Writes where it listens, for which file, and what may be done. Raises OSError."""
        rights = self._rights()
        about = {
            "process": os.getpid(),
            "blender": bpy.app.version_string,
            "executable": bpy.app.binary_path,
            "extension": self._version,
            "file": bpy.data.filepath,
            "scene": main_window().scene.name,
            "may": {"change": rights.change, "code": rights.code, "unrehearsed": rights.unrehearsed},
        }
        self.listener.about = about
        self.listener.several = rights.several
        announcement.write({"port": self.listener.port, "token": self._token, **about})

    def want(self, work):
        """Has ``work()`` called by the timer, outside of the operator that runs now."""
        self._wanted.append(work)

    def tick(self):
        """Takes messages, and runs one call at most. Blender's timer calls it; returns seconds until the next time."""
        if self.listener is None:
            return None
        try:
            self.listener.turn()
            if self.listener.changed:
                self.listener.changed = False
                self._redraw()
            self._step()
        except Exception:
            traceback.print_exc()
        if self.listener is None:
            return None
        waits = self._head is not None or self._work is not None or self.listener.is_talking
        return _QUICK if waits or time.monotonic() < self._lively else _SLOW

    def _step(self):
        copies.keep_unsaved()
        while self._wanted:
            self._wanted.popleft()()
        if self._work is not None:
            self._go_on()
        if self._head is None:
            try:
                self._head = self.listener.requests.get_nowait()
            except queue.Empty:
                return
        request, now = self._head, time.monotonic()
        self._lively = now + _LIVELY_SECONDS
        if request.withdrawn or now > request.deadline:
            why = (
                "It was withdrawn"
                if request.withdrawn
                else f"Blender had no time for it in {request.seconds:g} s"
            )
            request.reply(refused=f"{why}: nothing was done.", seconds=0.0, left=[], events=[])
            self._done(request)
            return
        if doing := self._busy():
            if now - request.arrived > _PATIENCE_SECONDS:
                self._answer(request, {"refused": doing, "kind": "busy", "seconds": 0.0})
            return
        self._run(request)

    def _busy(self):
        """Why no call can run now, with what to wait for; "" if one can."""
        if self._work is not None:
            return f"{self._work}. Call again when that is done."
        doing = busy.reason(but_addons=self._rights().ignore_addons)
        return f"The user is busy in Blender: {doing}." if doing else ""

    def _run(self, request):
        started = time.perf_counter()
        printed = io.StringIO()
        answer = self._outcome(lambda: self._perform(request, printed))
        if self._work is not None:
            self._head = None
            return  # it has only begun
        answer["seconds"] = time.perf_counter() - started
        answer["stdout"] = printed.getvalue()[-_LONGEST:]
        self._answer(request, answer)

    def _go_on(self):
        """Works on the call that takes long, and answers it at its end."""
        answer = self._outcome(self._work.go_on)
        if self._work.has_ended:
            answer = {"value": self._work.value}
        elif "value" in answer:
            return
        self._end_work(answer)

    def _end_work(self, answer):
        """Answers the call; what it did is one step, which is taken back unless it is done."""
        work, self._work = self._work, None
        kept = self._outcome(lambda: self._keep_work(work))
        if "value" not in kept:
            said, why = (one.get("refused") or one.get("failed", "") for one in (answer, kept))
            answer = {"refused": f"{said} What is left of it could not be put in order: {why}".strip()}
        answer.update(seconds=time.perf_counter() - work.started, stdout="")
        self._answer(work.request, answer)

    def _keep_work(self, work):
        work.close()
        self.undo_steps.keep(work.request.step or work.request.tool, work.before)
        if not work.has_ended:
            self.undo_steps.undo(1)

    @staticmethod
    def _outcome(work):
        """What ``work`` returns or raises, as an answer."""
        try:
            return {"value": work()}
        except copies.TooLarge as error:
            return {"refused": str(error)[:_LONGEST], "kind": "large"}
        except Refused as error:
            return {"refused": str(error)[:_LONGEST]}
        except Exception as error:
            if isinstance(error, ModuleNotFoundError) and not str(error.name).startswith(_WORKER):
                return {"missing": str(error.name)}
            return {
                "failed": f"{type(error).__name__}: {error}"[:_LONGEST],
                "traceback": traceback.format_exc()[-8000:],
            }

    def _perform(self, request, printed):
        entry = TOOLS.get(request.tool)
        if entry is None:
            raise Refused(f"The extension in Blender has no {request.tool!r}: simworlds extension install.")
        kind = entry[2]
        self._check_right(kind, request)
        step = request.step = str(request.arguments.pop("step", ""))[:_LONGEST_STEP]
        if request.tool == "opened":
            return self._opened
        if request.tool == "undo":
            return self.undo_steps.undo(int(request.arguments["count"]))

        if kind == LONG:
            self._begin_work(request, entry)
            return None

        def report(done, total, text=""):
            request.client.send({"ticket": request.ticket, "progress": [done, total, str(text)[:_LONGEST]]})

        function = _function(entry)
        if kind == LOOK:
            return function(request.arguments, report)
        self._check_undo()
        restores = bool(request.arguments.pop("restores", False))
        before, changed = digest(), False
        try:
            with (
                contextlib.redirect_stdout(_Both(sys.stdout, printed))
                if kind == CODE
                else contextlib.nullcontext()
            ):
                value = function(request.arguments, report)
        finally:
            changed = before is None or digest() != before
            if changed or kind == SHOW:
                self.undo_steps.keep(step or request.tool, before)
        if restores and changed and value["error"]:
            self.undo_steps.undo(1)
        return value

    def _begin_work(self, request, entry):
        """Begins a call that takes long; ``_go_on`` does the rest."""
        self._check_undo()

        def report(done, total, text=""):
            if self._work is not None:
                self._work.report(done, total, text)

        self._work = LongWork(request, _function(entry)(request.arguments, report))

    def _check_right(self, kind, request):
        rights = self._rights()
        if kind in {CHANGE, CODE, LONG} and not rights.change:
            raise Refused(
                "The user allows SimWorlds only to look, not to change anything (panel SimWorlds in Blender)."
            )
        if kind == CODE and not rights.code:
            raise Refused("The user does not allow SimWorlds to run code (panel SimWorlds in Blender).")
        if kind == CODE and not request.arguments.pop("rehearsed", False) and not rights.unrehearsed:
            raise Refused(
                "The code was not rehearsed, and the user allows no other (panel SimWorlds in Blender)."
            )

    @staticmethod
    def _check_undo():
        if not bpy.context.preferences.edit.use_global_undo:
            raise Refused(
                "Global Undo is off, so nothing could be undone: ask the user to turn it on (Preferences > System)."
            )
        active = main_window().view_layer.objects.active
        if active is not None and active.mode != "OBJECT":
            raise Refused(
                f"The user is in {active.mode} mode on {active.name!r}, where Blender's undo knows that object alone. "
                "Ask them to go back to Object mode (Tab), and call again."
            )

    def _answer(self, request, answer):
        events, request.client.events = request.client.events[:20], []
        request.reply(**answer, left=[], events=events)
        well = "value" in answer
        text = str(request.step or _IN_WORDS.get(request.tool, request.tool))
        if not well:
            text += f": {answer.get('refused') or answer.get('failed') or 'failed'}"
        if request.tool != "opened":  # a question of SimWorlds itself
            self.log.appendleft(LogEntry(text, answer["seconds"], well=well))
        self._done(request)
        self._redraw()

    def _done(self, request):
        self.listener.finished(request)
        if self._head is request:
            self._head = None

    # What the user does

    def _tell(self, event):
        for client in self.listener.clients if self.listener else ():
            if event not in client.events:
                client.events.append(event)

    def _handlers(self):
        if not hasattr(self, "_kept_handlers"):
            self._kept_handlers = self._new_handlers()
        return self._kept_handlers

    def _new_handlers(self):
        @persistent
        def loaded(*_):
            self._opened += 1
            self.undo_steps.forget()
            if self._work is not None:  # by code of an add-on: the user's hands are held
                work, self._work = self._work, None
                work.close()
                self._answer(work.request, {"refused": "Another file was opened meanwhile.", "seconds": 0.0})
            copies.forget_unsaved()
            name = bpy.data.filepath or "a new file"
            self._tell(
                f"The user has opened {name}: what you knew of the scene no longer holds. Read its state."
            )
            self._announce_quietly()

        @persistent
        def saved(*_):
            copies.forget_unsaved()
            self._tell(f"The user has saved the file as {bpy.data.filepath}.")
            self._announce_quietly()

        @persistent
        def undone(*_):
            if not self.undo_steps.busy:
                self._tell("The user has undone or redone steps. Read what you build on before you go on.")

        return {"load_post": loaded, "save_post": saved, "undo_post": undone, "redo_post": undone}

    def _announce_quietly(self):
        if self.listener is not None:
            with contextlib.suppress(OSError, LookupError):
                self.announce()


def _function(entry):
    """What a tool's entry names."""
    return getattr(importlib.import_module(f"{_WORKER}.{entry[0]}"), entry[1])


class _Both:
    """A stream that writes to two: to Blender's console, and to the answer."""

    def __init__(self, *streams):
        self._streams = [stream for stream in streams if stream is not None]

    def write(self, text):
        for stream in self._streams:
            stream.write(text)
        return len(text)

    def flush(self):
        for stream in self._streams:
            stream.flush()
