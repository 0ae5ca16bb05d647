# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers the supervisor's calls over the channel, one by one, until it closes.

The first bytes on the socket are the key that signs all frames. Standard output and error belong to whatever Blender
and executed code print; the supervisor reads them.
"""

import fcntl
import importlib
import os
import time
import traceback
import types

from . import channel
from .refusal import Refused

# Numbers of our descriptors: code that closes "all" low-numbered ones misses these.
HIGH = 200
_CHUNK = 1 << 16
_LONGEST = 20_000  # characters of a text that the supervisor reads


class Tools:
    """Tools by name, each loaded on its first call: name → (module of ``package``, function)."""

    def __init__(self, package, table):
        self._package = package
        self._table = types.MappingProxyType(dict(table))  # code may write to the module's own

    def find(self, name):
        """The function of a tool."""
        module, function = self._table[name]
        return getattr(importlib.import_module(f"{self._package}.{module}"), function)


class Guard:
    """Runs before and after each call. This one does nothing."""

    def before(self):
        """A call begins."""

    def after(self):
        """A call has ended. Returns what it left behind that cannot be undone, in words."""
        return []


def serve(descriptor, answer, guard=None, largest=channel.LARGEST_BODY):
    """Answers until the supervisor closes the socket, then ends the process.

    ``answer(tool, arguments, report)`` returns a value for JSON, or raises Refused; ``report(done, total, text)`` sends
    progress. A reply may have ``largest`` bytes.
    """
    wire = _Wire(descriptor, largest)
    guard = guard or Guard()
    wire.send({"ready": True})
    code = channel.CHANNEL_LOST
    try:
        while True:
            request = wire.receive()
            try:
                reply = _reply(request, wire, answer, guard)
            except BaseException as error:
                reply = {"failed": _words(error), "traceback": "", "seconds": 0.0}
            _send(wire, {**reply, "left": _after(guard), "ticket": request["ticket"]})
    except EOFError:
        code = 0
    except (OSError, channel.ForgedFrame):
        pass
    # A process that has run a fluid simulation aborts when the interpreter shuts down in the usual way.
    os._exit(code)


class _Wire:
    """The supervisor's socket."""

    def __init__(self, descriptor, largest):
        self._fd = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, HIGH)
        os.close(descriptor)
        key = b""
        while len(key) < channel.KEY_BYTES:
            key += self._read(channel.KEY_BYTES - len(key))
        self._encode = channel.Encoder(key, channel.WORKER, largest)
        self._decoder = channel.Decoder(key, channel.SUPERVISOR)
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


def _reply(request, wire, answer, guard):
    ticket = request["ticket"]

    def report(done, total, text=""):
        wire.send({"ticket": ticket, "progress": [done, total, str(text)[:_LONGEST]]})

    started = time.perf_counter()
    try:
        guard.before()
        reply = {"value": answer(request["tool"], request["arguments"], report)}
    except Refused as error:
        reply = {"refused": str(error)[:_LONGEST]}
    except ModuleNotFoundError as error:
        reply = {"missing": str(error.name)}
    except BaseException as error:
        reply = {"failed": _words(error), "traceback": traceback.format_exc()[-8000:]}
    reply["seconds"] = time.perf_counter() - started
    return reply


def _after(guard):
    """What the call left behind; retried, since an alarm that executed code has set may interrupt it."""
    for _ in range(100):
        try:
            return guard.after()
        except Exception as error:
            fault = error
    return [f"an interpreter that cannot be restored ({_words(fault)[:1000]})"]


def _words(error):
    return f"{type(error).__name__}: {error}"[:_LONGEST]


def _send(wire, reply):
    try:
        wire.send(reply)
    except (channel.TooLarge, TypeError, ValueError, RecursionError) as error:
        refusal = {"refused": f"The reply cannot be sent: {error}.", "seconds": reply["seconds"]}
        wire.send({**refusal, "ticket": reply["ticket"], "left": reply["left"]})
