"""Drives Blender through a render, one frame per call, and goes on after a Blender that was lost."""

from __future__ import annotations

import secrets
import time
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from agents.blender.render.picture_numbers import subjects_of
from agents.blender.render.replies import RenderPlan, SubjectMask, VideoFacts
from simworlds.sandbox.errors import BlenderError, Died, Interrupted, Lost, Refusal
from simworlds.sandbox.hostile_ground import copy_to
from simworlds.sandbox.replies import Reader, T, nothing

if TYPE_CHECKING:
    import threading
    from collections.abc import Sequence
    from pathlib import Path

    from PIL import Image

    from agents.blender.render.picture_numbers import SubjectNumbers
    from agents.blender.render.replies import Shot, UnbakedCache
    from agents.blender.supervisor import Supervisor
    from agents.blender.tools.base import Call
    from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

_STEP_SECONDS = 20.0  # of stepping through a simulation in one call
_LONGEST = 400  # characters of the note about a lost Blender
_MASK = 256  # pixels, of the longer side of the picture by which subjects are measured
_PATIENCE = 10.0  # seconds: a frame that takes no longer is finished when the call is cancelled


class FrameRenderer:
    """Renders the scene as it is now. Use it in ``with``: the scene goes back to its frame at the end.

    ``timeout`` (seconds) is for one frame, and for each other step. Raises BlenderError.
    """

    def __init__(self, blender: Supervisor, call: Call, wanted: dict[str, Any], timeout: float) -> None:
        self._blender = blender
        self._call = call
        self._wanted = wanted
        self._timeout = timeout
        self._patient = True
        self._at: int | None = None
        self._pid: int | None = None  # of the Blender that holds the planned scene
        self._moved: int | None = None  # of the Blender that has left the scene's own frame
        self._what, self._done, self._total, self._share = "", 0.0, 0.0, 0.0
        self.notes: list[str] = []
        blender.keep("before rendering")
        self._plan = self._make_plan()
        self.notes += self._plan.notes
        starts = [cache.start for cache in self.unbaked]
        self._start = min(starts) if starts else None

    def __enter__(self) -> FrameRenderer:
        return self

    def __exit__(self, *error: object) -> None:
        if self._blender.pid != self._moved:
            return  # a new Blender stands where this one was before
        with suppress(BlenderError):
            back = {"frame": self._plan.current, "subframe": self._plan.subframe, "first": self._next}
            self._blender.call("render_put_back", back, nothing, timeout=self._timeout)

    @property
    def shot(self) -> Shot:
        """What is rendered."""
        return self._plan.shot

    @property
    def pictures(self) -> PictureDecoder:
        """What reads the rendered pictures."""
        return self._blender.pictures

    @property
    def plan(self) -> RenderPlan:
        """What Blender has said of the scene."""
        return self._plan

    @property
    def at(self) -> int | None:
        """The frame that was rendered last, at which the scene stands."""
        return self._at

    @property
    def unbaked(self) -> list[UnbakedCache]:
        """Unbaked simulations, because of which frames are stepped."""
        return self._plan.unbaked

    def render(
        self, frame: int, samples: int | None, target: Path, span: tuple[float, float], total: float
    ) -> float:
        """Renders a frame into ``target``; returns the seconds it took. Its progress fills ``span`` of ``total``.

        If Blender is lost meanwhile, the frame is tried once more.
        """
        self._done, self._share, self._total = span[0], span[1] - span[0], total
        try:
            return self._render(frame, samples, target)
        except Interrupted:
            raise
        except Lost as error:
            self.notes.append(
                f"Blender was lost during frame {frame}, which was retried: {str(error)[:_LONGEST]}"
            )
        self._plan_again()
        return self._render(frame, samples, target)

    def make_video(self, frames: Sequence[Path], target: Path) -> VideoFacts:
        """Makes ``target`` (MP4) of images, one a frame; returns what is read back from it. Raises Refusal where it has
        another length or size than asked for.
        """
        self._what, self._pid = "the video", None  # any Blender can make it
        workspace = self._blender.folder.workspace
        video = f".film-{secrets.token_hex(6)}.mp4"
        try:
            with self._blender.folder.lending() as lent:
                for path in {*frames}:
                    with path.open("rb") as file:
                        copy_to(file, lent / path.name, durable=False)
                arguments: dict[str, Any] = {
                    "folder": str(lent),
                    "pictures": [path.name for path in frames],
                    "path": workspace.for_blender(video),
                    "width": self.shot.width,
                    "height": self.shot.height,
                    "fps": self._plan.fps,
                    "fps_base": self._plan.fps_base,
                }
                facts = self._ask("render_video", arguments, VideoFacts.model_validate, extra=len(frames))
            workspace.take(video, target)
        finally:
            workspace.remove(video)
        wanted = (len(frames), self.shot.width, self.shot.height)
        if (facts.frames, facts.width, facts.height) != wanted:
            raise Refusal(f"The video does not match its frames: it has {facts}, expected {wanted}.")
        return facts

    def subjects(self, picture: Image.Image) -> list[SubjectNumbers]:
        """What a picture of the frame that was rendered last shows of each object. Raises BlenderError."""
        self._what = "the measuring of subjects"
        scale = min(1.0, _MASK / max(self.shot.width, self.shot.height))
        size = [max(8, round(side * scale)) for side in (self.shot.width, self.shot.height)]
        workspace = self._blender.folder.workspace
        asked = {"camera": self.shot.camera, "size": size, "folder": workspace.for_blender()}
        mask = self._ask("subject_mask", asked, SubjectMask.model_validate)
        if mask.file is None:
            return []
        try:
            with workspace.open(mask.file) as file:
                drawn = self.pictures.decode(file, mask.file, longest=_MASK, under=(0, 0, 0)).image
        finally:
            workspace.remove(mask.file)
        return subjects_of(picture, drawn, {colour: name for name, colour in mask.subjects}, mask.clear)

    @property
    def _next(self) -> int | None:
        """The frame from which to step on; None where nothing is simulated."""
        if self._start is None or self._at is None:
            return self._start
        return max(self._start, self._at + 1)

    # In Blender

    def _make_plan(self) -> RenderPlan:
        self._what, self._patient, self._pid = "the scene", True, None
        plan = self._ask("render_plan", self._wanted, RenderPlan.model_validate)
        self._patient, self._pid = False, self._blender.pid
        self._moved = self._pid
        return plan

    def _plan_again(self) -> None:
        """After Blender was lost: the scene must be the one that rendering began with."""
        self._at = None
        if self._make_plan().scene != self._plan.scene:
            raise Refusal(
                "The scene is no longer the one that rendering began with, since Blender was restarted from a "
                "checkpoint. Call again to render the scene as it is now."
            )

    def _render(self, frame: int, samples: int | None, target: Path) -> float:
        self._what = f"frame {frame}"
        self._step_to(frame)
        workspace, name = self._blender.folder.workspace, f".frame-{secrets.token_hex(6)}.png"
        shot, path = self.shot.settings, workspace.for_blender(name)
        started = time.monotonic()
        try:
            self._ask(
                "render_frame", {"shot": shot, "frame": frame, "samples": samples, "path": path}, nothing
            )
            workspace.take(name, target)
        finally:
            workspace.remove(name)
        self._at = frame
        seconds = time.monotonic() - started
        self._patient = seconds < _PATIENCE
        return seconds

    def _step_to(self, frame: int) -> None:
        """Steps through simulations up to the frame before this one; baked ones are jumped to."""
        at = self._next
        if at is None:
            return
        while at < frame:
            steps = {"first": at, "last": frame - 1, "seconds": _STEP_SECONDS}
            at = 1 + self._ask("render_step", steps, partial(_reached, at, frame - 1))
            self._at = at - 1
            if self._call.cancelled.is_set():
                raise Interrupted("Rendering was cancelled while the simulation was stepped through")

    def _ask(self, key: str, arguments: dict[str, Any], read: Reader[T], *, extra: float = 0.0) -> T:
        """Calls Blender; ``extra`` seconds are added to the deadline. Its progress is reported as part of a frame."""

        def report(done: float, total: float | None, text: str) -> None:
            if self._call.progress is not None:
                share = self._share * done / total if total else 0.0
                self._call.progress(self._done + share, self._total or None, f"{self._what}: {text}")

        reply = self._blender.call(
            key,
            arguments,
            read,
            timeout=self._timeout + extra,
            what=f"rendering {self._what}",
            progress=report,
            cancelled=self._cancelled,
        )
        if self._pid not in {None, self._blender.pid}:
            raise Died("Blender had ended, and a new one was started")
        return reply.value

    @property
    def _cancelled(self) -> threading.Event | None:
        """Killing Blender over a frame that is nearly done would take longer than the frame."""
        return None if self._patient else self._call.cancelled


def _reached(first: int, last: int, value: Any) -> int:
    """The frame that a simulation was stepped to, in this range: each call gets at least one frame on."""
    if not isinstance(value, int) or not first <= value <= last:
        raise ValueError(f"it was to be stepped through frames {first} to {last}")
    return value
