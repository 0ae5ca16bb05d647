"""Confines its own process, then becomes the given command. A script that uses only the standard library.

``python -I -S confine_self.py JSON -- COMMAND …``. JSON is the object that ``Sandbox.command`` makes: see ``main``.
Afterwards, on Linux, the command and whatever it becomes end with the parent; they have no capability, no socket, no
second process, no signal to others, and cannot change their limits. On other systems only the limits hold.
"""

from __future__ import annotations

import ctypes
import json
import os
import resource
import signal
import struct
import sys

MACHINES = ("x86_64", "aarch64")
LAST_FILTER = "SIMWORLDS_LAST_FILTER"
"""The variable that hands the second filter of system calls to inside/boot.py."""

_OPEN_FILES = 4096  # few enough to be looked through often (see nameless_files.py)
_LIBC = ctypes.CDLL(None, use_errno=True)

# prctl
_SET_PDEATHSIG, _SET_SECCOMP, _CAPBSET_DROP, _SET_NO_NEW_PRIVS = 1, 22, 24, 38
_SECCOMP_MODE_FILTER = 2
_LAST_CAPABILITY = 63
_CAPABILITY_VERSION = 0x20080522

# Landlock: the same system call numbers on every machine.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_FILE_RIGHTS = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 14 | 1 << 15  # execute, write, read, truncate, ioctl
_READING = 1 << 0 | 1 << 2 | 1 << 3  # execute, read a file, list a folder
_RIGHTS_BY_ABI = ((1, 13), (2, 14), (3, 15), (5, 16))  # ABI → how many file rights it knows
_TCP_SINCE, _TCP = 4, 0b11  # bind, connect
_SCOPES_SINCE, _ABSTRACT_SOCKETS, _SIGNALS = 6, 1, 2


class CannotConfine(Exception):  # noqa: N818 - reads as the state it names
    """The process could not be confined."""


def landlock_abi() -> int:
    """The kernel's Landlock version; 0 if it has none."""
    if sys.platform != "linux":
        return 0
    return max(0, _LIBC.syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), 1))


def has_seccomp() -> bool:
    """Whether system calls can be closed on this machine: Linux with known call numbers."""
    return sys.platform == "linux" and os.uname().machine in MACHINES


def _checked(result: int, what: str) -> int:
    if result < 0:
        raise CannotConfine(f"{what}: {os.strerror(ctypes.get_errno())}")
    return result


def limit(memory: int, file_size: int) -> None:
    """Limits this process: bytes of private memory and of one file, open files, no core dumps.

    Calls beyond them fail.
    """
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for which, amount in (
        (resource.RLIMIT_DATA, memory),
        (resource.RLIMIT_FSIZE, file_size),
        (resource.RLIMIT_NOFILE, _OPEN_FILES),
    ):
        if amount:
            hard = resource.getrlimit(which)[1]
            least = amount if hard == resource.RLIM_INFINITY else min(amount, hard)
            resource.setrlimit(which, (least, least))
    # Writing beyond the limit is an error of the call, in C too, instead of a signal.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


def become(user: int, groups: list[int]) -> None:
    """Gives up being root for good: this process belongs to ``user`` and ``groups`` from here on."""
    os.setgroups(groups)
    os.setresgid(user, user, user)
    os.setresuid(user, user, user)


def end_with_parent() -> None:
    """Makes this process end with the thread that started it. A change of user would undo it."""
    _checked(_LIBC.prctl(_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0), "parent's death")


def bound_capabilities() -> None:
    """No program that this process becomes can get a capability. Works as far as this process may say so."""
    _checked(_LIBC.prctl(_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "no_new_privs")
    for capability in range(_LAST_CAPABILITY + 1):
        _LIBC.prctl(_CAPBSET_DROP, capability, 0, 0, 0)


def drop_capabilities() -> None:
    """Gives up all capabilities for good."""
    _checked(_LIBC.capset(struct.pack("Ii", _CAPABILITY_VERSION, 0), bytes(24)), "capset")


def close_files(read: list[str], write: list[str], without: list[str]) -> None:
    """Closes the file system with Landlock: only ``read`` and ``write`` can be read, only ``write`` written.

    ``without``: see ``main``. Raises CannotConfine.
    """
    abi = landlock_abi()
    if not abi:
        raise CannotConfine("this kernel has no Landlock")
    known = max(count for version, count in _RIGHTS_BY_ABI if abi >= version)
    every = 0 if "files" in without else (1 << known) - 1
    network = 0 if "sockets" in without or abi < _TCP_SINCE else _TCP
    scopes = (0 if "sockets" in without else _ABSTRACT_SOCKETS) | (0 if "signals" in without else _SIGNALS)
    scopes = 0 if abi < _SCOPES_SINCE else scopes
    if not (every or network or scopes):
        return
    attributes = struct.pack("QQQ", every, network, scopes)
    size = 8 if abi < _TCP_SINCE else 16 if abi < _SCOPES_SINCE else 24
    ruleset = _checked(
        _LIBC.syscall(_CREATE_RULESET, attributes, ctypes.c_size_t(size), 0), "landlock_create_ruleset"
    )
    for paths, rights in ((read, _READING & every), (write, every)):
        for path in paths if rights else ():
            _allow(ruleset, path, rights)
    _checked(_LIBC.syscall(_RESTRICT_SELF, ruleset, 0), "landlock_restrict_self")
    os.close(ruleset)


def _allow(ruleset: int, path: str, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return  # a missing path needs no rule
    if not os.path.isdir(path):  # noqa: PTH112 - pathlib costs more than it gives here
        rights &= _FILE_RIGHTS
    rule = struct.pack("=Qi", rights, place)
    _checked(_LIBC.syscall(_ADD_RULE, ruleset, 1, rule, 0), f"landlock_add_rule {path}")
    os.close(place)


def close_calls(program: bytes, hole: int) -> None:
    """Closes system calls with a filter. ``hole`` stands in it for the number of this process. Raises CannotConfine."""
    own = struct.pack("I", os.getpid())
    program = program.replace(struct.pack("I", hole), own)
    steps = ctypes.create_string_buffer(program, len(program))
    described = struct.pack("HxxxxxxQ", len(program) // 8, ctypes.addressof(steps))
    _checked(_LIBC.prctl(_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "no_new_privs")
    _checked(_LIBC.prctl(_SET_SECCOMP, _SECCOMP_MODE_FILTER, described, 0, 0), "seccomp")


def main(words: list[str]) -> None:
    """Confines this process, then replaces it by the command after ``--``.

    The first word is a JSON object: ``memory`` and ``file_size`` (bytes, 0: no limit); ``user`` to become and its
    ``groups`` (null: stay the same); ``read`` and ``write`` (paths), where Landlock closes the file system; ``calls``
    (the filter of system calls in hexadecimal, "": none), the ``hole`` in it, and ``last`` (what boot.py needs to
    install the second one); ``without`` (names of walls that are down).
    """
    rights, command = json.loads(words[0]), words[2:]
    without: list[str] = rights.get("without", [])
    limit(rights["memory"], rights["file_size"])
    if sys.platform == "linux":
        if "capabilities" not in without:
            bound_capabilities()
        if rights.get("user") is not None:
            become(rights["user"], rights["groups"])
        end_with_parent()
        if "capabilities" not in without:
            drop_capabilities()
        if "write" in rights:
            close_files(rights["read"], rights["write"], without)
        if rights.get("calls"):
            close_calls(bytes.fromhex(rights["calls"]), rights["hole"])
            os.environ[LAST_FILTER] = rights["last"]
    os.execv(command[0], command)  # noqa: S606 - the point of it


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (CannotConfine, OSError, ValueError) as fault:
        sys.stderr.write(f"Blender cannot be confined: {fault}\n")
        sys.exit(126)
