"""Fits a film to the time that there is for it: size and samples, from how long a frame took."""

from __future__ import annotations

import math
from dataclasses import dataclass

_LEAST_SAMPLES = 16  # of a denoised frame; before fewer are taken, the picture gets smaller
_FEWEST_SAMPLES = 4
_LEAST_SCALE = 0.5  # of the planned sides
_SHARE = 0.9  # of the time is planned with: later frames may take longer than those that were timed


@dataclass(frozen=True, slots=True)
class FrameTime:
    """How long a frame takes at the planned size: ``fixed`` seconds and ``per_sample`` ones."""

    fixed: float
    per_sample: float

    @classmethod
    def of(cls, few: tuple[int, float], more: tuple[int, float]) -> FrameTime:
        """From two frames, each (samples, seconds). The first may have waited for textures or the machine."""
        (count, short), (samples, seconds) = few, more
        if samples > count and seconds > short:
            each = (seconds - short) / (samples - count)
        else:
            each = seconds / max(1, samples)
        return cls(max(0.0, seconds - each * samples), each)

    def seconds(self, samples: int, scale: float = 1.0) -> float:
        """Of a frame whose sides are ``scale`` of the planned ones."""
        return (self.fixed + self.per_sample * samples) * scale * scale


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


def fitted(planned: FilmSettings, frame: FrameTime, seconds: float) -> FilmSettings:
    """The film that fits into ``seconds``: fewer samples first, then a smaller picture, then fewer samples still."""
    each = seconds * _SHARE / max(1, planned.frames)
    samples, scale = planned.samples, 1.0
    if frame.seconds(samples) > each:
        samples = _affordable(frame, each, min(samples, _LEAST_SAMPLES), samples)
        if frame.seconds(samples) > each:
            scale = max(_LEAST_SCALE, math.sqrt(each / frame.seconds(samples)))
            samples = _affordable(frame, each / scale**2, min(samples, _FEWEST_SAMPLES), samples)
    width, height = (max(4, 2 * round(side * scale / 2)) for side in (planned.width, planned.height))
    lowered: list[str] = []
    if samples < planned.samples:
        lowered.append(f"{samples} samples instead of {planned.samples}")
    if scale < 1:
        lowered.append(f"{width}×{height} instead of {planned.width}×{planned.height}")
    cost = frame.seconds(samples, scale)
    if cost * planned.frames > seconds:
        lowered.append(f"one frame in {math.ceil(cost * planned.frames / seconds)} or so")
    if scale == 1:
        width, height = planned.width, planned.height
    expected = min(seconds, cost * planned.frames)
    return FilmSettings(width, height, samples, planned.frames, expected, ", ".join(lowered))


def _affordable(frame: FrameTime, each: float, least: int, most: int) -> int:
    """As many samples, from ``least`` to ``most``, as a frame of ``each`` seconds has time for."""
    if frame.per_sample <= 0:
        return most
    return max(least, min(most, math.floor((each - frame.fixed) / frame.per_sample)))
