"""An untrusted .blend in its own sandboxed Blender, with limits of time and memory, queried over a socket.

Blender may only read the file and its folder (for caches and libraries). No script of the file runs, there is no
network, and only a temporary folder, removed with the process, can be written. Blender's prints are not trusted. If the
process crashes, hangs or replies with anything unexpected, the file is not scored, and the exception says why.
"""

from __future__ import annotations

import tempfile
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.audit.inside import LARGEST_REPLY
from simworlds.formats.blend_file import HEAD, begins_blend
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.confinement.resource_limits import GIB, ResourceLimits
from simworlds.sandbox.errors import (
    CannotStart,
    Lost,
    MissingModule,
    Refusal,
    TookTooLong,
    ToolBroke,
    Untrustworthy,
)
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.launch import Launch, find_blender
from simworlds.sandbox.program import SHARED, Program
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from types import TracebackType

    from simworlds.sandbox.blender_process import Progress
    from simworlds.sandbox.runtime import Runtime

INSIDE = Path(__file__).parent / "inside"
AUDITOR = Program("bench.audit.inside.serve", {**SHARED, "bench.audit.inside": INSIDE}, LARGEST_REPLY)
_LONGEST_REASON = 600


class NotScored(Exception):  # noqa: N818 - reads as the state it names
    """A file that cannot be scored; the message says why."""


class Crashed(NotScored):
    """Blender ended while it worked on the file."""


class JobRefused(NotScored):
    """Blender refused a job on this file; the message says why."""


@dataclass(frozen=True)
class BlenderOptions:
    """Which Blender to use (by default this environment's), and its limits for one file: seconds, and memory in bytes.

    ``read``: further folders that it may read, such as those of linked files.
    """

    version: str | None = None
    blender_exe: Path | None = None
    seconds: float = 120.0
    memory: int = 4 * GIB
    read: tuple[Path, ...] = field(default=())

    def runtime(self) -> Runtime:
        """The Blender to start. Raises CannotStart."""
        return find_blender(self.version, self.blender_exe)


class UntrustedBlend:
    """An open .blend, to be used in a ``with``. Raises NotScored for a bad file, CannotStart if no Blender works.

    ``program`` answers the jobs; ``workspace`` is where Blender may write, by default a folder removed at the end.
    """

    def __init__(
        self,
        blend: Path,
        means: BlenderOptions | None = None,
        program: Program | None = None,
        workspace: Path | None = None,
    ) -> None:
        self._means = means or BlenderOptions()
        self._path = resolve_blend(blend)
        self._program, self._workspace = program or AUDITOR, workspace
        self._deadline = time.monotonic() + self._means.seconds

    def __enter__(self) -> UntrustedBlend:
        self._place = Path(tempfile.mkdtemp(prefix="simworlds-audit-")).resolve()
        try:
            self._process = BlenderProcess(self._launch(self._place))
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
        """Opens another file of the same folder instead, with a fresh time limit. Raises NotScored, CannotStart."""
        path = resolve_blend(blend)
        self._deadline = time.monotonic() + self._means.seconds
        self.ask("open", path=str(path), doing="opening it")

    def ask(self, job: str, *, doing: str, progress: Progress | None = None, **arguments: Any) -> Any:
        """The reply of ``bench/audit/inside/serve.py`` to a job. ``doing``: the job in words, for errors. ``progress``
        gets how much of it is done.

        Raises NotScored, or CannotStart if this Blender lacks a module.
        """
        left = max(0.0, self._deadline - time.monotonic())
        try:
            return self._process.call(
                job, arguments, unread, timeout=left, what=doing, progress=progress
            ).value
        except MissingModule as error:
            raise CannotStart(str(error)) from error
        except Refusal as error:
            raise JobRefused(str(error)[:_LONGEST_REASON]) from error
        except ToolBroke as error:
            raise NotScored(str(error)[:_LONGEST_REASON]) from error
        except TookTooLong:
            raise NotScored(
                f"Blender was still {doing} after its time limit of {self._means.seconds:g} s"
            ) from None
        except Untrustworthy as error:
            raise NotScored(f"Blender's reply after {doing} was not valid") from error
        except Lost as error:
            raise Crashed(f"Blender ended while {doing}: {error.ending or error}") from error

    def _launch(self, place: Path) -> Launch:
        workspace = self._workspace or place / "work"
        workspace.mkdir(exist_ok=True)
        return Launch(
            self._means.runtime(),
            HostileGround(workspace),
            HostileGround(place / "private"),
            best_sandbox(limits=ResourceLimits(memory=self._means.memory, file_size=GIB)),
            self._program,
            (*readable_paths(self._path), *self._means.read),
        )

    def _end(self) -> None:
        """Ends Blender with all its processes, then removes its folder."""
        process: BlenderProcess | None = getattr(self, "_process", None)
        if process is not None:
            process.close()
        HostileGround(self._place).empty()
        with suppress(OSError):
            self._place.rmdir()


def resolve_blend(blend: Path) -> Path:
    """The resolved path of a .blend. Raises NotScored if its first bytes are not those of a .blend."""
    path = blend.expanduser().resolve()
    try:
        if not path.is_file():
            raise NotScored("there is no such file" if not path.exists() else "it is not a file")
        with path.open("rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise NotScored(f"it cannot be read: {error.strerror or error}") from error
    if not head:
        raise NotScored("it is empty")
    if not begins_blend(head):
        raise NotScored("it is not a .blend file")
    return path


def readable_paths(blend: Path) -> tuple[Path, ...]:
    """What Blender may read: the file's folder; if that holds the user's home, only the file and its point caches."""
    folder, home = blend.parent, Path.home().resolve()
    if not home.is_relative_to(folder):
        return (folder,)
    beside = folder / f"blendcache_{blend.stem}"
    return (blend, beside) if beside.is_dir() else (blend,)
