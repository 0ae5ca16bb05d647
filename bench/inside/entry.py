# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers what the audit asks about one untrusted .blend: ``entry.py -- DESCRIPTOR``.

The descriptor is a socket that nothing but this module writes to: what Blender prints, about whatever is in the file,
goes to stdout. Messages are a length (4 bytes, big-endian) and JSON: {"job", "arguments"} in; {"value"}, or in a
sentence {"refused"} (the file is not fit for it), {"failed"} (nobody knows why) or {"unable"} (this Blender is not)
out. No script of the file runs, so nobody else in this process knows of the descriptor.
"""

import importlib
import json
import os
import struct
import sys

_FOLDER = os.path.dirname(os.path.abspath(__file__))
if _FOLDER not in sys.path:
    sys.path.insert(0, _FOLDER)

# What is asked → the module and function that answer, with the arguments of the message as their own.
JOBS = {
    "open": ("opening", "open_file"),
    "facts": ("facts", "read_facts"),
    "measure": ("measure", "measure"),
    "frames": ("frames", "render"),
}
_LENGTH = struct.Struct(">I")
_CHUNK = 1 << 20


def _receive(descriptor):
    """The next message; None when the other end is closed."""
    head = _read(descriptor, _LENGTH.size)
    if head is None:
        return None
    body = _read(descriptor, _LENGTH.unpack(head)[0])
    return None if body is None else json.loads(body)


def _read(descriptor, count):
    found = bytearray()
    while len(found) < count:
        data = os.read(descriptor, min(_CHUNK, count - len(found)))
        if not data:
            return None
        found += data
    return bytes(found)


def _send(descriptor, message):
    body = json.dumps(message, ensure_ascii=True, allow_nan=False, separators=(",", ":")).encode("ascii")
    data = memoryview(_LENGTH.pack(len(body)) + body)
    while data:
        data = data[os.write(descriptor, data) :]


def _answer(message, jobs):
    from refusal import Refused

    try:
        module, function = jobs[message["job"]]
        return {"value": getattr(importlib.import_module(module), function)(**message["arguments"])}
    except Refused as error:
        return {"refused": str(error)}
    except ModuleNotFoundError as error:
        return {"unable": f"This Blender's Python has no {error.name}, which the audit needs"}
    except MemoryError:
        return {"refused": "it needs more memory than it may have"}
    except Exception as error:
        # A file can be strange in ways that nobody has thought of; that is no reason to say nothing.
        return {"failed": f"{type(error).__name__}: {error}"}


def serve(descriptor, jobs):
    """Answers ``jobs`` until the other end is closed.

    Blender that has run a fluid aborts when it ends in the usual way.
    """
    import mantaflow

    mantaflow.mend()
    while (message := _receive(descriptor)) is not None:
        _send(descriptor, _answer(message, jobs))
    sys.stdout.flush()
    os._exit(0)


if __name__ == "__main__":
    serve(int(sys.argv[-1]), JOBS)
