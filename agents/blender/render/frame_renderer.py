"""Drives Blender through a rendering, a frame a call, and goes on where a lost Blender stopped."""

from __future__ import annotations

import secrets
import shutil
import tempfile
import time
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simworlds.sandbox.errors import BlenderError, Died, Interrupted, Lost, Refusal

if TYPE_CHECKING:
    import threading
    from collections.abc import Sequence

    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call

_STEP_SECONDS = 20.0  # of stepping through a simulation in one call
_PART = 0.95  # of a frame, that is told as progress while it is made
_LONGEST = 400  # characters of what is told of a loss that was got over
_PATIENCE = 10.0  # seconds: a frame that takes no longer is waited for when the call is given up


class Shoot:
    """A rendering of the scene as it stands. Use it in ``with``: the scene goes back to its frame at the end.

    ``timeout`` (seconds) is for one frame, and for each other step. Raises BlenderError.
    """

    def __init__(self, blender: Supervisor, call: Call, asked: dict[str, Any], timeout: float) -> None:
        self._blender = blender
        self._call = call
        self._asked = asked
        self._timeout = timeout
        self._patient = True
        self._at: int | None = None
        self._pid: int | None = None  # of the Blender that the scene's state is relied on in
        self._moved: int | None = None  # of the one that does not stand at its own frame any more
        self._what, self._done, self._total = "", 0.0, 0.0
        self.notes: list[str] = []
        blender.keep("before rendering")
        self._plan = self._planned()
        self.notes += self._plan["notes"]
        starts = [int(one["start"]) for one in self.unbaked]
        self._start = min(starts) if starts else None

    def __enter__(self) -> Shoot:
        return self

    def __exit__(self, *error: object) -> None:
        if self._blender.pid != self._moved:
            return  # another Blender has come, which stands where this one was before
        with suppress(BlenderError):
            back = {"frame": self._plan["current"], "subframe": self._plan["subframe"], "first": self._next}
            self._blender.call("render_put_back", back, timeout=self._timeout)

    @property
    def shot(self) -> dict[str, Any]:
        """What is rendered: engine, device, samples, denoise, width, height, camera."""
        return self._plan["shot"]

    @property
    def scene(self) -> dict[str, str]:
        """A digest for every data-block that the pictures depend on."""
        return self._plan["scene"]

    @property
    def unbaked(self) -> list[dict[str, Any]]:
        """The simulations for whose sake frames are not jumped: ``label``, and ``start``, their first frame."""
        return self._plan["unbaked"]

    def standing(self, name: str) -> Any:
        """Of the scene itself: ``current``, ``frame_start``, ``frame_end``, ``fps``, ``fps_base``."""
        return self._plan[name]

    def frame(self, frame: int, samples: int | None, target: Path, done: float, total: float) -> float:
        """Renders a frame into ``target``; returns the seconds it took.

        When Blender is lost over it, the frame is tried once more. ``done`` of ``total`` frames are told as progress.
        """
        self._done, self._total = done, total
        try:
            return self._frame(frame, samples, target)
        except Interrupted:
            raise
        except Lost as error:
            self.notes.append(
                f"Blender was lost over frame {frame}, which was tried once more: {str(error)[:_LONGEST]}"
            )
        self._come_back()
        return self._frame(frame, samples, target)

    def film(self, pictures: Sequence[Path], target: Path) -> dict[str, Any]:
        """Makes ``target`` (MP4) of pictures, one a frame; returns what is read back from it."""
        self._what, self._pid = "the video", None  # whichever Blender makes it
        folder = self._blender.folder.workspace
        lent = Path(tempfile.mkdtemp(prefix=".film-", dir=folder))
        made = f"{lent.name}/film.mp4"
        try:
            for path in {*pictures}:
                shutil.copyfile(path, lent / path.name)
            arguments: dict[str, Any] = {
                "folder": str(lent),
                "pictures": [path.name for path in pictures],
                "path": str(folder / made),
                "width": self.shot["width"],
                "height": self.shot["height"],
                "fps": self._plan["fps"],
                "fps_base": self._plan["fps_base"],
            }
            found = self._ask("render_video", arguments, extra=len(pictures))
            self._blender.folder.take(made, target)
        finally:
            shutil.rmtree(lent, ignore_errors=True)
        wanted = (len(pictures), self.shot["width"], self.shot["height"])
        if (found["frames"], found["width"], found["height"]) != wanted:
            raise Refusal(f"The video is not what it should be: {found}, for {wanted}.")
        return found

    @property
    def _next(self) -> int | None:
        """The frame from which to step on; None where nothing is simulated."""
        if self._start is None or self._at is None:
            return self._start
        return max(self._start, self._at + 1)

    # In Blender

    def _planned(self) -> dict[str, Any]:
        self._what, self._patient, self._pid = "the scene", True, None
        found = self._ask("render_plan", self._asked)
        self._patient, self._pid = False, self._blender.pid
        self._moved = self._pid
        return found

    def _frame(self, frame: int, samples: int | None, target: Path) -> float:
        self._what = f"frame {frame}"
        self._walk(frame)
        made = f".frame-{secrets.token_hex(6)}.png"
        path = self._blender.folder.workspace / made
        arguments: dict[str, Any] = {
            "shot": self.shot,
            "frame": frame,
            "samples": samples,
            "path": str(path),
        }
        started = time.monotonic()
        try:
            self._ask("render_frame", arguments)
            self._blender.folder.take(made, target)
        finally:
            with suppress(OSError):
                path.unlink(missing_ok=True)
        self._at = frame
        seconds = time.monotonic() - started
        self._patient = seconds < _PATIENCE
        return seconds

    def _walk(self, frame: int) -> None:
        """Steps through what is simulated up to the frame before; what is baked can be jumped to."""
        at = self._next
        if at is None:
            return
        while at < frame:
            steps = {"first": at, "last": frame - 1, "seconds": _STEP_SECONDS}
            at = 1 + int(self._ask("render_step", steps))
            self._at = at - 1
            if self._call.given_up.is_set():
                raise Interrupted("Rendering was given up while the simulation was stepped through")

    def _ask(self, key: str, arguments: dict[str, Any], *, extra: float = 0.0) -> Any:
        """Calls Blender; ``extra`` seconds are added to the deadline. What it reports is told as part of a frame."""

        def told(share: float, of: float | None, text: str) -> None:
            if self._call.progress is not None:
                part = _PART * share / of if of else 0.0
                self._call.progress(self._done + part, self._total or None, f"{self._what}: {text}")

        reply = self._blender.call(
            key,
            arguments,
            timeout=self._timeout + extra,
            what=f"rendering {self._what}",
            progress=told,
            given_up=self._given_up,
        )
        if self._pid not in {None, self._blender.pid}:
            raise Died("Blender had ended, and another one was started")
        return reply.value

    @property
    def _given_up(self) -> threading.Event | None:
        """Killing Blender over a frame that is nearly done would take longer than the frame."""
        return None if self._patient else self._call.given_up

    def _come_back(self) -> None:
        """After Blender was lost: the scene must be the one that was begun with."""
        self._at = None
        before = self.scene
        again = self._planned()
        if again["scene"] != before:
            raise Refusal(
                "Blender came back with another scene than rendering began with; call again to render that one."
            )
