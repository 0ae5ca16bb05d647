# SPDX-License-Identifier: GPL-3.0-or-later
"""What the code of every attack begins with: system calls that raise, threads that last, and races."""

import contextlib
import ctypes
import errno
import os
import struct  # noqa: F401 - for the attacks
import sys
import threading
import time  # noqa: F401 - for the attacks
from types import SimpleNamespace

target = SimpleNamespace()  # what is attacked; filled in by what sends the code
libc = ctypes.CDLL(None, use_errno=True)
libc.syscall.restype = ctypes.c_long
# What a wall answers. Any other error means that the attack itself is wrong.
DENIED = {
    *(errno.EPERM, errno.EACCES, errno.ENOSYS, errno.EROFS, errno.ENOENT, errno.ESRCH, errno.ENOTSUP),
    *(errno.EXDEV, errno.ENOTDIR, errno.ENXIO, errno.EAFNOSUPPORT, errno.EPROTONOSUPPORT, errno.ELOOP),
    *(
        errno.ECONNREFUSED,
        errno.ENETUNREACH,
        errno.EMFILE,
        errno.ENOMEM,
        errno.ENOSPC,
        errno.EFBIG,
        errno.EDQUOT,
    ),
}


def raw(*arguments):
    """Arguments as the C library takes them: numbers are 64 bits wide."""
    return [ctypes.c_long(value) if isinstance(value, int) else value for value in arguments]


def syscall(number, *arguments):
    """A system call by its number on x86_64. Raises OSError."""
    ctypes.set_errno(0)
    result = libc.syscall(*raw(number, *arguments))
    if result == -1:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def c(name, *arguments):
    """A function of the C library that gives -1 for an error. Raises OSError."""
    ctypes.set_errno(0)
    result = getattr(libc, name)(*raw(*arguments))
    if result == -1:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return result


def worked(act, *arguments, **named):
    """Whether something works; what a wall answers is no."""
    try:
        return act(*arguments, **named) or True
    except OSError as error:
        if error.errno not in DENIED:
            raise
        return None


def reaches(number, *arguments):
    """Whether a system call gets as far as the kernel's own checks of its arguments."""
    try:
        syscall(number, *arguments)
    except OSError as error:
        return error.errno not in DENIED
    return True


def read(path, size=4096):
    """The beginning of a file."""
    with open(path, "rb") as file:
        return file.read(size)


def write(path, data=b"overwritten by an attack"):
    """Writes over a file; True."""
    with open(path, "wb") as file:
        file.write(data)
    return True


def rewrite(path):
    """Writes to a file of the kernel what it holds; True."""
    with open(path, "rb") as file:
        data = file.read(4096)
    number = os.open(path, os.O_WRONLY)
    try:
        return os.write(number, data) > 0
    finally:
        os.close(number)


def name_thread():
    """Gives this thread the name by which it is found from outside."""
    libc.prctl(15, target.mark.encode(), 0, 0, 0)


def in_background(act):
    """Runs ``act`` again and again in a thread that never ends."""

    def run():
        name_thread()
        while True:
            with contextlib.suppress(Exception):
                act()

    threading.Thread(target=run, daemon=True).start()


def worker(name):
    """A module of the worker's own package."""
    return next(module for full, module in sys.modules.items() if full.endswith("worker." + name))


def blind():
    """Replaces what counts the threads that a call leaves behind."""
    state = worker("interpreter_state")

    def zero(*_):
        return 0

    for name in ("_left_threads", "_running", "_let_threads_start"):
        if hasattr(state.InterpreterState, name):
            getattr(state.InterpreterState, name).__code__ = zero.__code__


def replies_of(module, function, source):
    """Replaces the code of a tool's function: ``source`` is the body of a function of ``arguments, report``."""
    namespace = dict(globals())
    body = "\n".join("    " + line for line in source.splitlines())
    exec("def forged(arguments, report):\n" + body, namespace)
    import importlib

    loaded = importlib.import_module(worker("worker").__package__ + "." + module)
    sys.modules["forged_replies"] = SimpleNamespace(forged=namespace["forged"])

    def call(arguments, report):
        import sys

        return sys.modules["forged_replies"].forged(arguments, report)

    getattr(loaded, function).__code__ = call.__code__
