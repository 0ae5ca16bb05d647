"""What holds in each sandbox, as root and as another user: Python code, started as Blender's is, tries it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from functools import cache
from typing import TYPE_CHECKING, Any

import pytest

from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.confined_command import bubblewrap_fault
from simworlds.sandbox.confinement.worker_user import WORKER_ID

if TYPE_CHECKING:
    from pathlib import Path

    from simworlds.sandbox.confinement.walls import Wall

pytestmark = pytest.mark.skipif(not confine_self.has_seccomp(), reason="system calls cannot be closed here")

AS_USER = ("unshare", "--user", "--map-user=1000", "--map-group=1000")

# Makes the sandbox and runs the code in it, through the script that starts Blender's program.
DRIVER = """
import json, os, socket, subprocess, sys
from pathlib import Path
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.confinement.control_group import ControlGroup, group_parents
from simworlds.sandbox.errors import CannotStart
from simworlds.sandbox.program import BOOT, SHARED, Program

given = json.loads(sys.argv[1])
place = Path(given["place"])
write = place / "write"
write.mkdir(exist_ok=True)
limits = ResourceLimits(memory=given["memory"], threads=50)
sandbox = best_sandbox(given["kind"], limits, frozenset(given["without"]))
group = ControlGroup(limits, None if "memory" in given["without"] else group_parents())
group.renew()
program = Program("probe.run", {"probe": place / "probe"})
words = [sys.executable, "-I", str(BOOT), "--", *program.arguments(given["code"])]
try:
    command = sandbox.command(words, read=[BOOT.parent, place / "probe"], write=[write], group=group.folders)
except CannotStart as error:
    print(json.dumps({"refused": str(error)}))
    sys.exit()
ours, theirs = socket.socketpair()
environment = {"CHANNEL": str(theirs.fileno()), "PATH": os.environ["PATH"], "HOME": str(write), "TMPDIR": str(write)}
given = {"env": environment, "pass_fds": (theirs.fileno(),)}
done = subprocess.run(command, cwd=write, capture_output=True, text=True, timeout=100, **given)
told = {"code": done.returncode, "out": done.stdout, "err": done.stderr, "memory": group.ran_out_of_memory}
folders = group.folders
group.close()
left = [str(folder) for folder in folders if folder.exists()]
print(json.dumps({**told, "groups": len(folders), "left": left}))
"""
PROBE = """
import ctypes, errno, json, os
libc = ctypes.CDLL(None, use_errno=True)
def call(number, *words):
    ctypes.set_errno(0)
    result = libc.syscall(number, *words)
    return "done" if result >= 0 else errno.errorcode[ctypes.get_errno()]
def tried(act):
    try:
        act()
    except OSError as error:
        return errno.errorcode[error.errno]
    return "done"
def main(words):
    exec(words[0], globals())
"""


@cache
def can_be_a_user() -> bool:
    """Whether root can start a process here that is another user for itself, and still reads what is root's."""
    if shutil.which("unshare") is None:
        return False
    return subprocess.run([*AS_USER, "true"], capture_output=True, check=False).returncode == 0


@pytest.fixture
def place(tmp_path: Path) -> Path:
    (tmp_path / "probe").mkdir()
    (tmp_path / "probe" / "__init__.py").touch()
    (tmp_path / "probe" / "run.py").write_text(PROBE)
    for folder in (tmp_path, tmp_path / "probe"):
        folder.chmod(0o755)
    return tmp_path


def run(
    place: Path, sandbox: tuple[str, str], code: str, *down: Wall, memory: int = 1 << 30
) -> dict[str, Any]:
    """What code did in a sandbox with these walls down: its exit code and what it printed."""
    kind, who = sandbox
    given = {"kind": kind, "without": down, "place": str(place), "code": code, "memory": memory}
    before = AS_USER if who == "user" and os.geteuid() == 0 else ()
    words = [*before, sys.executable, "-c", DRIVER, json.dumps(given)]
    done = subprocess.run(words, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def told(place: Path, sandbox: tuple[str, str], code: str, *down: Wall) -> list[str]:
    """The words that code prints."""
    # Root's Python may lie where no other user can reach it; then Landlock is tried without its user.
    if sandbox == ("landlock", "root"):
        down = (*down, "uid")
    done = run(place, sandbox, code, *down)
    assert done["code"] == 0, done["err"]
    return done["out"].split()


@pytest.fixture(
    params=[(kind, who) for kind in ("bubblewrap", "landlock") for who in ("root", "user")], ids="-".join
)
def sandbox(request: pytest.FixtureRequest) -> tuple[str, str]:
    kind, who = request.param
    if who == "root" and os.geteuid() != 0:
        pytest.skip("this is not root")
    if who == "user" and os.geteuid() == 0 and not can_be_a_user():
        pytest.skip("unshare cannot make another user here")
    if kind == "bubblewrap" and (fault := bubblewrap_fault()):
        pytest.skip(f"bubblewrap does not work here: {fault}")
    if kind == "landlock" and not confine_self.landlock_abi():
        pytest.skip("this kernel has no Landlock")
    return kind, who


def test_has_no_capability_and_is_not_root(sandbox: tuple[str, str], place: Path) -> None:
    code = """
rows = dict(line.split(":\\t") for line in open("/proc/self/status").read().splitlines() if ":\\t" in line)
print(rows["CapEff"], rows["CapPrm"], rows["CapInh"], rows["CapAmb"], rows["NoNewPrivs"], rows["Seccomp_filters"])
print(os.getuid(), os.geteuid(), os.getgid(), len(os.getgroups()))
"""
    none = "0" * 16
    words = told(place, sandbox, code)
    assert words[:6] == [none, none, none, none, "1", "2"]
    if sandbox == ("bubblewrap", "root"):
        assert words[6:] == [str(WORKER_ID)] * 3 + ["0"]
    elif sandbox[1] == "user":
        assert words[6] != "0"


def test_settings_of_the_kernel_cannot_be_changed(sandbox: tuple[str, str], place: Path) -> None:
    code = """
for path in ("/proc/sys/kernel/core_pattern", "/proc/sysrq-trigger", "/proc/self/oom_score_adj", "/proc/self/comm"):
    print(tried(lambda: os.close(os.open(path, os.O_WRONLY))))
print(tried(lambda: os.close(os.open("/proc/self/oom_score_adj", os.O_RDONLY))))
"""
    words = told(place, sandbox, code)
    assert "done" not in words[:3]
    assert words[4] == ("done" if sandbox[0] == "bubblewrap" else "EACCES")


def test_root_without_its_walls_could_change_the_kernels_settings(place: Path) -> None:
    """Opening for writing is enough to know; nothing is written."""
    if os.geteuid() != 0 or bubblewrap_fault():
        pytest.skip("this needs root and bubblewrap")
    code = 'print(tried(lambda: os.close(os.open("/proc/sys/kernel/core_pattern", os.O_WRONLY))))'
    for down in ((), ("proc",), ("uid",)):
        assert told(place, ("bubblewrap", "root"), code, *down) in (["EROFS"], ["EACCES"])
    assert told(place, ("bubblewrap", "root"), code, "proc", "uid") == ["done"]


def test_no_socket_call_is_answered(sandbox: tuple[str, str], place: Path) -> None:
    code = """
import socket
print(tried(lambda: socket.socket()), tried(lambda: socket.socketpair()),
      tried(lambda: socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)))
"""
    assert told(place, sandbox, code) == ["EPERM"] * 3
    assert told(place, sandbox, code, "sockets") == ["done"] * 3


def test_the_channel_can_carry_no_descriptors(sandbox: tuple[str, str], place: Path) -> None:
    code = """
channel = int(os.environ["CHANNEL"])
for number in (46, 47, 44, 45, 42, 55):  # sendmsg, recvmsg, sendto, recvfrom, connect, getsockopt
    print(call(number, channel, 0, 0, 0x40, 0, 0))
"""
    if os.uname().machine != "x86_64":
        pytest.skip("the numbers are of x86_64")
    assert told(place, sandbox, code) == ["ENOTSOCK"] * 6
    assert "ENOTSOCK" not in told(place, sandbox, code, "sockets")


def test_nothing_can_be_executed_any_more(sandbox: tuple[str, str], place: Path) -> None:
    code = """
import threading
print(tried(lambda: os.execv("/bin/true", ["true"])))
found = []
thread = threading.Thread(target=lambda: found.append(tried(lambda: os.execv("/bin/true", ["true"]))))
thread.start(); thread.join()
print(*found, tried(os.fork), "SIMWORLDS_LAST_FILTER" in os.environ)
"""
    assert told(place, sandbox, code) == ["EPERM", "EPERM", "EPERM", "False"]
    assert told(place, sandbox, code, "processes") == []  # it has become another program


def test_what_the_kernel_rarely_does_is_closed(sandbox: tuple[str, str], place: Path) -> None:
    code = """
size = ctypes.create_string_buffer(128)
print(call(425, 8, size), call(321, 0, size, 120), call(298, size, 0, -1, -1, 0), call(323, 0),
      call(300, 0, 0), call(250, 0, -3, 0), call(165, 0, b".", b"tmpfs", 0, 0), call(303, -100, b".", size, size, 0),
      call(272, 0x10000000))
print(call(319, b"name", 0), call(447, 0), call(600))
"""
    if os.uname().machine != "x86_64":
        pytest.skip("the numbers are of x86_64")
    assert told(place, sandbox, code) == ["EPERM"] * 9 + ["ENOSYS"] * 3
    assert told(place, sandbox, code, "memfd")[9] == "done"
    assert told(place, sandbox, code, "kernel")[5] == "done"  # the session's keyring


def test_landlock_shows_neither_attributes_nor_targets_of_links(
    sandbox: tuple[str, str], place: Path
) -> None:
    if sandbox[0] != "landlock":
        pytest.skip("with bubblewrap nothing outside can be named")
    (place / "link").symlink_to("secret-target")
    with_attribute = place / "attributed"
    with_attribute.touch()
    try:
        os.setxattr(with_attribute, "user.secret", b"1")
    except OSError:
        pytest.skip("this file system has no attributes")
    code = f"""
import shutil
print(tried(lambda: os.readlink({str(place / "link")!r})), tried(lambda: os.listxattr({str(with_attribute)!r})),
      tried(lambda: os.getxattr({str(with_attribute)!r}, "user.secret")))
open("one", "w").close()
print(shutil.copy2("one", "two"))
"""
    assert told(place, sandbox, code) == ["EINVAL", "ENOTSUP", "ENOTSUP", "two"]
    assert told(place, sandbox, code, "attributes") == ["done", "done", "done", "two"]


def test_the_folders_to_write_belong_to_the_worker(sandbox: tuple[str, str], place: Path) -> None:
    (place / "write").mkdir()
    (place / "write" / "before").write_text("x")
    outside = place / "outside"
    outside.write_text("x")
    (place / "write" / "link").symlink_to(outside)
    os.link(outside, place / "write" / "other-name")
    own = outside.stat().st_uid
    code = 'open("before", "w").write("changed"); open("made", "w").close(); print(os.stat("made").st_uid)'
    assert told(place, sandbox, code) is not None
    assert (place / "write" / "before").read_text() == "changed"
    assert outside.stat().st_uid == own


def test_memory_of_every_kind_ends_with_the_worker(sandbox: tuple[str, str], place: Path) -> None:
    """Memory that several mappings could share is no private memory, and escapes the process's own limit."""
    code = """
import mmap
shared = mmap.mmap(-1, 600 << 20)
for start in range(0, 600 << 20, 4096): shared[start] = 1
print("done")
"""
    down: tuple[Wall, ...] = ("uid",) if sandbox == ("landlock", "root") else ()
    done = run(place, sandbox, code, *down, memory=300 << 20)
    if not done["groups"]:
        pytest.skip("no control group can be made here")
    assert (done["out"], done["memory"], done["left"]) == ("", True, [])
    assert done["code"] in (-9, 137)
    assert run(place, sandbox, code, *down, "memory", memory=300 << 20)["out"] == "done\n"


def test_landlock_as_root_says_what_to_do_where_the_worker_cannot_reach_python(place: Path) -> None:
    if os.geteuid() != 0 or not confine_self.landlock_abi():
        pytest.skip("this needs root and Landlock")
    place.chmod(0o700)
    refused = run(place, ("landlock", "root"), "print(1)").get("refused", "")
    assert "cannot reach" in refused or "cannot read" in refused
    assert "run SimWorlds as a user other than root" in refused


def test_a_filter_that_cannot_be_installed_ends_the_process(place: Path) -> None:
    from simworlds.sandbox.program import BOOT

    done = subprocess.run(
        [
            sys.executable,
            "-I",
            str(BOOT),
            "--",
            "probe.run",
            f"probe={place / 'probe'}",
            "--",
            "print('ran')",
        ],
        env={"SIMWORLDS_LAST_FILTER": "317:00"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout) == (126, "")
    assert "cannot be confined" in done.stderr
