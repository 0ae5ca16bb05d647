"""Fits a film to the time that there is for it: size and samples, from how long frames took."""

from __future__ import annotations

import math
from dataclasses import dataclass

_LEAST_SAMPLES = 16  # of a denoised frame; before fewer are taken, the picture gets smaller
_FEWEST_SAMPLES = 4
_LEAST_SCALE = 0.5  # of the planned sides
_SHARE = 0.9  # of the time is planned with: later frames may take longer than those that were timed
_WORTH = 0.2  # of a frame's time; what can save less is left as it is, and frames are left out instead
_WORTH_WITHOUT_ROOM = 0.5  # the same of a smaller picture, where what is fixed alone takes too long


@dataclass(frozen=True, slots=True)
class TimedFrame:
    """A frame that took ``seconds``. ``share``: its pixels, of those of the planned size."""

    samples: int
    seconds: float
    share: float = 1.0


@dataclass(frozen=True, slots=True)
class FrameTime:
    """How long a frame takes, in seconds: ``fixed`` at any size, ``per_picture`` and ``per_sample`` at the planned one.

    What is fixed is the scene's: it is stepped, and handed to the engine. A picture's is to denoise and write it.
    """

    fixed: float
    per_picture: float
    per_sample: float

    @classmethod
    def of(cls, few: TimedFrame, more: TimedFrame, small: TimedFrame | None = None) -> FrameTime:
        """From two frames of the planned size and, if it is to be known what is fixed, one of fewer pixels.

        The first may have waited for textures or the machine.
        """
        if more.samples > few.samples and more.seconds > few.seconds:
            each = (more.seconds - few.seconds) / (more.samples - few.samples)
        else:
            each = more.seconds / max(1, more.samples)
        rest = max(0.0, more.seconds - each * more.samples)
        picture = rest
        if small is not None and small.share < 1:
            rest_of_small = small.seconds - each * small.samples * small.share
            picture = max(0.0, min(rest, (rest - rest_of_small) / (1 - small.share)))
        return cls(rest - picture, picture, each)

    def seconds(self, samples: int, scale: float = 1.0) -> float:
        """Of a frame whose sides are ``scale`` of the planned ones."""
        return self.fixed + (self.per_picture + self.per_sample * samples) * scale * scale

    def times(self, factor: float) -> FrameTime:
        """On a machine that takes so many times as long."""
        return FrameTime(self.fixed * factor, self.per_picture * factor, self.per_sample * factor)


@dataclass(frozen=True, slots=True)
class FilmSettings:
    """A film of so many ``frames``. ``seconds``: how long it is expected to take. ``lowered``: what of the plan was."""

    width: int
    height: int
    samples: int
    frames: int
    seconds: float
    lowered: str = ""

    def __str__(self) -> str:
        size = f"{self.frames} frames, {self.width}×{self.height}, {self.samples} samples"
        return f"{size}{f' ({self.lowered})' if self.lowered else ''}"


def fitted(
    planned: FilmSettings, frame: FrameTime, seconds: float, busy: FrameTime | None = None
) -> FilmSettings:
    """The film that fits into ``seconds``: fewer samples first, then a smaller picture, then fewer samples still.

    ``busy``: how long a frame takes if the machine stays as busy as it was seen. Samples can give way while the film is
    rendered, its size can't: it is such that the fewest samples have time even then.
    """
    each = seconds * _SHARE / max(1, planned.frames)
    samples = _fewer_samples(frame, each, planned.samples, _LEAST_SAMPLES, 1.0)
    scale = _smaller(frame, each, samples, 1.0)
    samples = _fewer_samples(frame, each, samples, _FEWEST_SAMPLES, scale)
    if busy is not None:
        scale = _smaller(busy, each, min(samples, _FEWEST_SAMPLES), scale)
        samples = max(samples, min(planned.samples, _affordable(frame, each, scale)))
    width, height = planned.width, planned.height
    if scale < 1:
        width, height = (max(4, 2 * round(side * scale / 2)) for side in (width, height))
    lowered: list[str] = []
    if samples < planned.samples:
        lowered.append(f"{samples} samples instead of {planned.samples}")
    if scale < 1:
        lowered.append(f"{width}×{height} instead of {planned.width}×{planned.height}")
    cost = frame.seconds(samples, scale)
    if cost * planned.frames > seconds:
        lowered.append(
            f"about {max(1, math.floor(seconds / cost))} of {planned.frames} frames, the others repeated"
        )
    expected = min(seconds, cost * planned.frames)
    return FilmSettings(width, height, samples, planned.frames, expected, ", ".join(lowered))


def _fewer_samples(frame: FrameTime, each: float, most: int, least: int, scale: float) -> int:
    """As many as a frame of ``each`` seconds has time for, at least ``least``; ``most`` if that saves too little."""
    now = frame.seconds(most, scale)
    if now <= each or most <= least or frame.seconds(least, scale) > now * (1 - _WORTH):
        return most
    return max(least, min(most, _affordable(frame, each, scale)))


def _affordable(frame: FrameTime, each: float, scale: float) -> int:
    """The samples that a frame of ``each`` seconds has time for; none where samples take no time that could be seen."""
    if frame.per_sample <= 0:
        return 0
    return math.floor((each - frame.seconds(0, scale)) / (frame.per_sample * scale * scale))


def _smaller(frame: FrameTime, each: float, samples: int, scale: float) -> float:
    """The scale at which a frame takes ``each`` seconds, or the least; ``scale`` if that saves too little."""
    now = frame.seconds(samples, scale)
    worth = _WORTH if frame.fixed < each else _WORTH_WITHOUT_ROOM
    if now <= each or frame.seconds(samples, _LEAST_SCALE) > now * (1 - worth):
        return scale
    wanted = math.sqrt(max(0.0, each - frame.fixed) / (frame.seconds(samples) - frame.fixed))
    return min(scale, max(_LEAST_SCALE, wanted))
