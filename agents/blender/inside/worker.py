# SPDX-License-Identifier: GPL-3.0-or-later
"""The loop that runs in Blender: takes a request, runs its tool, answers.

Started as ``… worker.py -- SOCKET``. The first bytes on the socket are the key that signs all frames. Standard output
and error belong to whatever Blender and executed code print; the supervisor reads them.
"""

import fcntl
import importlib
import os
import sys
import time
import traceback

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

import bodies
import frames
import mantaflow
import steadiness
from refusal import Refused

# Tool → (module beside this file, function). A tool takes its arguments and ``report(done, total, text)``, and
# returns what JSON can say.
TOOLS = {
    "execute": ("execute", "execute"),
    "open": ("files", "open_file"),
    "write": ("files", "write_file"),
    "ping": ("files", "ping"),
    "tag": ("tag", "tag"),
    "save": ("saving", "save"),
    "look": ("saving", "look"),
    "load": ("saving", "load"),
    "kept_caches": ("saving", "caches_of_file"),
    "bake": ("bake", "bake"),
    "snapshot": ("snapshot", "snapshot"),
    "measure": ("measuring", "measure"),
    "stand_at": ("timeline", "stand_at"),
    "findings_image": ("findings_image", "picture"),
    "group": ("group", "group"),
    "preview": ("previews", "preview"),
    "motion_sheet": ("motion_sheet", "motion_sheet"),
    "scene_state": ("scene_state", "scene_state"),
    "render_plan": ("render", "plan"),
    "render_step": ("render", "step"),
    "render_frame": ("render", "render_frame"),
    "render_put_back": ("render", "put_back"),
    "render_video": ("video", "assemble"),
    "fluid_self_test": ("mantaflow", "self_test"),
    "check_escapes": ("checkup", "try_escapes"),
    "check_workbench": ("checkup", "workbench"),
    "check_cycles": ("checkup", "cycles"),
    "check_video": ("checkup", "video"),
}
# Numbers of kept descriptors: code that closes "all" of them up to some small number misses these.
_HIGH = 200
_CHUNK = 1 << 16
_NO_NUMPY = (
    "This Blender's Python has no numpy, which this tool needs. Blenders from blender.org bring it; for a system's own "
    "one, install the system's numpy (Debian: apt-get install python3-numpy)."
)
_FOLDER = os.path.dirname(os.path.abspath(__file__))


class _Wire:
    """The supervisor's socket."""

    def __init__(self, descriptor):
        self._fd = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, _HIGH)
        os.close(descriptor)
        key = b""
        while len(key) < frames.KEY_BYTES:
            key += self._read(frames.KEY_BYTES - len(key))
        self._encode = frames.Encoder(key, frames.WORKER)
        self._decoder = frames.Decoder(key, frames.SUPERVISOR)
        self._waiting = []

    def _read(self, count):
        data = os.read(self._fd, count)
        if not data:
            raise EOFError
        return data

    def receive(self):
        while not self._waiting:
            self._waiting = self._decoder.feed(self._read(_CHUNK))
        return self._waiting.pop(0)

    def send(self, message):
        data = memoryview(self._encode(message))
        while data:
            data = data[os.write(self._fd, data) :]


def _function(tool):
    module, function = TOOLS[tool]
    loaded = sys.modules.get(module)
    if loaded is not None and getattr(loaded, "__file__", None) != os.path.join(_FOLDER, f"{module}.py"):
        del sys.modules[module]  # executed code has one of that name
    return getattr(importlib.import_module(module), function)


def _answer(request, wire, steady):
    ticket = request["ticket"]

    def report(done, total, text=""):
        wire.send({"ticket": ticket, "progress": [done, total, str(text)]})

    started = time.perf_counter()
    try:
        function = _function(request["tool"])
        steady.lean_on(_FOLDER)
        steady.before()
        reply = {"value": function(request["arguments"], report)}
    except Refused as error:
        reply = {"refused": str(error)}
    except BaseException as error:
        reply = {"failed": f"{type(error).__name__}: {error}", "traceback": traceback.format_exc()[-8000:]}
        if isinstance(error, ModuleNotFoundError) and error.name == "numpy":
            reply = {"refused": _NO_NUMPY}
    reply["seconds"] = time.perf_counter() - started
    return reply


def _settled(steady):
    """What the call left behind; an alarm that executed code has set may ring until it is taken back."""
    for _ in range(100):
        try:
            return steady.after()
        except Exception as error:
            fault = error
    return [f"an interpreter that cannot be put right ({type(fault).__name__}: {fault})"]


def _send(wire, reply):
    try:
        wire.send(reply)
    except (frames.TooLarge, TypeError, ValueError, RecursionError) as error:
        unsaid = {"refused": f"The answer cannot be sent: {error}.", "seconds": reply["seconds"]}
        wire.send({**unsaid, "ticket": reply["ticket"], "left": reply["left"]})


def serve(descriptor):
    """Answers until the supervisor closes the socket, then ends the process."""
    wire = _Wire(descriptor)
    mantaflow.mend()
    bodies.watch()
    steady = steadiness.Steadiness(_HIGH)
    wire.send({"ready": True})
    code = frames.CHANNEL_LOST
    try:
        while True:
            request = wire.receive()
            try:
                reply = _answer(request, wire, steady)
            except BaseException as error:
                reply = {"failed": f"{type(error).__name__}: {error}", "traceback": "", "seconds": 0.0}
            _send(wire, {**reply, "left": _settled(steady), "ticket": request["ticket"]})
    except EOFError:
        code = 0
    except (OSError, frames.ForgedFrame):
        pass
    # A process that has run a fluid simulation aborts when the interpreter shuts down in the usual way.
    os._exit(code)


if __name__ == "__main__":
    serve(int(sys.argv[sys.argv.index("--") + 1]))
