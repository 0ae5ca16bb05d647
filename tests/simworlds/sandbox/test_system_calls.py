"""What the filters of system calls answer, call by call."""

from __future__ import annotations

import os
import platform
import signal
import struct
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from simworlds.sandbox.confinement.confine_self import MACHINES
from simworlds.sandbox.confinement.system_call_numbers import ARCHITECTURES, NEWEST, NUMBERS
from simworlds.sandbox.confinement.system_calls import OWN_PROCESS, first_filter, installing_call, last_filter

OWN = OWN_PROCESS
ALLOWED, REFUSED, UNKNOWN, PRETENDED, KILLED = "allowed", "EPERM", "ENOSYS", "nothing", "killed"
NO_LINK, UNSUPPORTED, NO_SOCKET = "EINVAL", "ENOTSUP", "ENOTSOCK"
ANSWERS = {
    0x7FFF0000: ALLOWED,
    0x00050001: REFUSED,
    0x00050016: NO_LINK,
    0x00050026: UNKNOWN,
    0x00050058: NO_SOCKET,
    0x0005005F: UNSUPPORTED,
    0x00050000: PRETENDED,
    0x80000000: KILLED,
}
if TYPE_CHECKING:
    from simworlds.sandbox.confinement.walls import Wall

linux = pytest.mark.skipif(sys.platform != "linux", reason="Linux confines this way")


def answer(
    machine: str,
    call: str | int,
    *arguments: int,
    files: bool = True,
    architecture: int | None = None,
    last: bool = False,
    without: frozenset[Wall] = frozenset(),
) -> str:
    """What the first or the last filter says, found by running it as the kernel does."""
    column, own_architecture = ARCHITECTURES[machine]
    number = NUMBERS[call][column] if isinstance(call, str) else call
    assert number is not None
    given = [value & (1 << 64) - 1 for value in (*arguments, 0, 0, 0, 0, 0, 0)[:6]]
    data = struct.pack(
        "<iIQ6Q", number, own_architecture if architecture is None else architecture, 0, *given
    )
    program = (last_filter if last else first_filter)(machine, files=files, without=without)
    steps = [struct.unpack_from("HBBI", program, place) for place in range(0, len(program), 8)]
    place = held = 0
    while True:
        code, yes, no, constant = steps[place]
        place += 1
        match code:
            case 0x20:
                (held,) = struct.unpack_from("<I", data, constant)
            case 0x54:
                held &= constant
            case 0x15:
                place += yes if held == constant else no
            case 0x35:
                place += yes if held >= constant else no
            case 0x45:
                place += yes if held & constant else no
            case 0x06:
                return ANSWERS[constant]
            case _:
                raise AssertionError(f"no such step: {code:#x}")


# Wall → calls that a worker has no use for.
CLOSED = {
    "sockets": "socket socketpair",
    "signals": """
        tkill rt_sigqueueinfo rt_tgsigqueueinfo pidfd_open pidfd_send_signal pidfd_getfd ptrace process_vm_readv
        process_vm_writev setpriority""",
    "namespaces": "unshare setns shmget shmat semget msgget mq_open",
    "kernel": """
        mount umount2 pivot_root chroot fsopen open_tree move_mount mount_setattr fanotify_init add_key keyctl bpf
        perf_event_open userfaultfd io_uring_setup io_uring_enter name_to_handle_at open_by_handle_at reboot
        finit_module kexec_file_load swapon acct clock_settime sethostname syslog quotactl""",
    "limits": "setrlimit",
}


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(("wall", "call"), [(wall, call) for wall in CLOSED for call in CLOSED[wall].split()])
def test_refuses_what_reaches_out_of_the_process(machine: str, wall: Wall, call: str) -> None:
    assert answer(machine, call, files=False) == answer(machine, call, files=True) == REFUSED
    assert answer(machine, call, without=frozenset({wall})) == ALLOWED


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(
    "call", ["bind", "connect", "listen", "accept", "sendto", "sendmsg", "recvfrom", "recvmsg", "shutdown"]
)
def test_every_descriptor_seems_to_be_no_socket(machine: str, call: str) -> None:
    assert answer(machine, call, 3) == NO_SOCKET
    assert answer(machine, call, 3, without=frozenset({"sockets"})) == ALLOWED


@pytest.mark.parametrize("machine", MACHINES)
def test_files_in_memory_seem_unknown_to_the_kernel(machine: str) -> None:
    for call in ("memfd_create", "memfd_secret"):
        assert answer(machine, call) == UNKNOWN
        assert answer(machine, call, without=frozenset({"memfd"})) == ALLOWED


@pytest.mark.parametrize("machine", MACHINES)
def test_programs_can_be_started_until_the_last_filter(machine: str) -> None:
    for call in ("execve", "execveat"):
        assert answer(machine, call) == ALLOWED
        assert answer(machine, call, last=True) == REFUSED
        assert answer(machine, call, last=True, without=frozenset({"processes"})) == ALLOWED
    assert (answer(machine, "seccomp"), answer(machine, "seccomp", last=True)) == (ALLOWED, REFUSED)
    assert installing_call(machine) == NUMBERS["seccomp"][ARCHITECTURES[machine][0]]


@pytest.mark.parametrize("machine", MACHINES)
def test_calls_that_are_newer_than_the_table_seem_unknown(machine: str) -> None:
    assert answer(machine, NEWEST + 1) == UNKNOWN
    assert max(number or 0 for numbers in NUMBERS.values() for number in numbers) <= NEWEST


@pytest.mark.parametrize("machine", MACHINES)
def test_the_execution_domain_can_be_asked_for_but_not_changed(machine: str) -> None:
    assert answer(machine, "personality", 0xFFFFFFFF) == ALLOWED
    assert answer(machine, "personality", 0x0400000) == REFUSED  # memory that is read is executable


@pytest.mark.parametrize("machine", MACHINES)
def test_the_hole_for_the_own_process_occurs_nowhere_else(machine: str) -> None:
    hole = struct.pack("I", OWN)
    for files in (False, True):
        assert first_filter(machine, files=files).count(hole) == 2  # kill, tgkill
        assert hole not in last_filter(machine, files=files)


@pytest.mark.parametrize("machine", MACHINES)
def test_threads_can_be_started_but_no_processes(machine: str) -> None:
    thread, process = 0x3D0F00, signal.SIGCHLD
    assert answer(machine, "clone", thread) == ALLOWED
    assert answer(machine, "clone", process) == REFUSED
    assert answer(machine, "clone", thread & ~0x400) == REFUSED  # a table of open files that nobody sees
    assert answer(machine, "clone", thread | 0x40000000) == REFUSED  # a network namespace of its own
    assert answer(machine, "clone", 0x10000000 | process) == REFUSED  # a user namespace of its own
    assert answer(machine, "clone3") == UNKNOWN


def test_the_older_ways_to_start_a_process_are_refused() -> None:
    assert answer("x86_64", "fork") == REFUSED
    assert answer("x86_64", "vfork") == REFUSED


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("call", ["kill", "tgkill"])
def test_signals_reach_the_process_itself_alone(machine: str, call: str) -> None:
    assert answer(machine, call, OWN, signal.SIGABRT) == ALLOWED
    assert [answer(machine, call, other, 9) for other in (1, 0, -1, -OWN)] == [REFUSED] * 4


@pytest.mark.parametrize("machine", MACHINES)
def test_limits_can_be_read_but_not_set(machine: str) -> None:
    assert answer(machine, "prlimit64", 0, 7, 0) == ALLOWED
    assert answer(machine, "prlimit64", 0, 7, 0x7FFF1234) == REFUSED
    assert answer(machine, "prlimit64", 0, 7, 0x100000000) == REFUSED  # an address whose low half is 0


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(
    ("call", "harmless", "harmful"),
    [
        ("prctl", (15,), (1, 0)),
        ("prctl", (16,), (4, 0)),
        ("fcntl", (3, 1), (3, 8)),
        ("fcntl", (3, 4), (3, 15)),
        ("ioctl", (3, 0x5413), (3, 0x5412)),
        ("ioctl", (3, 0x5421), (3, 0x8901)),
        ("prctl", (15,), (0x59616D61, -1)),
        ("prctl", (15,), (22, 2)),
        ("fcntl", (3, 2), (3, 1024)),
    ],
)
def test_refuses_dangerous_arguments_of_allowed_calls(
    machine: str, call: str, harmless: tuple[int, ...], harmful: tuple[int, ...]
) -> None:
    assert answer(machine, call, *harmless) == ALLOWED
    assert answer(machine, call, *harmful) == REFUSED


@pytest.mark.parametrize("machine", MACHINES)
def test_closes_what_landlock_leaves_open_only_with_landlock(machine: str) -> None:
    for call, beside_landlock in (
        ("truncate", REFUSED),
        ("fchownat", REFUSED),
        ("setxattr", REFUSED),
        ("fchmodat", PRETENDED),
        ("utimensat", PRETENDED),
        ("getxattr", UNSUPPORTED),
        ("flistxattr", UNSUPPORTED),
    ):
        assert answer(machine, call, files=True) == beside_landlock
        assert answer(machine, call, files=False) == ALLOWED
    for flags, told in (
        (os.O_RDONLY, ALLOWED),
        (os.O_WRONLY | os.O_TRUNC, ALLOWED),
        (os.O_RDONLY | os.O_TRUNC, REFUSED),
        (os.O_RDONLY | os.O_TRUNC | os.O_CLOEXEC, REFUSED),
    ):
        assert answer(machine, "openat", 0, 0, flags, files=True) == told
    assert answer(machine, "openat2", files=False) == answer(machine, "openat2", files=True) == UNKNOWN
    assert answer(machine, "sched_setaffinity", 0) == ALLOWED
    assert answer(machine, "sched_setaffinity", OWN + 1) == REFUSED
    assert answer(machine, "readlinkat", last=True) == NO_LINK
    assert answer(machine, "readlinkat", last=True, files=False) == ALLOWED
    assert answer(machine, "getxattr", without=frozenset({"attributes"})) == ALLOWED


@pytest.mark.parametrize("machine", MACHINES)
def test_calls_by_another_architectures_numbers_are_not_answered(machine: str) -> None:
    assert answer(machine, 1, architecture=0x40000003) == KILLED
    assert answer(machine, 0x40000000 | 41) == UNKNOWN


@pytest.mark.parametrize("column", [0, 1], ids=MACHINES[::-1])
@pytest.mark.parametrize(
    "numbers",
    [(0, 63), (1, 64), (9, 222), (59, 221), (202, 98), (231, 94)],
    ids=["read", "write", "mmap", "execve", "futex", "exit_group"],
)
def test_allows_ordinary_calls(column: int, numbers: tuple[int, int]) -> None:
    machine = next(name for name, row in ARCHITECTURES.items() if row[0] == column)
    assert answer(machine, numbers[column]) == ALLOWED


def test_call_numbers_are_unique() -> None:
    for column in (0, 1):
        numbers = [both[column] for both in NUMBERS.values() if both[column] is not None]
        assert len(numbers) == len(set(numbers))


@linux
@pytest.mark.skipif(platform.machine() != "x86_64", reason="the list is of x86_64")
def test_the_numbers_are_the_systems_own() -> None:
    listed = Path("/usr/include/x86_64-linux-gnu/asm/unistd_64.h")
    if not listed.is_file():
        pytest.skip("the C library's headers are not installed")
    system = dict(
        line.removeprefix("#define __NR_").split()
        for line in listed.read_text().splitlines()
        if " __NR_" in line
    )
    mine = {name: str(numbers[0]) for name, numbers in NUMBERS.items() if name in system}
    assert len(mine) > 50
    assert mine == {name: system[name] for name in mine}


@pytest.mark.parametrize("machine", ARCHITECTURES)
@pytest.mark.parametrize("files", [True, False])
def test_nothing_is_made_that_runs_as_its_owner(machine: str, files: bool) -> None:
    for mode, told in ((0o755, ALLOWED), (0o1777, ALLOWED), (0o4755, REFUSED), (0o2755, REFUSED)):
        assert answer(machine, "mkdirat", 0, 0, mode, files=files) == told
        assert answer(machine, "openat", 0, 0, os.O_WRONLY | os.O_CREAT, mode, files=files) == told
        # Without a new file, the mode is whatever was left in the register.
        assert answer(machine, "openat", 0, 0, os.O_WRONLY, mode, files=files) == ALLOWED
        if not files:
            assert answer(machine, "fchmodat", 0, 0, mode, files=files) == told
