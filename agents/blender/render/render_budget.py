"""The time budget of a render: which samples and how many frames fit into it. Samples give way first, then frames."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable

LEAST = 4  # samples; frames with fewer are useless
_SECOND_TRIAL_LEAST, _SECOND_TRIAL_MOST = 8, 16  # samples
_SECOND_TRIAL_SHARE = 0.25  # of the time left
_SURELY = 0.9  # of the time left, for frames that are taken up again
_WORTH_RAISING = 1.5  # times the samples
_WORTH_LOWERING = 0.2  # of a frame's time; where fewer samples save less, frames are left out instead
_SLACK = 1.05  # a little over the budget is not worth a change


class RenderBudget:
    """``seconds`` from now on for frames of ``samples`` each (None: the engine has no samples to lower).

    A frame takes a fixed time plus a time per sample; both are measured on the first frame and corrected by every
    later one. Samples are raised again, up to those asked for, only where there is time for many more: a video whose
    grain keeps changing flickers.
    """

    def __init__(
        self, seconds: float, samples: int | None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._clock = clock
        self._end = clock() + seconds
        self.samples = self._wanted = samples
        self._fixed = 0.0
        self._per_sample = 0.0
        self._drift = 1.0
        self._trials: list[tuple[int, float]] = []

    @property
    def left(self) -> float:
        """Seconds left."""
        return max(0.0, self._end - self._clock())

    def next_trial(self, frames: int) -> int | None:
        """Samples of the next trial of the first frame; None when enough is known. ``frames`` are to be rendered."""
        wanted = self.samples
        if wanted is None or wanted <= LEAST:
            return None
        if not self._trials:
            return LEAST
        samples, seconds = self._trials[0]
        if len(self._trials) > 1 or seconds * wanted / samples * frames <= self.left:
            return None  # it fits even if all of the time went into samples
        second = min(
            _SECOND_TRIAL_MOST, wanted, math.floor(samples * self.left * _SECOND_TRIAL_SHARE / seconds)
        )
        return second if second >= _SECOND_TRIAL_LEAST else None

    def add_trial(self, samples: int, seconds: float) -> None:
        """Takes in how long a trial took."""
        self._trials.append((samples, seconds))
        if len(self._trials) == 1:
            self._fixed, self._per_sample = 0.0, seconds / samples
            return
        # The first trial may have waited for shaders, textures or the machine, so the later one counts. If more
        # samples took no longer, one sample can have taken at most its share of the whole.
        few, short = self._trials[0]
        self._per_sample = (seconds - short) / (samples - few) if seconds > short else seconds / samples
        self._fixed = max(0.0, seconds - self._per_sample * samples)

    def add_frame(self, samples: int | None, seconds: float) -> None:
        """Takes in how long a frame took."""
        expected = self._cost(samples)
        if expected <= 0:
            self._fixed, self._per_sample = (seconds, 0.0) if samples is None else (0.0, seconds / samples)
        else:
            self._drift = (self._drift + seconds / (expected / self._drift)) / 2

    def fit_samples(self, frames: int) -> None:
        """Fits ``samples`` to the ``frames`` that are wanted yet, those that were dropped too.

        They are lowered as far as needed, unless frames must be left out anyway and that saves little of their time.
        They are raised where there is time for many more.
        """
        if self.samples is None or self._wanted is None or self._per_sample <= 0:
            return
        left = self.left
        if not self._fits(frames, left):
            fewest = self._cost(min(self.samples, LEAST))
            if fewest * frames <= left * _SLACK or fewest <= self._cost(self.samples) * (1 - _WORTH_LOWERING):
                self.samples = min(self.samples, max(LEAST, self._affordable_samples(left / frames)))
        elif (more := min(self._wanted, self._affordable_samples(left * _SURELY / frames))) >= (
            self.samples * _WORTH_RAISING
        ):
            self.samples = more

    def affordable(self, frames: int) -> int:
        """How many of the remaining ``frames`` there is time for at the current samples."""
        left = self.left
        if self._fits(frames, left):
            return frames
        return min(frames, math.floor(left * _SLACK / self._cost(self.samples)))

    def surely_affordable(self, frames: int) -> int:
        """For how many of so many frames more there is surely time."""
        cost = self._cost(self.samples)
        return min(frames, math.floor(self.left * _SURELY / cost)) if cost > 0 else frames

    def _fits(self, frames: int, left: float) -> bool:
        return self._cost(self.samples) * frames <= left * _SLACK

    def _affordable_samples(self, seconds: float) -> int:
        return math.floor((seconds / self._drift - self._fixed) / self._per_sample)

    def _cost(self, samples: int | None) -> float:
        return self._drift * (self._fixed + self._per_sample * (samples or 0))
