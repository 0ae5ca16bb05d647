"""One untrusted .blend in a Blender of its own: confined, within a deadline and a limit of memory, asked over a socket.

The file is only read, and so is the folder that it lies in (for its caches and libraries); no script of it runs, there
is no network, and nothing can be written but a temporary folder that goes with the process. Whatever Blender prints
goes to a file that nobody believes. A process that crashes, hangs or answers what it was not asked ends the matter:
the file is not scored, and the exception says why.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import struct
import subprocess
import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from agents.blender.errors import CannotStart
from agents.blender.launch import Launch, find_blender
from agents.blender.nursery import started_for_good
from agents.blender.sandbox import GIB, Limits, best_sandbox

if TYPE_CHECKING:
    from types import TracebackType

    from kb_build.runtime import Runtime

ENTRY = Path(__file__).parent / "inside" / "entry.py"
_LENGTH = struct.Struct(">I")
_LONGEST_ANSWER = 256 << 20
_CHUNK = 1 << 20
_END_SECONDS = 5.0
_NO_MEMORY = (
    "bad_alloc",
    "returns null",
    "ut of memory",
    "MemoryError",
    "annot allocate",
    "failed to map segment",
)
_MARKS = (b"BLENDER", b"\x1f\x8b", b"\x28\xb5\x2f\xfd")  # plain, gzip (before 3.0), Zstandard


class NotScored(Exception):  # noqa: N818 - reads as the state it names
    """A file that cannot be looked at; the message says why."""


class Crashed(NotScored):
    """Blender ended over the file."""


class Refused(NotScored):
    """What was asked for is not to be had of this file."""


@dataclass(frozen=True)
class Means:
    """Which Blender looks (by default this environment's), how long a file may take (seconds), how much memory (bytes).

    ``read``: further folders that it may read, as of linked files elsewhere.
    """

    version: str | None = None
    blender_exe: Path | None = None
    seconds: float = 120.0
    memory: int = 4 * GIB
    read: tuple[Path, ...] = field(default=())

    def runtime(self) -> Runtime:
        """The Blender. Raises CannotStart."""
        return find_blender(self.version, self.blender_exe)


class Untrusted:
    """A .blend, opened; to be used in a ``with``. Raises NotScored for the file, CannotStart where no Blender works.

    ``entry`` answers what is asked; ``workspace`` is where Blender may write, by default a folder that goes with it.
    """

    def __init__(
        self,
        blend: Path,
        means: Means | None = None,
        entry: Path | None = None,
        workspace: Path | None = None,
    ) -> None:
        self._means = means or Means()
        self._path = checked(blend)
        self._entry, self._workspace = entry, workspace
        self._deadline = time.monotonic() + self._means.seconds
        self._doing = "opening it"

    def __enter__(self) -> Untrusted:
        self._place = tempfile.TemporaryDirectory(prefix="simworlds-audit-", ignore_cleanup_errors=True)
        try:
            self._start(Path(self._place.name).resolve())
            self.ask("open", path=str(self._path), doing="opening it")
        except BaseException:
            self._end()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    def reopen(self, blend: Path) -> None:
        """Opens another file of the same folder instead, with as much time. Raises as the beginning does."""
        path = checked(blend)
        self._deadline = time.monotonic() + self._means.seconds
        self.ask("open", path=str(path), doing="opening it")

    def ask(self, job: str, *, doing: str, **arguments: Any) -> Any:
        """What ``bench/inside/entry.py`` answers (JSON). ``doing``: in words, for errors.

        Raises NotScored, and CannotStart where this Blender lacks something.
        """
        self._doing = doing
        body = json.dumps({"job": job, "arguments": arguments}).encode()
        try:
            self._socket.settimeout(self._left())
            self._socket.sendall(_LENGTH.pack(len(body)) + body)
            (length,) = _LENGTH.unpack(self._read(_LENGTH.size))
            if length > _LONGEST_ANSWER:
                raise NotScored(f"Blender's answer is too long ({length >> 20} MiB) after {self._doing}")
            answer = json.loads(self._read(length))
        except TimeoutError:
            raise NotScored(
                f"Blender was still {self._doing} when its {self._means.seconds:g} s were over"
            ) from None
        except OSError:
            raise Crashed(f"Blender {self._ending()} {self._doing}") from None
        except ValueError:
            raise NotScored(f"Blender answered what is no JSON after {self._doing}") from None
        if not isinstance(answer, dict) or not answer.keys() & {"value", "refused", "failed", "unable"}:
            raise NotScored(f"Blender answered what it was not asked after {self._doing}")
        if "unable" in answer:
            raise CannotStart(f"{answer['unable']}. Name another Blender, or install what is missing.")
        if "refused" in answer:
            raise Refused(str(answer["refused"])[:600])
        if "failed" in answer:
            raise NotScored(str(answer["failed"])[:600])
        return answer["value"]

    def _left(self) -> float:
        left = self._deadline - time.monotonic()
        if left <= 0:
            raise TimeoutError
        return left

    def _read(self, count: int) -> bytes:
        found = bytearray()
        while len(found) < count:
            self._socket.settimeout(self._left())
            data = self._socket.recv(min(_CHUNK, count - len(found)))
            if not data:
                raise Crashed(f"Blender {self._ending()} {self._doing}")
            found += data
        return bytes(found)

    def _start(self, place: Path) -> None:
        workspace = self._workspace or place / "work"
        workspace.mkdir(exist_ok=True)
        self._log = place / "log"
        limits = Limits(memory=self._means.memory, file_size=GIB)
        launch = Launch(
            self._means.runtime(),
            workspace,
            place / "private",
            best_sandbox(limits=limits),
            (*readable(self._path), ENTRY.parent, *self._means.read),
            self._entry or ENTRY,
        )
        launch.prepare()
        self._socket, theirs = socket.socketpair()
        try:
            command = launch.command(theirs.fileno())
            with self._log.open("wb") as log:
                self._process = started_for_good(
                    lambda: subprocess.Popen(
                        command,
                        stdin=subprocess.DEVNULL,
                        stdout=log,
                        stderr=subprocess.STDOUT,
                        env=launch.environment,
                        cwd=workspace,
                        pass_fds=(theirs.fileno(),),
                        start_new_session=True,
                    )
                )
        finally:
            theirs.close()

    def _ending(self) -> str:
        """In words, how the process ended."""
        try:
            code = self._process.wait(_END_SECONDS)
        except subprocess.TimeoutExpired:
            return "stopped to answer while"
        if code > 128:  # bubblewrap tells a signal like a shell
            code = 128 - code
        if any(word in self._said() for word in _NO_MEMORY):
            return f"ran out of memory ({self._means.memory / GIB:.1f} GiB) while"
        if code >= 0:
            return f"ended (exit code {code}) while"
        try:
            name = signal.Signals(-code).name
        except ValueError:
            name = f"signal {-code}"
        return f"crashed ({name}) while"

    def _said(self) -> str:
        try:
            with self._log.open("rb") as file:
                file.seek(max(0, self._log.stat().st_size - 4000))
                return file.read().decode(errors="replace")
        except OSError:
            return ""

    def _end(self) -> None:
        """Lets Blender end, or kills it with all it has started; then removes its folder."""
        process = getattr(self, "_process", None)
        if process is not None:
            self._socket.close()
            with suppress(subprocess.TimeoutExpired):
                if time.monotonic() < self._deadline:
                    process.wait(_END_SECONDS)
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        self._place.cleanup()


def checked(blend: Path) -> Path:
    """Where a .blend really lies. Raises NotScored for what is none by its first bytes."""
    path = blend.expanduser().resolve()
    try:
        if not path.is_file():
            raise NotScored("there is no such file" if not path.exists() else "it is not a file")
        with path.open("rb") as file:
            head = file.read(8)
    except OSError as error:
        raise NotScored(f"it cannot be read: {error.strerror or error}") from error
    if not head:
        raise NotScored("it is empty")
    if not head.startswith(_MARKS):
        raise NotScored("it is no .blend")
    return path


def readable(blend: Path) -> tuple[Path, ...]:
    """What beside the file Blender may read: its folder; of a folder that holds the user's home, only its caches."""
    folder, home = blend.parent, Path.home().resolve()
    if not home.is_relative_to(folder):
        return (folder,)
    beside = folder / f"blendcache_{blend.stem}"
    return (blend, beside) if beside.is_dir() else (blend,)
