"""How a Blender is started: its confined command, its environment, its folders."""

from __future__ import annotations

import sys
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from simworlds.sandbox.confinement.control_group import ControlGroup, group_parents
from simworlds.sandbox.errors import CannotStart, NotInstalled, RuntimeMissing
from simworlds.sandbox.program import BOOT, Program
from simworlds.sandbox.runtime import Runtime, clean_environment, find_runtime
from simworlds.sandbox.shader_cache import IN_ONE_FILE, lend_shaders
from simworlds.sandbox.watch.usage import UsageMonitor
from simworlds.settings import home_folder
from simworlds.terminal.progress import shown_progress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from simworlds.sandbox.confinement.confined_command import Sandbox
    from simworlds.sandbox.hostile_ground import HostileGround

PRIVATE = "private"  # the name of a folder for temporary files, beside the workspace
LENT = "lent"  # the name of a folder of files that Blender is to load, beside the workspace
HALF_WRITTEN = ".blend@"  # the end of a file's name while Blender writes it


@dataclass(frozen=True)
class Launch:
    """Starts ``runtime`` in ``workspace``, the only folder besides ``private`` that it may write to.

    ``private`` is for temporary files; it is emptied at each start, and removed by ``clean``. ``read`` are further
    folders that it may read (assets). ``lent`` is one of ours for files that it is to load, which it cannot change;
    it comes and goes as ``private`` does. ``program`` runs in it, and gets the number of a descriptor.
    """

    runtime: Runtime
    workspace: HostileGround
    private: HostileGround
    sandbox: Sandbox
    program: Program
    read: tuple[Path, ...] = field(default=())
    lent: HostileGround | None = None

    def command(self, channel: int) -> list[str]:
        """The command's words; ``channel`` is the descriptor of the program's socket."""
        words = self.runtime.command(BOOT, self.program.arguments(str(channel)))
        readable = [*self.program.folders, *_folders_of(self.runtime), *self.read]
        if self.lent is not None:
            readable.append(self.lent.mount)
        writable = [self.workspace.mount, self.private.mount]
        return self.sandbox.command(words, read=readable, write=writable, group=self.group.folders)

    @cached_property
    def group(self) -> ControlGroup:
        """The control group of the running worker."""
        down = "memory" in self.sandbox.without
        return ControlGroup(self.sandbox.limits, None if down else group_parents())

    @cached_property
    def environment(self) -> dict[str, str]:
        """Without the user's secrets and Blender settings; temporary files go to ``private``."""
        private = self.private.for_blender()
        names = ("HOME", "TMPDIR", "TEMP", "TMP", "XDG_CACHE_HOME", "XDG_RUNTIME_DIR")
        own = dict.fromkeys(names, private)
        own |= {"PYTHONDONTWRITEBYTECODE": "1", **IN_ONE_FILE}
        return clean_environment(self.private.mount) | own

    @property
    def folders(self) -> tuple[HostileGround, HostileGround]:
        """The folders that it may write to."""
        return self.workspace, self.private

    @cached_property
    def usage(self) -> UsageMonitor:
        """The check of what it uses, against the sandbox's limits."""
        return UsageMonitor(self.folders, self.sandbox.limits)

    @property
    def _passing(self) -> tuple[HostileGround, ...]:
        """The folders that come and go with the process."""
        return (self.private, *([self.lent] if self.lent is not None else []))

    def prepare(self) -> None:
        """Makes the private folder, empty but for shaders, and the lent one, and removes what was left half written.

        Raises CannotStart.
        """
        for folder in self._passing:
            try:
                folder.make()
            except OSError as error:
                raise CannotStart(f"{folder.mount} cannot be made: {error.strerror or error}") from error
            folder.empty()
        lend_shaders(self.private)
        self.group.renew()
        self.workspace.remove_named(HALF_WRITTEN)

    def clean(self) -> None:
        """Removes the private and the lent folder, half-written files and the control group."""
        self.group.close()
        for folder in self._passing:
            folder.empty()
            with suppress(OSError):
                folder.mount.rmdir()
        self.workspace.remove_named(HALF_WRITTEN)


def find_blender(
    version: str | None = None, blender_exe: Path | None = None, *, install: bool = True
) -> Runtime:
    """The Blender to work in; a missing one is installed, which takes minutes, and is told.

    Raises CannotStart; NotInstalled without leave to ``install``.
    """
    try:
        with shown_progress() as progress:
            return find_runtime(
                version, home=home_folder(), blender_exe=blender_exe, progress=progress, install=install
            )
    except NotInstalled:
        raise
    except RuntimeMissing as error:
        raise CannotStart(f"No Blender was found: {error}") from error


def _folders_of(runtime: Runtime) -> Iterator[Path]:
    """The folders of the interpreter and its libraries."""
    real = runtime.executable.resolve()
    if runtime.kind == "executable":
        # A release has a folder of its own; Debian's is in system folders, which can be read anyway.
        if not real.is_relative_to("/usr"):
            yield real.parent
        return
    # The virtual environment, and the Python that it was made from.
    yield runtime.executable.parent.parent
    yield real.parent.parent
    if runtime.kind == "environment":
        yield Path(sys.base_prefix)
