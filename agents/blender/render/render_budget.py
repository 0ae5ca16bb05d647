"""How to render within a time: first with fewer samples, and only then fewer frames."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

LEAST = 4  # samples; with fewer, frames are worth nothing
_TELLING, _ENOUGH = 8, 16  # samples of a second trial, at least and at most
_TRIAL_SHARE = 0.25  # of what is left, that the second trial may take
_SLACK = 1.05  # a little too long is no reason to change anything


class Pace:
    """``seconds`` from now on for frames of ``samples`` each (None: the engine has none to lower).

    A frame takes a fixed time and one for each sample; both are measured on the first frame, and corrected by every
    frame that follows. Samples are never raised again: a film whose grain changes flickers.
    """

    def __init__(
        self, seconds: float, samples: int | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._clock = clock
        self._end = clock() + seconds
        self.samples = samples
        self._fixed = 0.0
        self._each = 0.0
        self._drift = 1.0
        self._trials: list[tuple[int, float]] = []

    @property
    def left(self) -> float:
        """Seconds."""
        return max(0.0, self._end - self._clock())

    def trial(self, frames: int) -> int | None:
        """With how many samples to try the first frame; None when enough is known. ``frames`` are to be made."""
        asked = self.samples
        if asked is None or asked <= LEAST:
            return None
        if not self._trials:
            return LEAST
        samples, seconds = self._trials[0]
        if len(self._trials) > 1 or seconds * asked / samples * frames <= self.left:
            return None  # it fits even if all of the time went into samples
        second = min(_ENOUGH, asked, math.floor(samples * self.left * _TRIAL_SHARE / seconds))
        return second if second >= _TELLING else None

    def tried(self, samples: int, seconds: float) -> None:
        """A trial took so long."""
        self._trials.append((samples, seconds))
        if len(self._trials) == 1:
            self._fixed, self._each = 0.0, seconds / samples
            return
        # The first picture may have waited for shaders, textures or the machine: the later one is to be believed. If
        # more samples took no longer, nothing is known of one but that they cannot have taken more than all of it.
        few, short = self._trials[0]
        self._each = (seconds - short) / (samples - few) if seconds > short else seconds / samples
        self._fixed = max(0.0, seconds - self._each * samples)

    def took(self, samples: int | None, seconds: float) -> None:
        """A frame took so long."""
        expected = self._cost(samples)
        if expected <= 0:
            self._fixed, self._each = (seconds, 0.0) if samples is None else (0.0, seconds / samples)
        else:
            self._drift = (self._drift + seconds / (expected / self._drift)) / 2

    def settle(self, frames: int) -> None:
        """Lowers ``samples`` as far as the ``frames`` to come need it."""
        left = self.left
        if self._fits(frames, left) or self.samples is None or self._each <= 0:
            return
        fitting = (left / frames / self._drift - self._fixed) / self._each
        self.samples = min(self.samples, max(LEAST, math.floor(fitting)))

    def every(self, frames: int) -> int:
        """n where only every n-th of the ``frames`` to come fits, with the samples settled for; 0 if none does."""
        left = self.left
        if self._fits(frames, left):
            return 1
        affordable = math.floor(left * _SLACK / self._cost(self.samples))
        return math.ceil(frames / affordable) if affordable else 0

    def _fits(self, frames: int, left: float) -> bool:
        return self._cost(self.samples) * frames <= left * _SLACK

    def _cost(self, samples: int | None) -> float:
        return self._drift * (self._fixed + self._each * (samples or 0))
