"""Giving up rights: what the filter of system calls answers, call by call, and what a confined process can do."""

from __future__ import annotations

import json
import os
import platform
import signal
import struct
import subprocess
import sys
from pathlib import Path

import pytest

from simworlds.sandbox import confine_self
from simworlds.sandbox.confine_self import ARCHITECTURES, NUMBERS, filter_program

MACHINES = sorted(ARCHITECTURES)
OWN = 4321
ALLOWED, REFUSED, UNKNOWN, PRETENDED, KILLED = "allowed", "EPERM", "ENOSYS", "nothing", "killed"
ANSWERS = {
    0x7FFF0000: ALLOWED,
    0x00050001: REFUSED,
    0x00050026: UNKNOWN,
    0x00050000: PRETENDED,
    0x80000000: KILLED,
}
linux = pytest.mark.skipif(sys.platform != "linux", reason="Linux confines this way")


def answer(
    machine: str, call: str | int, *arguments: int, files: bool = True, architecture: int | None = None
) -> str:
    """What the filter says, found by running it as the kernel does."""
    column, own_architecture = ARCHITECTURES[machine]
    number = NUMBERS[call][column] if isinstance(call, str) else call
    assert number is not None
    given = [value & (1 << 64) - 1 for value in (*arguments, 0, 0, 0, 0, 0, 0)[:6]]
    data = struct.pack(
        "<iIQ6Q", number, own_architecture if architecture is None else architecture, 0, *given
    )
    program = filter_program(machine, OWN, files=files)
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


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize(
    "call",
    [
        *("socket", "unshare", "setns", "mount", "ptrace", "process_vm_readv", "process_vm_writev", "tkill"),
        *(
            "pidfd_send_signal",
            "pidfd_getfd",
            "rt_sigqueueinfo",
            "rt_tgsigqueueinfo",
            "setpriority",
            "shmget",
        ),
        *("io_uring_setup", "bpf", "keyctl", "userfaultfd", "perf_event_open", "setrlimit", "seccomp"),
    ],
)
def test_refuses_calls_that_reach_other_processes(machine: str, call: str) -> None:
    assert answer(machine, call, files=False) == REFUSED


@pytest.mark.parametrize("machine", MACHINES)
def test_threads_can_be_started_but_no_processes(machine: str) -> None:
    thread, process = 0x3D0F00, signal.SIGCHLD
    assert answer(machine, "clone", thread) == ALLOWED
    assert answer(machine, "clone", process) == REFUSED
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
        ("openat2", UNKNOWN),
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
    assert answer(machine, "sched_setaffinity", 0) == ALLOWED
    assert answer(machine, "sched_setaffinity", OWN + 1) == REFUSED


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


def confined(code: str, **rights: object) -> subprocess.CompletedProcess[str]:
    given = json.dumps({"memory": 0, "file_size": 0, **rights})
    words = [
        sys.executable,
        "-I",
        "-S",
        confine_self.__file__,
        given,
        "--",
        sys.executable,
        "-I",
        "-S",
        "-c",
        code,
    ]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)


@linux
def test_exceeding_a_limit_is_an_error(tmp_path: Path) -> None:
    code = (
        "try: bytearray(1 << 30)\nexcept MemoryError: print('memory')\n"
        f"file = open({str(tmp_path / 'file')!r}, 'wb', buffering=0)\n"
        "try: [file.write(bytes(1 << 20)) for _ in range(9)]\nexcept OSError as error: print(error.strerror)"
    )
    done = confined(code, memory=300 << 20, file_size=2 << 20)
    assert done.stdout == "memory\nFile too large\n", done.stderr
    assert (tmp_path / "file").stat().st_size == 2 << 20


@linux
def test_limits_are_capped_at_the_hard_limit() -> None:
    words = (
        f"ulimit -f 8; exec {sys.executable} -I -S {confine_self.__file__} \"$1\" -- /bin/sh -c 'ulimit -f'"
    )
    rights = json.dumps({"memory": 0, "file_size": 1 << 40})
    done = subprocess.run(["sh", "-c", words, "sh", rights], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "8"


@linux
def test_capabilities_are_gone_for_good() -> None:
    done = confined("print(open('/proc/self/status').read())")
    told = dict(line.split(":\t") for line in done.stdout.splitlines() if ":\t" in line)
    assert {told[name] for name in ("CapEff", "CapPrm", "CapBnd", "CapInh", "CapAmb")} == {"0" * 16}
    assert told["NoNewPrivs"] == "1"
    assert told["Seccomp"] == "2"


@linux
def test_is_killed_first_when_memory_runs_out() -> None:
    assert confined("print(open('/proc/self/oom_score_adj').read())").stdout.strip() == "1000"


@linux
@pytest.mark.skipif(not confine_self.landlock_abi(), reason="this kernel has no Landlock")
def test_a_file_that_may_be_read_cannot_be_cut_short_or_changed(tmp_path: Path) -> None:
    kept = tmp_path / "kept"
    kept.write_text("content")
    kept.chmod(0o640)
    before = kept.stat()
    code = f"""
import os
path = {str(kept)!r}
print(open(path).read())
for act in (
    lambda: os.truncate(path, 0),
    lambda: os.open(path, os.O_RDONLY | os.O_TRUNC),
    lambda: open(path, 'a'),
    lambda: os.chown(path, os.getuid(), os.getgid()),
    lambda: os.setxattr(path, 'user.x', b'1'),
    lambda: os.link(path, path + '2'),
    lambda: os.rename(path, path + '2'),
    lambda: os.unlink(path),
):
    try: act()
    except OSError: print('refused')
os.chmod(path, 0o777)
os.utime(path, (1, 1))
"""
    read = ["/usr", "/lib", "/lib64", "/proc/self", str(Path(sys.base_prefix).resolve()), str(tmp_path)]
    done = confined(code, read=[*read, sys.prefix], write=[])
    assert done.stdout.split() == ["content", *["refused"] * 8], done.stderr
    after = kept.stat()
    assert (after.st_mode, after.st_mtime, after.st_size) == (before.st_mode, before.st_mtime, before.st_size)


@linux
def test_does_not_run_unconfined(tmp_path: Path) -> None:
    done = confined("print('ran')", file_size="many")
    assert done.returncode != 0
    assert "ran" not in done.stdout
    rights = json.dumps({"memory": 0, "file_size": 0})
    missing = subprocess.run(
        [sys.executable, "-I", "-S", confine_self.__file__, rights, "--", str(tmp_path / "none")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert missing.returncode == 126
    assert "Blender cannot be confined" in missing.stderr
