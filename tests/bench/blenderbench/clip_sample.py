"""Weights of CLIP's architecture that mean nothing, and pictures of odd sizes: the same on every machine.

All comes from the bits of a PCG64 generator, whose stream numpy keeps the same for ever, and from arithmetic.
"""

from __future__ import annotations

import numpy as np
from PIL import Image

from bench.blenderbench.n_clip import SHAPES

SEED = 20_260_727
SIZES = ((224, 224), (95, 61), (300, 511), (33, 400))  # width, height; resized, they end in fractions


def weights() -> dict[str, np.ndarray]:
    """Values as training could have left them: each layer's output is about as large as its input."""
    bits = np.random.PCG64(SEED)
    made: dict[str, np.ndarray] = {}
    for name in sorted(SHAPES):
        shape = SHAPES[name]
        count = int(np.prod(shape))
        raw = bits.random_raw((count + 1) // 2).view(np.uint32)[:count]
        values = (raw.astype(np.float32) / np.float32(2**31) - 1) * np.float32(3**0.5)  # of deviation 1
        made[name] = (values * _deviation(name, shape) + _mean(name)).reshape(shape).astype(np.float32)
    return made


def _mean(name: str) -> np.float32:
    return np.float32("norm" in name and name.endswith("weight"))


def _deviation(name: str, shape: tuple[int, ...]) -> np.float32:
    if "norm" in name or name.endswith("bias"):
        return np.float32(0.1)
    if "embedding" in name and "patch" not in name:
        return np.float32(0.5)
    return np.float32(np.prod(shape[1:]) ** -0.5)


def pictures() -> list[Image.Image]:
    """One of each size: waves, an edge, and grain of single pixels, so that every step of resizing shows."""
    return [_picture(width, height, number) for number, (width, height) in enumerate(SIZES)]


def _picture(width: int, height: int, number: int) -> Image.Image:
    x, y = np.arange(width)[None, :], np.arange(height)[:, None]
    red = (x * (7 + number) + y * 3) % 256
    green = (x * x // (5 + number) + y * 11) % 256
    blue = np.where((x + 2 * y) % (40 + 9 * number) < 17, 230, 20) + 0 * y
    grain = ((x * 12_289 + y * 40_961 + number * 77) % 97) - 48
    channels = [np.clip(channel + grain, 0, 255).astype(np.uint8) for channel in (red, green, blue)]
    return Image.fromarray(np.dstack(channels))
