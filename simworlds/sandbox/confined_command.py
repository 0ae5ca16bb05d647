"""What Blender may touch: bubblewrap where it works, Landlock otherwise, plain limits elsewhere.

What remains open to code that runs in Blender: all of its own process, and so its own answers (see process.py); what
the run's workspace and its temporary folder hold; to read the system's programs, Blender and Python; the graphics
card; the kernel, as far as its calls are not closed. Files without a place on disk (memfd) count against no limit: when
the machine runs out of memory, the kernel ends Blender first. Beside Landlock it can ask whether a path exists.
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
from typing import Literal

from simworlds.sandbox import confine_self
from simworlds.sandbox.errors import CannotStart

Kind = Literal["bubblewrap", "landlock", "none"]

GIB = 1024**3
_PROBE_SECONDS = 10
_SYSTEM = ("/usr", "/lib", "/lib32", "/lib64", "/bin", "/sbin", "/nix/store", "/sys")
_SETTINGS = (
    *("/etc/ld.so.cache", "/etc/ld.so.conf", "/etc/ld.so.conf.d", "/etc/localtime", "/etc/alternatives"),
    *("/etc/fonts", "/etc/glvnd", "/etc/vulkan", "/etc/OpenCL", "/etc/egl", "/etc/blender"),
)
_GRAPHICS = ("/dev/dri", "/dev/kfd", "/dev/nvidia*")
_DEVICES = ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")
_PROCESS = ("/proc/self", "/proc/cpuinfo", "/proc/meminfo", "/proc/stat", "/proc/sys", "/proc/filesystems")


@dataclass(frozen=True, slots=True)
class ResourceLimits:
    """Bytes: memory of the process, one file, and all that it may write; then numbers. 0: no limit."""

    memory: int = 0
    file_size: int = 4 * GIB
    disk: int = 20 * GIB
    files: int = 200_000
    threads: int = 4096

    @property
    def in_words(self) -> tuple[str, ...]:
        """In words."""
        each = (
            (self.memory, f"{self.memory / GIB:.1f} GiB of memory"),
            (self.file_size, f"{self.file_size / GIB:.1f} GiB a file"),
            (self.disk, f"{self.disk / GIB:.1f} GiB on disk"),
            (self.files, f"{self.files:,} files"),
            (self.threads, f"{self.threads:,} threads"),
        )
        return tuple(words for amount, words in each if amount)


@dataclass(frozen=True, slots=True)
class Sandbox:
    """A way to confine a process. ``holds`` and ``lacks`` say in words what it does and does not keep out."""

    kind: Kind
    holds: tuple[str, ...]
    lacks: tuple[str, ...] = ()
    limits: ResourceLimits = field(default_factory=ResourceLimits)

    def command(self, words: list[str], *, read: list[Path], write: list[Path]) -> list[str]:
        """``words``, confined: only ``read`` (besides the system's programs) is readable, only ``write`` writable.

        Raises CannotStart where that would open the user's whole home folder.
        """
        rights: dict[str, object] = {"memory": self.limits.memory, "file_size": self.limits.file_size}
        script = Path(confine_self.__file__)
        readable = [str(path) for path in read]
        if self.kind == "landlock":
            _spare_home(readable)
            rights["read"] = [*_SYSTEM, *_SETTINGS, *_PROCESS, *readable]
            rights["write"] = [*(str(path) for path in write), *_DEVICES, *graphics()]
        launcher = [sys.executable, "-I", "-S", str(script), json.dumps(rights), "--", *words]
        if self.kind != "bubblewrap":
            return launcher
        readable += [str(script), *own_python()]
        _spare_home(readable)
        return [*_bubblewrap(readable, write), "--", *launcher]


def _spare_home(paths: list[str]) -> None:
    home = Path.home().resolve()
    for path in paths:
        if home.is_relative_to(path) and str(home) != "/":
            raise CannotStart(
                f"Blender or Python lies in {path} itself, and to read it would be to read all that you have there. "
                "Put it into a folder of its own."
            )


def own_python() -> list[str]:
    """The folders that this interpreter lives in."""
    real = Path(sys.executable).resolve().parent.parent
    folders = {sys.prefix, sys.base_prefix, str(real), sysconfig.get_path("stdlib")}
    return sorted(folders - {"/usr", "/"})


def graphics() -> list[str]:
    """The devices of the graphics cards here."""
    return sorted(found for pattern in _GRAPHICS for found in glob(pattern))  # noqa: PTH207 - absolute patterns


def _bubblewrap(read: list[str], write: list[Path]) -> list[str]:
    words = [
        *("bwrap", "--unshare-all", "--die-with-parent", "--new-session", "--cap-drop", "ALL"),
        *("--hostname", "blender", "--proc", "/proc", "--dev", "/dev"),
    ]
    for path in (*_SYSTEM, *_SETTINGS, *read):
        words += ["--ro-bind-try", path, path]
    for path in graphics():
        words += ["--dev-bind", path, path]
    for folder in write:
        words += ["--bind", str(folder), str(folder)]
    # What bubblewrap makes to hold all these is in memory and gone with the process: a write to it must not seem to
    # work, and would not count against any limit.
    return [*words, "--remount-ro", "/dev", "--remount-ro", "/"]


def best_sandbox(wanted: Kind | None = None, limits: ResourceLimits | None = None) -> Sandbox:
    """The strongest that works here, or the one that is ``wanted``, whether it works or not."""
    kind = wanted or _best_kind()
    limits = limits or default_limits()
    holds = ["ends with SimWorlds, whatever ends that", "sees no secret of your environment"]
    lacks: list[str] = []
    if kind == "none":
        lacks.append("reading and writing files wherever you can")
    else:
        holds.append("writes to the run's workspace and a private temporary folder alone")
        holds.append("reads these, the system's programs, Blender and Python alone")
    if confine_self.has_seccomp():
        holds.append("opens no network or other socket, starts no process, sends no other one a signal")
    elif kind == "bubblewrap":
        holds.append("opens no network, sends no process outside a signal")
        lacks.append("starting processes, which end with Blender")
    else:
        lacks.append("the network, and starting processes")
    if kind == "bubblewrap":
        holds.append("sees no other process")
    elif kind == "landlock":
        lacks.append("asking whether a path exists, how large and how old it is")
    if kind != "none" and graphics():
        lacks.append("the graphics card")
    holds.append(f"takes at most {', '.join(limits.in_words)}")
    return Sandbox(kind, tuple(holds), tuple(lacks), limits)


def default_limits() -> ResourceLimits:
    """Three quarters of the memory that this process can have."""
    try:
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError, AttributeError):
        return ResourceLimits()
    return ResourceLimits(memory=min([memory, *_group_limits()]) * 3 // 4)


def _group_limits() -> list[int]:
    """What the control group that this process is in may have, in bytes."""
    found: list[int] = []
    with suppress(OSError, ValueError):
        group = Path("/proc/self/cgroup").read_text().strip().rpartition(":")[2]
        for path in (f"{group}/memory.max", "/memory.max", "/memory/memory.limit_in_bytes"):
            with suppress(OSError, ValueError):
                found.append(int(Path(f"/sys/fs/cgroup{path}").read_text()))
    return found


def _best_kind() -> Kind:
    if sys.platform != "linux":
        return "none"
    if bubblewrap_fault() is None:
        return "bubblewrap"
    return "landlock" if confine_self.landlock_abi() else "none"


@cache
def bubblewrap_fault() -> str | None:
    """Why bubblewrap cannot be used here; None if it can."""
    if shutil.which("bwrap") is None:
        return "bwrap is not on PATH"
    words = [*_bubblewrap(own_python(), []), "--", sys.executable, "-I", "-S", "-c", ""]
    try:
        done = subprocess.run(
            words, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PROBE_SECONDS, check=False
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        return str(error)
    return None if done.returncode == 0 else done.stderr.decode(errors="replace").strip()[:300] or "it fails"
