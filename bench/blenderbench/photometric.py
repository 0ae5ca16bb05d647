"""PL, the photometric loss: how far a render's pixels are from the goal's (paper, "BlenderBench Setup").

Sizes are brought together with Pillow's bicubic filter; which of the two pictures gives way is a matter of convention.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from PIL import Image

Convention = Literal["paper", "peer"]
SCALE: dict[Convention, float] = {"paper": 100.0, "peer": 1.0}
"""Factors of distances: the paper reports them × 100, the peer's scripts unscaled."""


def photometric_loss(render: Image.Image, goal: Image.Image, convention: Convention = "paper") -> float:
    """The mean squared difference of two RGB pictures' values in [0, 1]; 0 is best.

    ``paper``: at the goal's size, × 100. ``peer``: the goal is resized to the render, and nothing is multiplied.
    """
    render, goal = same_size(render, goal, convention)
    difference = _values(render) - _values(goal)
    return float(np.mean(np.square(difference), dtype=np.float64)) * SCALE[convention]


def same_size(
    render: Image.Image, goal: Image.Image, convention: Convention
) -> tuple[Image.Image, Image.Image]:
    """Both pictures, at the size of the one that the convention holds on to."""
    if render.size == goal.size:
        return render, goal
    if convention == "paper":
        return render.resize(goal.size, Image.Resampling.BICUBIC), goal
    return render, goal.resize(render.size, Image.Resampling.BICUBIC)


def _values(picture: Image.Image) -> np.ndarray:
    return np.asarray(picture, dtype=np.float32) / np.float32(255)
