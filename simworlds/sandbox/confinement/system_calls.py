"""The filters of system calls (seccomp): what Linux answers when executed code makes one.

Two filters stand behind each other. The first is there when Blender's program begins. The second is added in Blender
before any other code (see inside/boot.py), in all threads: from then on no program can be started.
"""

from __future__ import annotations

import struct
from functools import cache
from typing import TYPE_CHECKING

from simworlds.sandbox.confinement.system_call_numbers import ARCHITECTURES, NEWEST, NUMBERS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from simworlds.sandbox.confinement.walls import Wall

OWN_PROCESS = 0x5E1F5E1F
"""Stands in a filter for the number of the process itself, which the launcher fills in (see confine_self.py)."""

# A filter is a program of classic BPF: steps of (code, jump if true, jump if false, constant).
_LOAD, _AND, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x54, 0x15, 0x35, 0x45, 0x06
_ALLOW, _KILL, _ERROR = 0x7FFF0000, 0x80000000, 0x00050000
_EPERM, _EINVAL, _ENOSYS, _ENOTSOCK, _ENOTSUP, _SUCCESS = 1, 22, 38, 88, 95, 0
_NUMBER_AT, _ARCHITECTURE_AT, _ARGUMENTS_AT = 0, 4, 16
# clone: a thread shares memory, working folder and open files, so that all that it opens is seen from outside; and no
# namespace is its own
_VM, _FS, _FILES, _THREAD, _NAMESPACES = 0x100, 0x200, 0x400, 0x10000, 0x7E020080
_SHARED = _VM | _FS | _FILES | _THREAD
_TRUNCATING, _ACCESS = 0o1000, 0o3
_CREATING, _AS_OWNER = 0o100 | 0o20000000, 0o6000  # O_CREAT, O_TMPFILE; set-user-ID, set-group-ID

# Wall → the calls that it refuses, whatever their arguments.
_REFUSED: Mapping[Wall, str] = {
    "sockets": "socket socketpair",
    "processes": "fork vfork",
    "signals": """
        tkill rt_sigqueueinfo rt_tgsigqueueinfo pidfd_open pidfd_send_signal pidfd_getfd ptrace process_vm_readv
        process_vm_writev process_madvise process_mrelease kcmp move_pages migrate_pages setpriority ioprio_set
        sched_setparam sched_setscheduler sched_setattr inotify_add_watch""",
    "namespaces": """
        unshare setns shmget shmat shmctl semget semop semtimedop semctl msgget msgsnd msgrcv msgctl mq_open
        mq_unlink""",
    "kernel": """
        mount umount2 pivot_root chroot fsopen fsconfig fsmount fspick open_tree open_tree_attr move_mount
        mount_setattr statmount listmount fanotify_init fanotify_mark add_key request_key keyctl bpf
        perf_event_open userfaultfd io_uring_setup io_uring_enter io_uring_register name_to_handle_at
        open_by_handle_at swapon swapoff reboot kexec_load kexec_file_load init_module finit_module
        delete_module create_module query_module get_kernel_syms acct quotactl quotactl_fd modify_ldt iopl
        ioperm lookup_dcookie nfsservctl vhangup syslog settimeofday clock_settime clock_adjtime adjtimex
        sethostname setdomainname uselib sysfs _sysctl""",
    "limits": "setrlimit",
}
# What libraries try on a pipe before they read or write it as one.
_NOT_SOCKETS: Mapping[Wall, str] = {
    "sockets": """
        bind connect listen accept accept4 sendto sendmsg sendmmsg recvfrom recvmsg recvmmsg shutdown setsockopt
        getsockopt getsockname getpeername""",
}
# Mesa and libffi fall back to other memory when the kernel does not know these.
_UNKNOWN: Mapping[Wall, str] = {"memfd": "memfd_create memfd_secret"}

# Beside Landlock, which covers neither owners, modes, times and attributes nor, before Linux 6.2, truncation.
_REFUSED_FILES = """
    truncate chown lchown fchown fchownat setxattr lsetxattr fsetxattr removexattr lremovexattr
    fremovexattr setxattrat removexattrat file_setattr"""
# Copying a file also sets its mode and times: these calls report success and change nothing.
_PRETENDED_FILES = "chmod fchmod fchmodat fchmodat2 utime utimes futimesat utimensat"
# Copying a file also copies its attributes, if the file system has any.
_UNSUPPORTED_FILES = """
    getxattr lgetxattr fgetxattr listxattr llistxattr flistxattr getxattrat listxattrat file_getattr"""

# prctl
_PDEATHSIG, _DUMPABLE, _SECCOMP, _MEMORY_MAP, _PTRACER = 1, 4, 22, 35, 0x59616D61
# fcntl: who gets a descriptor's signals; leases, by which the opening of a file by others can be held up
_SETOWN, _SETOWN_EX, _SETLEASE, _NOTIFY = 8, 15, 1024, 1026
# ioctl: the same for sockets; typing into a terminal
_FIOSETOWN, _SIOCSPGRP, _TIOCSTI, _TIOCLINUX = 0x8901, 0x8902, 0x5412, 0x541C
# ioctl: flags and attributes of a file that may only be read, and sealing it for good
_FLAGS, _FLAGS_32, _EXTENDED, _VERITY = 0x40086602, 0x40046602, 0x401C5820, 0x40806685
_REFUSED_VALUES: Mapping[Wall, tuple[tuple[str, int, tuple[int, ...]], ...]] = {
    "files": (("ioctl", 1, (_FLAGS, _FLAGS_32, _EXTENDED, _VERITY)),),
    "signals": (
        ("prctl", 0, (_PDEATHSIG, _DUMPABLE, _SECCOMP, _MEMORY_MAP, _PTRACER)),
        ("fcntl", 1, (_SETOWN, _SETOWN_EX, _SETLEASE, _NOTIFY)),
        ("ioctl", 1, (_FIOSETOWN, _SIOCSPGRP, _TIOCSTI, _TIOCLINUX)),
    ),
}
# Call → the argument that holds the mode of what it makes or changes.
_MODES = {
    **{"chmod": 1, "fchmod": 1, "fchmodat": 2, "fchmodat2": 2},
    **{"creat": 1, "mkdir": 1, "mkdirat": 2, "mknod": 1, "mknodat": 2},
}
_QUERY_PERSONALITY = 0xFFFFFFFF


@cache
def first_filter(machine: str, *, files: bool, without: frozenset[Wall] = frozenset()) -> bytes:
    """The filter under which Blender's program starts, with a hole for its process (see OWN_PROCESS).

    ``files``: also close what Landlock leaves open. Raises KeyError for an unknown machine.
    """
    program = _Program(machine)
    for walls, error in ((_REFUSED, _EPERM), (_NOT_SOCKETS, _ENOTSOCK), (_UNKNOWN, _ENOSYS)):
        for wall, calls in walls.items():
            if wall not in without:
                program.refuse(calls, error)
    if files and "attributes" not in without:
        program.refuse(_UNSUPPORTED_FILES, _ENOTSUP)
    if "files" not in without:
        if files:
            _close_files(program)
        _close_modes(program)
    _close_by_arguments(program, without)
    if files and "signals" not in without:
        # With bubblewrap there is no other process whose CPU affinity could be set.
        program.rule("sched_setaffinity", _argument(0), _step(_EQUAL, 0, 1, 0), _error(_EPERM))
    return program.done()


def _close_files(program: _Program) -> None:
    program.refuse(_REFUSED_FILES, _EPERM)
    program.refuse(_PRETENDED_FILES, _SUCCESS)
    # Opening only for reading can truncate a file.
    for call, index in (("open", 1), ("openat", 2)):
        truncates = (_step(_AND, _TRUNCATING | _ACCESS), _step(_EQUAL, _TRUNCATING, 0, 1))
        program.rule(call, _argument(index), *truncates, _error(_EPERM))


def _close_modes(program: _Program) -> None:
    """No program is left behind that runs as its owner, whoever starts it later."""
    for call, index in _MODES.items():
        program.rule(call, _argument(index), _step(_ANY_BIT, _AS_OWNER, 0, 1), _error(_EPERM))
    for call, flags in (("open", 1), ("openat", 2)):
        # Without a new file the mode is whatever was left in the register.
        is_new = (_argument(flags), _step(_ANY_BIT, _CREATING, 0, 3))
        program.rule(call, *is_new, _argument(flags + 1), _step(_ANY_BIT, _AS_OWNER, 0, 1), _error(_EPERM))
    program.refuse("openat2", _ENOSYS)  # its flags and mode lie in memory


def _close_by_arguments(program: _Program, without: frozenset[Wall]) -> None:
    if "processes" not in without:
        # The C library falls back to clone, whose flags can be checked.
        program.refuse("clone3", _ENOSYS)
        is_thread = (_step(_AND, _SHARED | _NAMESPACES), _step(_EQUAL, _SHARED, 1, 0))
        program.rule("clone", _argument(0), *is_thread, _error(_EPERM))
    if "signals" not in without:
        for call in ("kill", "tgkill"):
            program.rule(call, _argument(0), _step(_EQUAL, OWN_PROCESS, 1, 0), _error(_EPERM))
    if "limits" not in without:
        # Limits of any process can be read, but none set.
        for high in (False, True):
            program.rule("prlimit64", _argument(2, high=high), _step(_EQUAL, 0, 1, 0), _error(_EPERM))
    if "kernel" not in without:
        program.rule("personality", _argument(0), _step(_EQUAL, _QUERY_PERSONALITY, 1, 0), _error(_EPERM))
    for wall, rules in _REFUSED_VALUES.items():
        for call, index, values in rules if wall not in without else ():
            for value in values:
                program.rule(call, _argument(index), _step(_EQUAL, value, 0, 1), _error(_EPERM))


@cache
def last_filter(machine: str, *, files: bool, without: frozenset[Wall] = frozenset()) -> bytes:
    """The filter that is added once Blender's Python runs; ``files``: see first_filter. Raises KeyError."""
    program = _Program(machine)
    if "processes" not in without:
        program.refuse("execve execveat", _EPERM)
    program.refuse("seccomp", _EPERM)
    if files and "attributes" not in without:
        # As for a path that is no link: the C library and Python take it as it is.
        program.refuse("readlink readlinkat", _EINVAL)
    return program.done()


def installing_call(machine: str) -> int:
    """The number of the call that adds a filter. Raises KeyError for an unknown machine."""
    number = NUMBERS["seccomp"][ARCHITECTURES[machine][0]]
    assert number is not None
    return number


class _Program:
    """A filter in the making. Calls of other architectures end the process; those newer than the table fail."""

    def __init__(self, machine: str) -> None:
        self._column, architecture = ARCHITECTURES[machine]
        self._steps = [
            _step(_LOAD, _ARCHITECTURE_AT),
            *(_step(_EQUAL, architecture, 1, 0), _step(_RETURN, _KILL)),
            _LOAD_NUMBER,
            *(_step(_AT_LEAST, NEWEST + 1, 0, 1), _error(_ENOSYS)),  # those of x32 too
        ]

    def refuse(self, calls: str, error: int) -> None:
        """Answers these calls with an error number."""
        for call in calls.split():
            if (number := NUMBERS[call][self._column]) is not None:
                self._steps += (_step(_EQUAL, number, 0, 1), _error(error))

    def rule(self, call: str, *steps: bytes) -> None:
        """On this call runs ``steps``, which end with a return; a jump over it goes on to the next rule."""
        if (number := NUMBERS[call][self._column]) is not None:
            self._steps += (_step(_EQUAL, number, 0, len(steps)), *steps, _LOAD_NUMBER)

    def done(self) -> bytes:
        return b"".join((*self._steps, _step(_RETURN, _ALLOW)))


def _step(code: int, constant: int, yes: int = 0, no: int = 0) -> bytes:
    return struct.pack("HBBI", code, yes, no, constant)


def _argument(index: int, *, high: bool = False) -> bytes:
    """Loads the low or high half of an argument; both architectures put the low half first."""
    return _step(_LOAD, _ARGUMENTS_AT + 8 * index + 4 * high)


def _error(number: int) -> bytes:
    return _step(_RETURN, _ERROR | number)


_LOAD_NUMBER = _step(_LOAD, _NUMBER_AT)
