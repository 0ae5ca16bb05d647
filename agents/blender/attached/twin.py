"""A copy of the open scene in a sandboxed Blender of our own: for looking, and for rehearsing code."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from pydantic import Field

from agents.blender.launch import WORKER, launch_in
from agents.blender.supervisor import Supervisor
from simworlds.releases import minor_of, version_key
from simworlds.sandbox.errors import CannotStart, NotInstalled, Refusal
from simworlds.sandbox.launch import find_blender
from simworlds.sandbox.program import Program
from simworlds.sandbox.replies import Claim, Count, Name, Place, mapping

if TYPE_CHECKING:
    import threading
    from collections.abc import Callable, Sequence

    from agents.blender.attached.attached_blender import AttachedBlender
    from agents.blender.files.run_folder import RunFolder
    from simworlds.sandbox.confinement.confined_command import Sandbox
    from simworlds.sandbox.runtime import Runtime

COPY_SECONDS = 5.0
DRAWN_SOON = {"objects": 1000, "triangles": 4_000_000, "seconds": 1.0}
"""What is copied, opened and drawn within two seconds, with or without a graphics card."""
_WRITE_SECONDS = 60.0
_LOAD_SECONDS = 120.0
_PROGRAM = Program("simworlds_worker.attached.twin_worker", WORKER.packages)


class _Written(Claim):
    """What the open Blender wrote of its scene, and the tool by which the twin opens it."""

    loads: ClassVar[str] = "load"
    bytes: Count
    seconds: float = Field(ge=0)
    folders: list[Place] = Field(max_length=40)

    def load_arguments(self) -> dict[str, Any]:
        """What that tool needs to know of it."""
        return {}


class _Copy(_Written):
    """All of it."""

    file: Place
    unsaved: list[Name] = Field(max_length=40)


class _Part(_Written):
    """A part: these ``objects``."""

    loads: ClassVar[str] = "load_part"
    objects: list[Name] = Field(max_length=100_000)
    scene: dict[str, Any]

    def load_arguments(self) -> dict[str, Any]:
        """The settings of the scene, which itself is not in the part."""
        return {"scene": self.scene}


W = TypeVar("W", bound=_Written)


class Twin:
    """The sandboxed Blender beside the open one: of the same program if that starts there, else this environment's."""

    def __init__(self, folder: RunFolder, sandbox: Sandbox, tell: Callable[[str], object]) -> None:
        self._folder, self._sandbox, self._tell = folder, sandbox, tell
        self._supervisor: Supervisor | None = None
        self._read: set[str] = set()
        self._program = ""

    def refreshed(
        self, attached: AttachedBlender, cancelled: threading.Event | None = None, *, soon: bool = False
    ) -> Supervisor:
        """The supervisor of a Blender that has the open scene as it is now. ``soon``: only if it can be drawn within
        a moment. Raises BlenderError."""
        most = DRAWN_SOON if soon else {}
        supervisor, copy = self._brought(attached, "write_copy", most, _Copy, cancelled)
        if copy.unsaved:
            attached.note_once(
                f"Painted and not saved, so as before in pictures: {', '.join(copy.unsaved)} (Image > Save or Pack)."
            )
        return supervisor

    def part_of_code(
        self, attached: AttachedBlender, code: str, cancelled: threading.Event | None = None
    ) -> tuple[Supervisor, list[str]]:
        """The same of one that has what the code touches alone, and its objects. Raises BlenderError."""
        supervisor, part = self._brought(attached, "write_part", {"code": code}, _Part, cancelled)
        return supervisor, part.objects

    def part_named(
        self, attached: AttachedBlender, names: Sequence[str], cancelled: threading.Event | None = None
    ) -> Supervisor:
        """The same of one that has what bears these names alone, if it can be drawn soon. Raises BlenderError."""
        return self._brought(attached, "write_part", {"names": [*names], **DRAWN_SOON}, _Part, cancelled)[0]

    def _brought(
        self,
        attached: AttachedBlender,
        write: str,
        arguments: dict[str, Any],
        kind: type[W],
        cancelled: threading.Event | None,
    ) -> tuple[Supervisor, W]:
        supervisor = self.started(attached)
        with self._folder.lending() as lent:
            path = lent / "open.blend"
            written = attached.call(
                write,
                {"seconds": COPY_SECONDS, **arguments, "path": str(path)},
                kind.model_validate,
                timeout=_WRITE_SECONDS,
                what="copying the scene",
                cancelled=cancelled,
            ).value
            new = {*written.folders} - self._read
            if not new:
                self._load(supervisor, written, path, cancelled)
                return supervisor, written
        # The sandbox must let it read other folders, which it learns when it starts.
        self._read |= new
        self.close()
        return self._brought(attached, write, arguments, kind, cancelled)

    @staticmethod
    def _load(
        supervisor: Supervisor, written: _Written, path: Path, cancelled: threading.Event | None
    ) -> None:
        path.chmod(0o644)
        supervisor.call(
            written.loads,
            {
                **written.load_arguments(),
                "path": str(path),
                "workspace": supervisor.folder.workspace.for_blender(),
            },
            mapping,
            timeout=_LOAD_SECONDS,
            what="opening the copy",
            cancelled=cancelled,
        )
        supervisor.take_note()

    def started(self, attached: AttachedBlender) -> Supervisor:
        """The supervisor, of whatever scene. Raises CannotStart."""
        about = attached.about
        if self._supervisor is not None and self._program == about.executable:
            return self._supervisor
        self.close()
        supervisor = self._start_best(attached)
        self._supervisor, self._program = supervisor, about.executable
        return supervisor

    def _start_best(self, attached: AttachedBlender) -> Supervisor:
        """The open Blender's own program, else its version as a package, else the usual one. Raises CannotStart."""
        about = attached.about
        version = minor_of(about.version)
        try:
            own = find_blender(None, Path(about.executable))
            if minor_of(own.version) != version:
                raise CannotStart(f"{about.executable or 'its program'} is Blender {own.version} now")
            return self._start(own)
        except CannotStart as error:
            why = error
        with suppress(CannotStart, NotInstalled):
            return self._start(find_blender(version, install=False))
        supervisor = self._start(find_blender())
        other = supervisor.launch.runtime.version
        if version_key(minor_of(other)) < version_key(version):
            supervisor.close()
            raise CannotStart(
                f"Blender {about.version} does not start in the sandbox ({why}), and {other} is older: nothing can be "
                "drawn or rehearsed here"
            ) from why
        attached.note_once(
            f"Copies are looked at and code is rehearsed in Blender {other}, not {about.version}: {why}."
        )
        return supervisor

    def _start(self, runtime: Runtime) -> Supervisor:
        read = tuple(Path(folder) for folder in sorted(self._read))
        launch = launch_in(self._folder.workspace, runtime, sandbox=self._sandbox, read=read)
        supervisor = Supervisor(replace(launch, program=_PROGRAM), self._folder)
        try:
            supervisor.start()
        except BaseException:
            supervisor.close()
            raise
        return supervisor

    @property
    def running(self) -> Supervisor:
        """The supervisor that runs. Raises Refusal if none does."""
        if self._supervisor is None:
            raise Refusal("The copy's Blender does not run.")
        return self._supervisor

    def end(self) -> None:
        """From any thread: a running call ends, and nothing is started again."""
        if self._supervisor is not None:
            self._supervisor.end()
            self._supervisor.kill()

    def close(self) -> None:
        """Ends its Blender."""
        supervisor, self._supervisor = self._supervisor, None
        if supervisor is not None:
            supervisor.close()
