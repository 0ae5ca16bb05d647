"""Blender's reply about motion."""

from __future__ import annotations

from typing import Annotated

from pydantic import ConfigDict, Field, model_validator

from simworlds.sandbox.replies import Claim, Frame

Text = Annotated[str, Field(max_length=1000)]
Vector = tuple[float, float, float]
Side = Annotated[int, Field(ge=16, le=2048)]
_MOST_ACTORS, _MOST_PICTURES, _MOST_FRAMES, _MOST_PHASES = 8, 12, 1500, 100


class _Reply(Claim):
    """Base of its parts; Blender tells more than is drawn."""

    model_config = ConfigDict(extra="ignore")


class ShotView(_Reply):
    """An orthographic view: unit vectors to the right, up and towards the viewer; the centre; the scale."""

    axes: tuple[Vector, Vector, Vector]
    centre: Vector
    metres_per_pixel: float = Field(gt=0)
    size: tuple[Side, Side]

    def pixel(self, place: Vector) -> tuple[float, float]:
        """The pixel of a point in the world."""
        offset = [a - b for a, b in zip(place, self.centre, strict=True)]
        right, up, _ = (sum(a * b for a, b in zip(offset, axis, strict=True)) for axis in self.axes)
        width, height = self.size
        return width / 2 + right / self.metres_per_pixel, height / 2 - up / self.metres_per_pixel


class Shot(_Reply):
    """One image; ``view`` is None if the actor is absent at that frame."""

    frame: Frame
    view: ShotView | None


class Strip(_Reply):
    """The images of one kind of view: ``path`` (the whole path) or ``close``."""

    kind: Annotated[str, Field(pattern="^(path|close)$")]
    pictures: list[Shot] = Field(max_length=_MOST_PICTURES)


class CacheState(_Reply):
    """A physics cache that moves the actor: ``state`` in words, and the frames it covers."""

    label: Text
    state: Text
    start: Frame
    end: Frame
    on: bool


class Contact(_Reply):
    """A contact: (first, last) frame of each period, and the ``gap`` in metres at the first."""

    partner: Text = Field(alias="with")
    frames: list[tuple[Frame, Frame]] = Field(min_length=1, max_length=50)
    gap: float

    @property
    def when(self) -> str:
        """The first periods, in words."""
        periods = [f"{first}–{last}" if last > first else f"{first}" for first, last in self.frames[:3]]
        return ", ".join(periods) + (" …" if len(self.frames) > 3 else "")


class PhaseMotion(_Reply):
    """The motion of one actor over one phase. Metres, m/s, degrees."""

    phase: Text
    start: Frame
    end: Frame
    present: bool
    there: tuple[Frame, Frame] | None = None
    displacement: float = 0.0
    displacement_vector: Vector = (0.0, 0.0, 0.0)
    path_length: float = 0.0
    start_position: Vector | None = None
    end_position: Vector | None = None
    peak_speed: float | None = None
    peak_frame: Frame | None = None
    final_speed: float | None = None
    turn: float | None = None
    contacts: list[Contact] = Field(default_factory=list[Contact], max_length=2000)


class ActorMotion(_Reply):
    """The motion of one actor, measured at ``frames``.

    ``keyframes``: the frames with its keys among them; ``keyed``: the first and last of all its keys.
    """

    name: Text
    kind: Text
    objects: list[Text] = Field(max_length=20)
    object_count: int
    measured: Text
    deforms: bool
    speed_of: Text
    caches: list[CacheState] = Field(max_length=1000)
    keyframes: list[Frame] = Field(max_length=100_000)
    keyed: tuple[Frame, Frame] | None = None
    phases: list[PhaseMotion] = Field(min_length=1, max_length=_MOST_PHASES)
    frames: list[Frame] = Field(min_length=1, max_length=_MOST_FRAMES)
    centres: list[Vector | None] = Field(max_length=_MOST_FRAMES)
    displacements: list[float | None] = Field(max_length=_MOST_FRAMES)
    speeds: list[float | None] = Field(max_length=_MOST_FRAMES)
    notes: list[Text] = Field(max_length=50)
    columns: int = Field(ge=1, le=_MOST_PICTURES)
    views: list[Strip] = Field(max_length=2)

    @model_validator(mode="after")
    def _as_many_as_frames(self) -> ActorMotion:
        if {len(self.centres), len(self.displacements), len(self.speeds)} != {len(self.frames)}:
            raise ValueError("there must be a centre, a displacement and a speed for each frame")
        return self


class MotionReply(_Reply):
    """The whole reply. ``stepped_from``: the frame from which all frames were stepped; None if they were played."""

    start: Frame
    end: Frame
    fps: float = Field(gt=0)
    stride: int = Field(ge=1)
    sampled: list[Frame] = Field(min_length=1, max_length=_MOST_PICTURES)
    stepped_from: Frame | None
    stepped_for: list[Text] = Field(max_length=20_000)
    notes: list[Text] = Field(max_length=50)
    actors: list[ActorMotion] = Field(min_length=1, max_length=_MOST_ACTORS)

    @property
    def how_played(self) -> str:
        """Whether the frames were played or stepped, and why, in words."""
        stride = "" if self.stride == 1 else f"; measured every {self.stride} frames"
        if self.stepped_from is None:
            return f"played: nothing had to be simulated{stride}"
        names = ", ".join(self.stepped_for[:4]) + (" …" if len(self.stepped_for) > 4 else "")
        return f"stepped frame by frame from {self.stepped_from}, not baked: {names}{stride}"
