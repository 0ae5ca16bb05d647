"""Confines its own process, then becomes the given command. A script that uses only the standard library.

``python -I -S confine_self.py JSON -- COMMAND …``. JSON holds ``memory`` and ``file_size`` (bytes, 0: no limit) and,
where Landlock closes the file system, ``read`` and ``write`` (paths). Afterwards, on Linux, the command and whatever
it becomes end with the parent and are killed first when memory runs out; they have no capability, no socket, no second
process, no signal to others, and cannot change their limits. On other systems only the limits hold.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import resource
import signal
import struct
import sys

_LIBC = ctypes.CDLL(None, use_errno=True)

# prctl
_SET_PDEATHSIG, _SET_DUMPABLE, _SET_SECCOMP, _CAPBSET_DROP, _SET_NO_NEW_PRIVS = 1, 4, 22, 24, 38
_SECCOMP_MODE_FILTER = 2
_LAST_CAPABILITY = 63
_CAPABILITY_VERSION = 0x20080522

# Seccomp's programs are classic BPF: (code, jump if true, jump if false, constant).
_LOAD, _AND, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x54, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL = 0x7FFF0000, 0x80000000
_REFUSE, _UNKNOWN, _PRETEND = (0x00050000 | number for number in (1, 38, 0))  # EPERM, ENOSYS, success
_NUMBER_AT, _ARCHITECTURE_AT = 0, 4
_X32 = 0x40000000
_CLONE_THREAD = 0x10000
_TRUNCATING, _ACCESS = 0o1000, 0o3

ARCHITECTURES = {
    "x86_64": (0, 0xC000003E),
    "aarch64": (1, 0xC00000B7),
}  # column in NUMBERS, seccomp's own number

# System call → its number on x86_64 and aarch64; None if it does not exist there.
NUMBERS: dict[str, tuple[int | None, int | None]] = {
    # further processes
    "fork": (57, None),
    "vfork": (58, None),
    "clone": (56, 220),
    "clone3": (435, 435),
    "unshare": (272, 97),
    "setns": (308, 268),
    # other processes
    "kill": (62, 129),
    "tgkill": (234, 131),
    "tkill": (200, 130),
    "rt_sigqueueinfo": (129, 138),
    "rt_tgsigqueueinfo": (297, 240),
    "pidfd_send_signal": (424, 424),
    "pidfd_getfd": (438, 438),
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "process_madvise": (440, 440),
    "kcmp": (312, 272),
    "move_pages": (279, 239),
    "migrate_pages": (256, 238),
    "setpriority": (141, 140),
    "ioprio_set": (251, 30),
    "sched_setparam": (142, 118),
    "sched_setscheduler": (144, 119),
    "sched_setattr": (314, 274),
    "sched_setaffinity": (203, 122),
    "inotify_add_watch": (254, 27),
    # what outlives the process, or reaches out of it
    "socket": (41, 198),
    "shmget": (29, 194),
    "semget": (64, 190),
    "msgget": (68, 186),
    "mq_open": (240, 180),
    "mount": (165, 40),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "keyctl": (250, 219),
    # the kernel's insides; io_uring could do what is refused here
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "userfaultfd": (323, 282),
    "io_uring_setup": (425, 425),
    # its own limits
    "setrlimit": (160, 164),
    "prlimit64": (302, 261),
    "seccomp": (317, 277),
    "prctl": (157, 167),
    "fcntl": (72, 25),
    "ioctl": (16, 29),
    # files, where Landlock does not look
    "truncate": (76, 45),
    "open": (2, None),
    "openat": (257, 56),
    "openat2": (437, 437),
    "chown": (92, None),
    "lchown": (94, None),
    "fchown": (93, 55),
    "fchownat": (260, 54),
    "setxattr": (188, 5),
    "lsetxattr": (189, 6),
    "fsetxattr": (190, 7),
    "removexattr": (197, 14),
    "lremovexattr": (198, 15),
    "fremovexattr": (199, 16),
    "setxattrat": (463, 463),
    "removexattrat": (466, 466),
    "file_setattr": (469, 469),
    "chmod": (90, None),
    "fchmod": (91, 52),
    "fchmodat": (268, 53),
    "fchmodat2": (452, 452),
    "utime": (132, None),
    "utimes": (235, None),
    "futimesat": (261, None),
    "utimensat": (280, 88),
}
_REFUSED = """
    fork vfork unshare setns tkill rt_sigqueueinfo rt_tgsigqueueinfo pidfd_send_signal pidfd_getfd
    ptrace process_vm_readv process_vm_writev process_madvise kcmp move_pages migrate_pages setpriority
    ioprio_set sched_setparam sched_setscheduler sched_setattr inotify_add_watch socket shmget semget
    msgget mq_open mount add_key request_key keyctl bpf perf_event_open userfaultfd io_uring_setup
    setrlimit seccomp
""".split()  # noqa: SIM905 - one name a line would hide the list
# Landlock does not cover owners, modes, times and attributes or, before Linux 6.2, truncation. Copying a file also sets
# its mode and times: those calls report success and change nothing.
_REFUSED_FILES = """
    truncate chown lchown fchown fchownat setxattr lsetxattr fsetxattr removexattr lremovexattr
    fremovexattr setxattrat removexattrat file_setattr
""".split()  # noqa: SIM905
_PRETENDED_FILES = ("chmod", "fchmod", "fchmodat", "fchmodat2", "utime", "utimes", "futimesat", "utimensat")
# (call, argument, refused values): redirecting a descriptor's signals; typing into a terminal.
_REFUSED_VALUES = (
    ("prctl", 0, (_SET_PDEATHSIG, _SET_DUMPABLE, _SET_SECCOMP)),
    ("fcntl", 1, (8, 15)),
    ("ioctl", 1, (0x8901, 0x8902, 0x5412)),
)

# Landlock: the same system call numbers on every machine.
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_FILE_RIGHTS = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 14 | 1 << 15  # execute, write, read, truncate, ioctl
_READING = 1 << 0 | 1 << 2 | 1 << 3  # execute, read a file, list a folder
_RIGHTS_BY_ABI = ((1, 13), (2, 14), (3, 15), (5, 16))  # ABI → how many file rights it knows


class CannotConfine(Exception):  # noqa: N818 - reads as the state it names
    """The process could not be confined."""


def landlock_abi() -> int:
    """The kernel's Landlock version; 0 if it has none."""
    if sys.platform != "linux":
        return 0
    return max(0, _LIBC.syscall(_CREATE_RULESET, None, ctypes.c_size_t(0), 1))


def has_seccomp() -> bool:
    """Whether system calls can be closed on this machine: Linux with known call numbers."""
    return sys.platform == "linux" and os.uname().machine in ARCHITECTURES


def _checked(result: int, what: str) -> int:
    if result < 0:
        raise CannotConfine(f"{what}: {os.strerror(ctypes.get_errno())}")
    return result


def limit(memory: int, file_size: int) -> None:
    """Limits this process: bytes of private memory and of one file, no core dumps. Calls beyond them fail."""
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    for which, amount in ((resource.RLIMIT_DATA, memory), (resource.RLIMIT_FSIZE, file_size)):
        if amount:
            hard = resource.getrlimit(which)[1]
            least = amount if hard == resource.RLIM_INFINITY else min(amount, hard)
            resource.setrlimit(which, (least, least))
    # Writing beyond the limit is an error of the call, in C too, instead of a signal.
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)


def end_early() -> None:
    """Makes this process end with the thread that started it, and be the first that is killed for memory."""
    _checked(_LIBC.prctl(_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0), "parent's death")
    with contextlib.suppress(OSError), open("/proc/self/oom_score_adj", "w") as file:  # noqa: PTH123
        file.write("1000")


def drop_capabilities() -> None:
    """Gives up all capabilities for good."""
    _checked(_LIBC.prctl(_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "no_new_privs")
    for capability in range(_LAST_CAPABILITY + 1):
        _LIBC.prctl(_CAPBSET_DROP, capability, 0, 0, 0)
    _checked(_LIBC.capset(struct.pack("Ii", _CAPABILITY_VERSION, 0), bytes(24)), "capset")


def close_files(read: list[str], write: list[str]) -> None:
    """Closes the file system with Landlock: only ``read`` and ``write`` can be read, only ``write`` written.

    Raises CannotConfine.
    """
    abi = landlock_abi()
    if not abi:
        raise CannotConfine("this kernel has no Landlock")
    known = max(count for version, count in _RIGHTS_BY_ABI if abi >= version)
    every = (1 << known) - 1
    attributes = struct.pack("QQQ", every, 0b11 if abi >= 4 else 0, 0b11 if abi >= 6 else 0)
    size = 8 if abi < 4 else 16 if abi < 6 else 24
    ruleset = _checked(
        _LIBC.syscall(_CREATE_RULESET, attributes, ctypes.c_size_t(size), 0), "landlock_create_ruleset"
    )
    for paths, rights in ((read, _READING), (write, every)):
        for path in paths:
            _allow(ruleset, path, rights & every)
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


def _step(code: int, constant: int, yes: int = 0, no: int = 0) -> bytes:
    return struct.pack("HBBI", code, yes, no, constant)


def _argument(index: int, *, high: bool = False) -> bytes:
    """Loads the low or high half of an argument; both architectures put the low half first."""
    return _step(_LOAD, 16 + 8 * index + 4 * high)


def filter_program(machine: str, own: int, *, files: bool) -> bytes:
    """The seccomp filter: what happens on each system call. ``own`` is this process.

    ``files``: also close what Landlock leaves open. Raises KeyError for an unknown machine.
    """
    column, architecture = ARCHITECTURES[machine]
    load_number = _step(_LOAD, _NUMBER_AT)
    steps = [
        _step(_LOAD, _ARCHITECTURE_AT),
        _step(_EQUAL, architecture, 1, 0),
        _step(_RETURN, _KILL),
        load_number,
        _step(_AT_LEAST, _X32, 0, 1),
        _step(_RETURN, _UNKNOWN),
    ]

    def rule(call: str, *answer: bytes) -> None:
        """``answer`` are steps that end with a return; else the next rule goes on."""
        number = NUMBERS[call][column]
        if number is not None:
            steps.extend((load_number, _step(_EQUAL, number, 0, len(answer)), *answer))

    refuse = _step(_RETURN, _REFUSE)
    for call in _REFUSED:
        rule(call, refuse)
    # The C library falls back to clone, whose flags can be checked.
    rule("clone3", _step(_RETURN, _UNKNOWN))
    rule("clone", _argument(0), _step(_ANY_BIT, _CLONE_THREAD, 1, 0), refuse)
    for call in ("kill", "tgkill"):
        rule(call, _argument(0), _step(_EQUAL, own, 1, 0), refuse)
    # Limits of any process can be read, but none set.
    rule(
        *("prlimit64", _argument(2), _step(_EQUAL, 0, 1, 0), refuse),
        *(_argument(2, high=True), _step(_EQUAL, 0, 1, 0), refuse),
    )
    for call, index, values in _REFUSED_VALUES:
        for value in values:
            rule(call, _argument(index), _step(_EQUAL, value, 0, 1), refuse)
    if files:
        for call in _REFUSED_FILES:
            rule(call, refuse)
        for call in _PRETENDED_FILES:
            rule(call, _step(_RETURN, _PRETEND))
        # Opening only for reading can truncate a file.
        for call, index in (("open", 1), ("openat", 2)):
            only_cut = (_step(_AND, _TRUNCATING | _ACCESS), _step(_EQUAL, _TRUNCATING, 0, 1))
            rule(call, _argument(index), *only_cut, refuse)
        rule("openat2", _step(_RETURN, _UNKNOWN))
        # With bubblewrap there is no other process whose CPU affinity could be set.
        rule("sched_setaffinity", _argument(0), _step(_EQUAL, 0, 1, 0), refuse)
    steps.append(_step(_RETURN, _ALLOW))
    return b"".join(steps)


def close_calls(*, files: bool) -> None:
    """Closes system calls with seccomp; ``files``: see filter_program. Raises CannotConfine."""
    program = ctypes.create_string_buffer(filter_program(os.uname().machine, os.getpid(), files=files))
    described = struct.pack("HxxxxxxQ", (len(program) - 1) // 8, ctypes.addressof(program))
    _checked(_LIBC.prctl(_SET_NO_NEW_PRIVS, 1, 0, 0, 0), "no_new_privs")
    _checked(_LIBC.prctl(_SET_SECCOMP, _SECCOMP_MODE_FILTER, described, 0, 0), "seccomp")


def main(words: list[str]) -> None:
    """Confines this process, then replaces it by the command after ``--``."""
    rights, command = json.loads(words[0]), words[2:]
    limit(rights["memory"], rights["file_size"])
    if sys.platform == "linux":
        end_early()
        drop_capabilities()
        if "write" in rights:
            close_files(rights["read"], rights["write"])
        if has_seccomp():
            close_calls(files="write" in rights)
    os.execv(command[0], command)  # noqa: S606 - the point of it


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (CannotConfine, OSError, ValueError) as fault:
        sys.stderr.write(f"Blender cannot be confined: {fault}\n")
        sys.exit(126)
