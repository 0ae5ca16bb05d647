"""Checks of rendered images, and the smaller copies that models are shown."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, cast

from PIL import Image, ImageChops

if TYPE_CHECKING:
    from pathlib import Path

LARGEST_PREVIEW = 768  # pixels a side
_DARK = 6  # of 255


def preview_png(path: Path) -> bytes:
    """A PNG's bytes, shrunk if the image is larger than LARGEST_PREVIEW."""
    with Image.open(path) as image:
        if max(image.size) <= LARGEST_PREVIEW:
            return path.read_bytes()
        smaller = image.copy()
    smaller.thumbnail((LARGEST_PREVIEW, LARGEST_PREVIEW), Image.Resampling.LANCZOS)
    file = io.BytesIO()
    smaller.save(file, "PNG")
    return file.getvalue()


def image_faults(paths: list[Path]) -> list[str]:
    """Sentences on what makes images useless: black, of one colour, or all frames alike."""
    images = [_read_rgb(path) for path in paths]
    faults: list[str] = []
    for path, image in zip(paths, images, strict=True):
        ranges = cast("tuple[tuple[int, int], ...]", image.getextrema())
        if max(high for _, high in ranges) <= _DARK:
            faults.append(f"{path.name} is black: there is no light, or something blocks the camera.")
        elif all(high - low <= 1 for low, high in ranges):
            faults.append(
                f"{path.name} is one colour: nothing is in view, or the camera is inside an object."
            )
    if not faults and len(images) > 1 and all(_same(images[0], image) for image in images[1:]):
        faults.append("The first, middle and last frame are identical: nothing moves in view.")
    return faults


def _read_rgb(path: Path) -> Image.Image:
    with Image.open(path) as image:
        return image.convert("RGB")


def _same(first: Image.Image, second: Image.Image) -> bool:
    return first.size == second.size and ImageChops.difference(first, second).getbbox() is None
