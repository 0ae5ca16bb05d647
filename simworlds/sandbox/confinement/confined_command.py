"""Builds the command that runs Blender in a sandbox: bubblewrap if it works, else Landlock, else only limits.

What code in Blender can still reach: its own process, and so its own replies (see blender_process.py); the run's
workspace and temporary folder; reading the system's programs, Blender and Python; the graphics card; the kernel, as
far as its calls are not closed. With Landlock, code can ask whether a path exists.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from glob import glob
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from simworlds.sandbox.confinement import confine_self
from simworlds.sandbox.confinement.control_group import group_parents
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.confinement.system_calls import OWN_PROCESS, first_filter, installing_call, last_filter
from simworlds.sandbox.confinement.walls import EVERY_WALL, WALLS, WITHOUT
from simworlds.sandbox.confinement.worker_user import check_readable, hand_over, worker_id
from simworlds.sandbox.errors import CannotStart
from simworlds.settings import expanded

if TYPE_CHECKING:
    from collections.abc import Mapping

    from simworlds.sandbox.confinement.walls import Wall

Kind = Literal["bubblewrap", "landlock", "none"]

_PROBE_SECONDS = 10
_SYSTEM = ("/usr", "/lib", "/lib32", "/lib64", "/bin", "/sbin", "/nix/store", "/sys")
_SETTINGS = (
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/localtime", "/etc/alternatives"),
    *("/etc/fonts", "/etc/glvnd", "/etc/vulkan", "/etc/OpenCL", "/etc/egl", "/etc/blender"),
)
_GRAPHICS = ("/dev/dri", "/dev/kfd", "/dev/nvidia*")
_DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")
_TO_BECOME = ("CAP_SETUID", "CAP_SETGID", "CAP_SETPCAP")
# The worker is the first to be killed when memory runs out, and enters its control group, before it is anything else.
_ENTER = """
[ ! -w /proc/self/oom_score_adj ] || echo 1000 > /proc/self/oom_score_adj
while [ "$1" != -- ]; do echo $$ > "$1/cgroup.procs" || exit 126; shift; done
shift
exec "$@"
"""
# What /proc tells of the whole machine, though not of other processes.
_COVERED = (
    "/proc/keys",
    "/proc/key-users",
    "/proc/timer_list",
    "/proc/sysrq-trigger",
    "/proc/kcore",
    "/proc/kallsyms",
)
# Not all of /proc/self: it holds the network's tables.
_OF_ITSELF = (
    "auxv cgroup cmdline comm environ exe fd fdinfo limits maps mountinfo mounts smaps stat statm status"
)
_PROCESS = (
    *(f"/proc/self/{name}" for name in _OF_ITSELF.split()),
    "/proc/cpuinfo",
    "/proc/meminfo",
    "/proc/stat",
    "/proc/sys",
    "/proc/filesystems",
)


@dataclass(frozen=True, slots=True)
class Sandbox:
    """A way to confine a process. ``holds`` and ``lacks`` say what it guarantees and what it leaves open.

    ``without``: walls that are taken down, to show what each of them keeps out.
    """

    kind: Kind
    holds: tuple[str, ...]
    lacks: tuple[str, ...] = ()
    limits: ResourceLimits = field(default_factory=ResourceLimits)
    without: frozenset[Wall] = frozenset()

    @property
    def walls(self) -> frozenset[Wall]:
        """The walls that stand."""
        return standing_walls(self.kind) - self.without

    @property
    def warning(self) -> str:
        """One line that says what is not prevented; "" if every wall stands."""
        return f"Sandbox ({self.kind}): it does not prevent {'; '.join(self.lacks)}." if self.lacks else ""

    @property
    def user(self) -> int | None:
        """The user that the confined process becomes, to whom the folders to write are given; None: it stays ours."""
        return None if self.kind == "none" or "uid" in self.without else worker_id()

    def command(
        self, words: list[str], *, read: list[Path], write: list[Path], group: tuple[Path, ...] = ()
    ) -> list[str]:
        """The command that runs ``words`` confined: it can read ``read`` and the system's programs, write ``write``.

        What is in ``write`` is given to ``user``. ``group``: folders of a control group to run in. Raises CannotStart
        if that would open the user's whole home folder, or ``user`` could not reach what it needs.
        """
        script = Path(confine_self.__file__)
        readable = [*(str(path) for path in read), *own_python()]
        if self.kind != "none":
            _check_home(readable)
        if (user := self.user) is not None:
            for folder in write:
                hand_over(folder, user)
            # Bubblewrap makes the folders above anew.
            in_place = self.kind == "landlock" or "files" in self.without
            needed = [*readable, *map(str, write)] if in_place else readable
            check_readable(needed, user, with_parents=in_place)
        rights = self._rights()
        if self.kind == "landlock":
            rights["read"] = [*_SYSTEM, *_SETTINGS, *_PROCESS, *readable]
            rights["write"] = [*(str(path) for path in write), *_DEVICES, *graphics()]
        launcher = [sys.executable, "-I", "-S", str(script), json.dumps(rights), "--", *words]
        if self.kind == "bubblewrap":
            launcher = [*_bubblewrap([*readable, str(script)], write, user, self.without), "--", *launcher]
        if sys.platform != "linux":
            return launcher
        return ["/bin/sh", "-c", _ENTER, "sh", *(str(folder) for folder in group), "--", *launcher]

    def _rights(self) -> dict[str, object]:
        """What confine_self.py is told."""
        unlimited = {"memory", "limits"} & self.without
        rights: dict[str, object] = {
            "memory": 0 if unlimited else self.limits.memory,
            "file_size": 0 if {"disk", "limits"} & self.without else self.limits.file_size,
            "user": self.user,
            "groups": device_groups() if self.user is not None else [],
            "without": sorted(self.without),
        }
        if confine_self.has_seccomp():
            machine, files = os.uname().machine, self.kind == "landlock"
            last = last_filter(machine, files=files, without=self.without)
            rights |= {
                "calls": first_filter(machine, files=files, without=self.without).hex(),
                "hole": OWN_PROCESS,
                "last": f"{installing_call(machine)}:{last.hex()}",
            }
        return rights


def _check_home(paths: list[str]) -> None:
    home = expanded(Path("~")).resolve()
    for path in paths:
        if home.is_relative_to(path) and str(home) != "/":
            raise CannotStart(
                f"Blender or Python is installed directly in {path}, so reading it would open everything there. "
                "Move it into a folder of its own."
            )


def own_python() -> list[str]:
    """The folders of this Python interpreter."""
    real = Path(sys.executable).resolve().parent.parent
    folders = {sys.prefix, sys.base_prefix, str(real), sysconfig.get_path("stdlib")}
    return sorted(folders - {"/usr", "/"})


def graphics() -> list[str]:
    """The device files of this machine's graphics cards."""
    return sorted(path for pattern in _GRAPHICS for path in glob(pattern))  # noqa: PTH207 - absolute patterns


def device_groups() -> list[int]:
    """The groups through which the graphics cards can be used, but that of root."""
    groups: set[int] = set()
    for path in graphics():
        with suppress(OSError):
            groups.add(os.stat(path).st_gid)  # noqa: PTH116 - paths here are words of a command
    return sorted(groups - {0})


def _bubblewrap(
    read: list[str], write: list[Path], user: int | None, without: frozenset[Wall] = frozenset()
) -> list[str]:
    words = ["bwrap", "--die-with-parent", "--new-session", *_namespaces(user, without)]
    words += [] if "capabilities" in without else ["--cap-drop", "ALL"]
    if user is not None:
        # For the launcher alone, which becomes the user and then has none.
        words += [word for name in _TO_BECOME for word in ("--cap-add", name)]
    if "files" in without:
        words += ["--dev-bind", "/", "/"]
    words += ["--bind", "/proc", "/proc"] if "namespaces" in without else ["--proc", "/proc"]
    if "files" in without:
        return words
    words += ["--dev", "/dev"]
    # The folders above would be made for root alone.
    shown = [*_SYSTEM, *_SETTINGS, *read, *map(str, write)]
    for folder in sorted({str(above) for path in shown for above in Path(path).parents} - {"/"}):
        words += ["--dir", folder]
    for path in (*_SYSTEM, *_SETTINGS, *read):
        words += ["--ro-bind-try", path, path]
    for path in graphics():
        words += ["--dev-bind", path, path]
    for folder in write:
        words += ["--bind", str(folder), str(folder)]
    # The folders that bubblewrap makes for these are in memory and gone with the process: a write to them must not seem
    # to work, and would not count against any limit.
    if "proc" not in without:
        for place in filter(os.path.exists, _COVERED):
            words += ["--dev-bind", "/dev/null", place]
        # /proc/sys obeys root, and oom_score_adj everybody.
        words += ["--remount-ro", "/proc"]
    return [*words, "--remount-ro", "/dev", "--remount-ro", "/"]


def _namespaces(user: int | None, without: frozenset[Wall]) -> list[str]:
    """Root has no namespace of users: in one that it makes itself it would stay root towards the kernel."""
    words = ["--unshare-net"] if "sockets" not in without else []
    if "namespaces" not in without:
        words += ["--unshare-pid", "--unshare-ipc", "--unshare-uts", "--unshare-cgroup-try"]
        words += ["--hostname", "blender"]
    if user is None:
        words += ["--unshare-user", *(["--disable-userns"] if _can_disable_namespaces() else [])]
    return words


@cache
def _can_disable_namespaces() -> bool:
    """Whether this bubblewrap can keep what it runs from making further namespaces of users."""
    try:
        done = subprocess.run(
            ["bwrap", "--help"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=_PROBE_SECONDS,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return b"--disable-userns" in done.stdout + done.stderr


# What is promised of executed code → the walls that it takes.
_HELD_BY: Mapping[str, tuple[Wall, ...]] = {
    "sees none of your environment's secrets": ("environment",),
    "writes only to the run's workspace and a private temporary folder, and reads only these, the system's programs, "
    "Blender and Python": ("files",),
    "has no rights of root, and changes nothing of the kernel": ("proc", "uid", "capabilities", "kernel"),
    "opens no network or other socket, starts no process, signals no other process": (
        "sockets",
        "processes",
        "signals",
    ),
    "sees no other process": ("namespaces",),
    "is ended by the kernel, before any other program, when it takes too much memory": ("memory",),
}


def best_sandbox(
    wanted: Kind | None = None, limits: ResourceLimits | None = None, without: frozenset[Wall] = frozenset()
) -> Sandbox:
    """The strongest sandbox that works here, or the ``wanted`` one, whether it works or not.

    ``without``: see Sandbox.
    """
    kind = wanted or _best_kind()
    limits = limits or default_limits()
    walls = standing_walls(kind) - without
    holds = ["ends with SimWorlds, however that ends"]
    holds += [text for text, needed in _HELD_BY.items() if walls.issuperset(needed)]
    lacks = [
        WITHOUT[wall] for wall in WALLS if wall not in walls and (kind, wall) != ("landlock", "namespaces")
    ]
    if kind == "landlock":
        lacks.append("asking whether a path exists, its size and its age, and where a link to a folder leads")
    if kind != "none" and graphics():
        lacks.append("use of the graphics card")
    holds.append(f"takes at most {', '.join(limits.in_words)}")
    return Sandbox(kind, tuple(holds), tuple(lacks), limits, without)


def standing_walls(kind: Kind) -> frozenset[Wall]:
    """The walls that stand in a sandbox of this kind on this machine."""
    down: set[Wall] = set()
    if kind == "none":
        down |= {"files", "proc", "namespaces", "attributes"}
        down |= {"uid"} if worker_id() is not None else set()
    if kind == "landlock":
        down.add("namespaces")
    if not confine_self.has_seccomp():
        down |= {"processes", "memfd", "kernel", "limits"}
        down |= {"sockets", "signals"} if kind != "bubblewrap" else set()
        down |= {"attributes"} if kind == "landlock" else set()
    if sys.platform != "linux":
        down |= {"capabilities"}
    if group_parents() is None:
        down.add("memory")
    return EVERY_WALL - down


def default_limits() -> ResourceLimits:
    """Limits memory to three quarters of what this process can have."""
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError, AttributeError):
        return ResourceLimits()
    return ResourceLimits(memory=min([memory, *_group_limits()]) * 3 // 4)


def _group_limits() -> list[int]:
    """The memory limits of this process's control group, in bytes."""
    limits: list[int] = []
    with suppress(OSError, ValueError):
        group = Path("/proc/self/cgroup").read_text().strip().rpartition(":")[2]
        for path in (f"{group}/memory.max", "/memory.max", "/memory/memory.limit_in_bytes"):
            with suppress(OSError, ValueError):
                limits.append(int(Path(f"/sys/fs/cgroup{path}").read_text()))
    return limits


def _best_kind() -> Kind:
    if sys.platform != "linux":
        return "none"
    if bubblewrap_fault() is None:
        return "bubblewrap"
    return "landlock" if confine_self.landlock_abi() else "none"


@cache
def bubblewrap_fault() -> str | None:
    """Why bubblewrap does not work here; None if it does."""
    if shutil.which("bwrap") is None:
        return "bwrap is not on PATH"
    words = [*_bubblewrap(own_python(), [], worker_id()), "--", sys.executable, "-I", "-S", "-c", ""]
    try:
        done = subprocess.run(
            words, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PROBE_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    return None if done.returncode == 0 else done.stderr.decode(errors="replace").strip()[:300] or "it fails"
