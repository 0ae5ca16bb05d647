"""What a Blender is started with: its command, confined, its environment, its folders."""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.errors import CannotStart, RuntimeMissing
from simworlds.sandbox.program import BOOT, Program
from simworlds.sandbox.runtime import Runtime, clean_environment, find_runtime
from simworlds.sandbox.usage import Bounds, remove_named, sweep
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.confinement import Sandbox

PRIVATE = "private"  # the name of a folder for temporary files, beside the workspace
HALF_WRITTEN = ".blend@"  # how Blender calls a file until it is whole


@dataclass(frozen=True)
class Launch:
    """``runtime`` is started in ``workspace``, the only place besides ``private`` that it may write to.

    ``private`` is for temporary files; it is emptied at each start, and gone after ``clean``. ``read`` are further
    folders that it may read (assets). ``program`` runs in it, and gets the number of a descriptor.
    """

    runtime: Runtime
    workspace: Path
    private: Path
    sandbox: Sandbox
    program: Program
    read: tuple[Path, ...] = field(default=())

    def command(self, channel: int) -> list[str]:
        """The words to start; ``channel`` is the descriptor of the program's socket."""
        words = self.runtime.command(BOOT, self.program.arguments(str(channel)))
        readable = [*self.program.folders, *_folders_of(self.runtime), *self.read]
        return self.sandbox.command(words, read=readable, write=[self.workspace, self.private])

    @cached_property
    def environment(self) -> dict[str, str]:
        """No secret of the user's, no setting of the user's Blender; temporary files in ``private``."""
        private = str(self.private)
        names = ("HOME", "TMPDIR", "TEMP", "TMP", "XDG_CACHE_HOME", "XDG_RUNTIME_DIR")
        own = dict.fromkeys(names, private)
        return clean_environment(self.private) | own | {"PYTHONDONTWRITEBYTECODE": "1"}

    @property
    def folders(self) -> tuple[Path, Path]:
        """The folders that it may write to."""
        return self.workspace, self.private

    @cached_property
    def bounds(self) -> Bounds:
        """The watch over what is written there; what lies there when it is first asked for is no fault."""
        return Bounds(self.folders, self.sandbox.limits)

    def prepare(self) -> None:
        """Makes the private folder, empty: nothing that an earlier Blender left there is read by the next one.

        Halves of files that an earlier one was killed over are removed from the workspace. Raises CannotStart.
        """
        try:
            self.private.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise CannotStart(f"{self.private} cannot be made: {error.strerror or error}") from error
        sweep(self.private)
        remove_named(self.workspace, HALF_WRITTEN)

    def clean(self) -> None:
        """Removes the private folder, and halves of files."""
        sweep(self.private)
        with suppress(OSError):
            self.private.rmdir()
        remove_named(self.workspace, HALF_WRITTEN)


def find_blender(version: str | None = None, blender_exe: Path | None = None) -> Runtime:
    """The Blender to work in; one that is not there yet is made, which takes minutes. Raises CannotStart."""
    try:
        return find_runtime(version, home=home_folder(), blender_exe=blender_exe)
    except RuntimeMissing as error:
        raise CannotStart(f"No Blender to work in: {error}") from error


def _folders_of(runtime: Runtime) -> Iterator[Path]:
    """Where the interpreter and its libraries lie."""
    real = runtime.executable.resolve()
    if runtime.kind == "executable":
        # A release lies in a folder of its own; Debian's in folders of the system, which can be read anyway.
        if not real.is_relative_to("/usr"):
            yield real.parent
        return
    # Of a virtual environment, and of the Python that it was made from.
    yield runtime.executable.parent.parent
    yield real.parent.parent
    if runtime.kind == "environment":
        yield Path(sys.base_prefix)
