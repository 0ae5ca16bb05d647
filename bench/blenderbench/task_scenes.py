"""A task's scenes in a confined Blender: makes the one to be edited from the raw file, and renders results.

A raw file must not be used before its ``start.py`` has run: that of a camera task already holds the goal's camera.
Both the code and the files are untrusted. They run and are opened in a sandbox (see
simworlds/sandbox/confinement/confined_command.py): no network, nothing written but to a folder that goes with the
process, a deadline, limits of memory and disk.
"""

from __future__ import annotations

import tempfile
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict

from bench.audit.untrusted_blend import AUDITOR
from bench.blenderbench.errors import TaskFailed, UnreadableRender
from bench.blenderbench.pictures import read_picture
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.confinement.confined_command import best_sandbox, default_limits
from simworlds.sandbox.confinement.resource_limits import ResourceLimits
from simworlds.sandbox.errors import BlenderError, CannotStart
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.launch import PRIVATE, Launch, find_blender
from simworlds.sandbox.program import Program
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Generator

    from bench.blenderbench.task_set import BenchTask

SAMPLES = 512
"""Samples of the set's own renders."""
_WORKER = Program(
    "bench.blenderbench.inside.task_worker",
    {**AUDITOR.packages, "bench.blenderbench.inside": Path(__file__).parent / "inside"},
    AUDITOR.largest_reply,
)
_SAVED, _RENDERED = "start.blend", "render.png"
_SCRATCH = ".blender-"
_LISTED = 5


@dataclass(frozen=True, slots=True)
class EditRenderSettings:
    """How scenes are rendered: samples of Cycles, the Blender (by default this environment's) and its limits.

    ``seconds``: of one step in it; ``memory``: in bytes (None: three quarters of the machine's).
    """

    samples: int = SAMPLES
    version: str | None = None
    blender_exe: Path | None = None
    seconds: float = 1800.0
    memory: int | None = None

    @property
    def limits(self) -> ResourceLimits:
        """The limits of a process."""
        return ResourceLimits(memory=self.memory) if self.memory else default_limits()


class Rendered(BaseModel):
    """How a picture was rendered: Blender version, camera, CPU or GPU, samples."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    blender: str
    camera: str
    device: str
    samples: int


def make_start(task: BenchTask, blend: Path, settings: EditRenderSettings) -> tuple[str, ...]:
    """Runs a task's ``start.py`` on its raw file, and saves the scene as ``blend`` with all that can be packed.

    Returns, in words, what could not be packed. Raises TaskFailed for what is the task's fault, CannotStart where no
    Blender works.
    """
    with _opened(task.blend, (task.folder,), blend.parent.parent, settings) as scene:
        width, height = task.size
        scene.ask("prepare", "setting it up", width=width, height=height, samples=settings.samples)
        scene.execute(task.code, "start.py")
        scene.ask("choose_camera", "choosing its camera")
        return scene.save(blend)


def render(blend: Path, picture: Path, size: tuple[int, int], settings: EditRenderSettings) -> Rendered:
    """Renders a scene through its own camera, as ``picture``. Raises TaskFailed, CannotStart."""
    with _opened(blend, (blend,), picture.parent, settings) as scene:
        return scene.render(picture, size, settings.samples)


class _Scene:
    """A file that is open in a Blender of its own."""

    def __init__(self, process: BlenderProcess, launch: Launch, seconds: float) -> None:
        self._process = process
        self._blender = launch.runtime.version
        self._workspace = launch.workspace
        self._seconds = seconds

    def ask(self, job: str, doing: str, **arguments: Any) -> Any:
        """The answer of ``bench/blenderbench/inside/task_worker.py``. Raises BlenderError."""
        return self._process.call(job, arguments, unread, timeout=self._seconds, what=doing).value

    def execute(self, code: str, name: str) -> None:
        """Runs the task's code. Raises TaskFailed where that fails, with the line."""
        failure = self.ask("execute", f"the task's {name}", code=code, name=name)
        if failure is not None:
            line = f", line {failure['line']}" if failure["line"] else ""
            message = " ".join(str(failure["message"]).split())[:300]
            raise TaskFailed(f"{name} fails{line}: {failure['type']}: {message}")

    def save(self, target: Path) -> tuple[str, ...]:
        """Saves the scene with all that can be packed; returns, in words, what it still needs from elsewhere."""
        outside = [
            str(item) for item in self.ask("save", "saving it", path=self._workspace.for_blender(_SAVED))
        ]
        self._workspace.take(_SAVED, target)
        more = [f"and {len(outside) - _LISTED} more"] if len(outside) > _LISTED else []
        return tuple(f"not in the scene to be edited: {item}" for item in (*outside[:_LISTED], *more))

    def render(self, target: Path, size: tuple[int, int], samples: int) -> Rendered:
        """Renders the current frame through the scene's camera."""
        path, (width, height) = self._workspace.for_blender(_RENDERED), size
        answer = self.ask("render", "rendering it", path=path, width=width, height=height, samples=samples)
        self._workspace.take(_RENDERED, target)
        read_picture(target)
        camera, device = str(answer["camera"]), str(answer["device"])
        return Rendered(blender=self._blender, camera=camera, device=device, samples=samples)


@contextmanager
def _opened(
    blend: Path, read: tuple[Path, ...], beside: Path, settings: EditRenderSettings
) -> Generator[_Scene]:
    """A file, open. The process has its folder in ``beside``, on the disk of what is made.

    Raises TaskFailed, CannotStart.
    """
    for left in beside.glob(f"{_SCRATCH}*"):  # by a process that was killed
        _remove(left)
    place = Path(tempfile.mkdtemp(prefix=_SCRATCH, dir=beside)).resolve()
    try:
        workspace = place / "workspace"
        workspace.mkdir()
        runtime = find_blender(settings.version, settings.blender_exe)
        sandbox = best_sandbox(limits=settings.limits)
        ground, private = HostileGround(workspace), HostileGround(place / PRIVATE)
        launch = Launch(runtime, ground, private, sandbox, _WORKER, read)
        process = BlenderProcess(launch)
        try:
            scene = _Scene(process, launch, settings.seconds)
            scene.ask("open", "opening it", path=str(blend))
            yield scene
        finally:
            process.close()
    except CannotStart:
        raise
    except (BlenderError, UnreadableRender) as error:
        raise TaskFailed(f"{blend.name}: {error}") from error
    except (LookupError, TypeError, ValueError) as error:  # code in it may answer in the worker's name
        raise TaskFailed(f"{blend.name}: Blender's reply was not valid ({error})") from error
    finally:
        _remove(place)


def _remove(place: Path) -> None:
    """Removes a folder, whatever code has made of it."""
    HostileGround(place).empty()
    with suppress(OSError):
        place.rmdir()
