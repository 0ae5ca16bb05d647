"""One untrusted .blend in a Blender of its own: confined, within a deadline and a limit of memory, asked over a socket.

The file is only read, and so is the folder that it lies in (for its caches and libraries); no script of it runs, there
is no network, and nothing can be written but a temporary folder that goes with the process. Whatever Blender prints
goes to a file that nobody believes. A process that crashes, hangs or answers what it was not asked ends the matter:
the file is not scored, and the exception says why.
"""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.confined_command import GIB, ResourceLimits, best_sandbox
from simworlds.sandbox.errors import (
    CannotStart,
    Lost,
    MissingModule,
    Refusal,
    TookTooLong,
    ToolBroke,
    Untrustworthy,
)
from simworlds.sandbox.launch import Launch, find_blender
from simworlds.sandbox.program import SHARED, Program

if TYPE_CHECKING:
    from types import TracebackType

    from simworlds.sandbox.runtime import Runtime

INSIDE = Path(__file__).parent / "inside"
AUDITOR = Program("bench.audit.inside.serve", {**SHARED, "bench.audit.inside": INSIDE})
_LONGEST_REASON = 600
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

    ``program`` answers what is asked; ``workspace`` is where Blender may write, by default a folder that goes with it.
    """

    def __init__(
        self,
        blend: Path,
        means: Means | None = None,
        program: Program | None = None,
        workspace: Path | None = None,
    ) -> None:
        self._means = means or Means()
        self._path = checked(blend)
        self._program, self._workspace = program or AUDITOR, workspace
        self._deadline = time.monotonic() + self._means.seconds

    def __enter__(self) -> Untrusted:
        self._place = tempfile.TemporaryDirectory(prefix="simworlds-audit-", ignore_cleanup_errors=True)
        try:
            self._process = BlenderProcess(self._launch(Path(self._place.name).resolve()))
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
        """What ``bench/audit/inside/serve.py`` answers. ``doing``: in words, for errors.

        Raises NotScored, and CannotStart where this Blender lacks something.
        """
        left = max(0.0, self._deadline - time.monotonic())
        try:
            return self._process.call(job, arguments, timeout=left, what=doing).value
        except MissingModule as error:
            raise CannotStart(str(error)) from error
        except Refusal as error:
            raise Refused(str(error)[:_LONGEST_REASON]) from error
        except ToolBroke as error:
            raise NotScored(str(error)[:_LONGEST_REASON]) from error
        except TookTooLong:
            raise NotScored(
                f"Blender was still {doing} when its {self._means.seconds:g} s were over"
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
            workspace,
            place / "private",
            best_sandbox(limits=ResourceLimits(memory=self._means.memory, file_size=GIB)),
            self._program,
            (*readable(self._path), *self._means.read),
        )

    def _end(self) -> None:
        """Lets Blender end, or kills it with all it has started; then removes its folder."""
        process: BlenderProcess | None = getattr(self, "_process", None)
        if process is not None:
            process.close()
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
