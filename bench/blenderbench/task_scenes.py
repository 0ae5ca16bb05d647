"""A task's scenes in a confined Blender: the one to be edited is made of the raw file, and results are rendered.

Nothing looks at a raw file before its ``start.py`` has run: that of a camera task already holds the goal's camera.
Both the code and the files come from strangers. They are run and opened where the scenes that agents build are, which
``simworlds/sandbox/confined_command.py`` describes: no network, nothing written but into a folder that goes with the
process, a deadline, limits of memory and disk.
"""

from __future__ import annotations

import tempfile
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, ConfigDict

from agents.blender.launch import make_launch
from bench.blenderbench.errors import BadPicture, NotDone
from bench.blenderbench.pictures import read_picture
from simworlds.sandbox.blender_process import BlenderProcess
from simworlds.sandbox.confined_command import ResourceLimits, best_sandbox, default_limits
from simworlds.sandbox.errors import BlenderError, CannotStart
from simworlds.sandbox.untrusted_files import take_beneath
from simworlds.sandbox.usage import empty_folder

if TYPE_CHECKING:
    from collections.abc import Generator

    from bench.blenderbench.task_set import Task
    from simworlds.sandbox.launch import Launch

SAMPLES = 512
"""Of Cycles, as the set's own renders have."""
_SETUP = Path(__file__).parent / "inside" / "render_setup.py"
_SAVED, _RENDERED = "start.blend", "render.png"
_SCRATCH = ".blender-"
_LISTED = 5


@dataclass(frozen=True, slots=True)
class Look:
    """How scenes are rendered, and in what: Cycles with so many ``samples``.

    Which Blender (by default this environment's), how long one step in it may take (seconds), how much memory (bytes;
    None: three quarters of the machine's).
    """

    samples: int = SAMPLES
    version: str | None = None
    blender_exe: Path | None = None
    seconds: float = 1800.0
    memory: int | None = None

    @property
    def limits(self) -> ResourceLimits:
        """Of a process."""
        return ResourceLimits(memory=self.memory) if self.memory else default_limits()


class Rendered(BaseModel):
    """What a picture was made with: which Blender, through which camera, on CPU or GPU, with how many samples."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    blender: str
    camera: str
    device: str
    samples: int


def make_start(task: Task, blend: Path, look: Look) -> tuple[str, ...]:
    """Runs a task's ``start.py`` on its raw file, and keeps the scene as ``blend`` with all that can be packed.

    Returns, in words, what did not come along. Raises NotDone for what is the task's fault, CannotStart where no
    Blender works.
    """
    with _opened(task.blend, (task.folder,), blend.parent.parent, look) as scene:
        scene.run(f"settle({task.size[0]}, {task.size[1]}, {look.samples})", "setting it up")
        scene.execute(task.code, "start.py", "the task's start.py")
        scene.run("look_through()", "choosing its camera")
        return scene.save(blend)


def render(blend: Path, picture: Path, size: tuple[int, int], look: Look) -> Rendered:
    """Renders a scene through its own camera, as ``picture``. Raises NotDone, CannotStart."""
    with _opened(blend, (blend,), picture.parent, look) as scene:
        return scene.render(picture, size, look)


class _Scene:
    """A file that is open in a Blender of its own."""

    def __init__(self, process: BlenderProcess, launch: Launch, seconds: float) -> None:
        self._process = process
        self._blender = launch.runtime.version
        self._workspace = launch.workspace
        self._seconds = seconds

    def ask(self, tool: str, what: str, **arguments: Any) -> Any:
        """What a tool of the worker answers. Raises BlenderError."""
        return self._process.call(tool, arguments, timeout=self._seconds, what=what).value

    def run(self, call: str, what: str) -> None:
        """Calls a function of inside/render_setup.py."""
        self.execute(f"{_SETUP.read_text(encoding='utf-8')}\n{call}\n", _SETUP.name, what)

    def execute(self, code: str, name: str, what: str) -> None:
        """Runs code. Raises NotDone where that fails, with the line."""
        failure = self.ask("execute", what, code=code)["error"]
        if failure is not None:
            line = f", line {failure['line']}" if failure["line"] else ""
            said = " ".join(str(failure["message"]).split())[:300]
            raise NotDone(f"{name} fails{line}: {failure['type']}: {said}")

    def save(self, target: Path) -> tuple[str, ...]:
        """Keeps the scene with all that can be packed; in words, what it still wants from elsewhere."""
        written = self.ask(
            "save",
            "saving it",
            path=str(self._workspace / _SAVED),
            beside=f"blendcache_{target.stem}",
            workspace=str(self._workspace),
            pack=True,
        )
        take_beneath(self._workspace, _SAVED, target)
        outside = [f"{one['what']} ({one['path']})" for one in written["external"]]
        outside += [f"cache {below}" for _, below in written["files"]]
        more = [f"and {len(outside) - _LISTED} more"] if len(outside) > _LISTED else []
        return tuple(f"not in the scene to be edited: {one}" for one in (*outside[:_LISTED], *more))

    def render(self, target: Path, size: tuple[int, int], look: Look) -> Rendered:
        """The current frame, through the scene's camera."""
        width, height = size
        asked = {"engine": "cycles", "samples": look.samples, "denoise": None, "camera": None}
        asked |= {"width": width, "height": height, "percentage": None, "even": False}
        plan = self.ask("render_plan", "looking at it", **asked)
        frame, shot = plan["current"], plan["shot"]
        starts = [one["start"] for one in plan["unbaked"]]
        if starts and min(starts) < frame:  # motion that is not baked is never jumped to
            steps = {"first": min(starts), "last": frame - 1, "seconds": self._seconds}
            self.ask("render_step", "playing it", **steps)
        made = {"shot": shot, "frame": frame, "samples": shot["samples"]}
        self.ask("render_frame", "rendering it", path=str(self._workspace / _RENDERED), **made)
        take_beneath(self._workspace, _RENDERED, target)
        read_picture(target)
        camera, device = str(shot["camera"]), str(shot["device"])
        return Rendered(blender=self._blender, camera=camera, device=device, samples=look.samples)


@contextmanager
def _opened(blend: Path, read: tuple[Path, ...], beside: Path, look: Look) -> Generator[_Scene]:
    """A file, open. The process has its folder in ``beside``, on the disk of what is made.

    Raises NotDone, CannotStart.
    """
    for left in beside.glob(f"{_SCRATCH}*"):  # by a process that was killed
        _remove(left)
    place = Path(tempfile.mkdtemp(prefix=_SCRATCH, dir=beside)).resolve()
    try:
        launch = make_launch(
            place / "workspace",
            version=look.version,
            blender_exe=look.blender_exe,
            sandbox=best_sandbox(limits=look.limits),
            read=read,
        )
        process = BlenderProcess(launch)
        try:
            scene = _Scene(process, launch, look.seconds)
            scene.ask("load", "opening it", path=str(blend), workspace=str(launch.workspace), lent=False)
            yield scene
        finally:
            process.close()
    except CannotStart:
        raise
    except (BlenderError, BadPicture) as error:
        raise NotDone(f"{blend.name}: {error}") from error
    except (LookupError, TypeError, ValueError) as error:  # code in it may answer in the worker's name
        raise NotDone(f"{blend.name}: Blender answered what it was not asked ({error})") from error
    finally:
        _remove(place)


def _remove(place: Path) -> None:
    """Whatever code has made of it."""
    empty_folder(place)
    with suppress(OSError):
        place.rmdir()
