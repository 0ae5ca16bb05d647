"""Blender's replies about rendering."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from simworlds.sandbox.replies import Claim, Count, Frame, Name, Side, Text

_MOST_BLOCKS = 200_000
Level = Annotated[int, Field(ge=0, le=255)]


class Shot(Claim):
    """What is rendered. ``bound``: through the cameras that are bound to the timeline's markers."""

    engine: Name
    device: Name
    samples: int | None = Field(ge=1, le=1 << 24)
    denoise: bool | None
    width: Side
    height: Side
    camera: Name
    bound: bool

    @property
    def settings(self) -> dict[str, Any]:
        """The same as JSON data."""
        return self.model_dump()


class UnbakedCache(Claim):
    """A simulation that is not baked; ``start``: its first frame."""

    kind: Name
    object: Name | None
    label: Name
    start: Frame


class RenderPlan(Claim):
    """``scene``: a digest for every data-block that the images depend on; the rest is the timeline and the shot.

    ``looks``: a digest of all that a still depends on, where that was asked.
    """

    shot: Shot
    scene: dict[Name, Name] = Field(max_length=_MOST_BLOCKS)
    looks: Name = ""
    unbaked: list[UnbakedCache] = Field(max_length=20_000)
    notes: list[Text] = Field(max_length=1000)
    current: Frame
    subframe: float = Field(ge=0, le=1)
    frame_start: Frame
    frame_end: Frame
    fps: int = Field(ge=1, le=100_000)
    fps_base: float = Field(gt=0, le=1e7)


class VideoFacts(Claim):
    """What is read back from a video: frames, pixels, frames a second, bytes, seconds that it took to make."""

    frames: Count
    width: Side
    height: Side
    fps: float = Field(gt=0, le=1e6)
    bytes: Count
    seconds: float = Field(ge=0)


class SubjectMask(Claim):
    """A picture in which each subject (name, colour) is flat; no ``file`` where the camera has no such view.

    ``clear``: the subjects through which one sees, at least in part.
    """

    file: Annotated[str, Field(pattern=r"^\.preview-\d{1,3}\.png$")] | None
    subjects: list[tuple[Name, tuple[Level, Level, Level]]] = Field(max_length=256)
    clear: list[Name] = Field(max_length=256)
