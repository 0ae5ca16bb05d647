"""Rendered pictures as a model gets to see them, and what is plainly wrong with them."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, cast

from PIL import Image, ImageChops

if TYPE_CHECKING:
    from pathlib import Path

LARGEST_SHOWN = 768  # pixels
_DARK = 6  # of 255


def shown(path: Path) -> bytes:
    """A PNG, shrunk where it is larger than LARGEST_SHOWN."""
    with Image.open(path) as picture:
        if max(picture.size) <= LARGEST_SHOWN:
            return path.read_bytes()
        smaller = picture.copy()
    smaller.thumbnail((LARGEST_SHOWN, LARGEST_SHOWN), Image.Resampling.LANCZOS)
    written = io.BytesIO()
    smaller.save(written, "PNG")
    return written.getvalue()


def faults(paths: list[Path]) -> list[str]:
    """What makes pictures of a film, or a single one, worthless; in words."""
    pictures = [_opened(path) for path in paths]
    found: list[str] = []
    for path, picture in zip(paths, pictures, strict=True):
        ranges = cast("tuple[tuple[int, int], ...]", picture.getextrema())
        if max(high for _, high in ranges) <= _DARK:
            found.append(f"{path.name} is black: there is no light, or something stands before the camera.")
        elif all(high - low <= 1 for low, high in ranges):
            found.append(
                f"{path.name} is of one colour: nothing is in view, or the camera is inside something."
            )
    if not found and len(pictures) > 1 and all(_same(pictures[0], other) for other in pictures[1:]):
        found.append("The first, middle and last frame are alike: nothing moves in view.")
    return found


def _opened(path: Path) -> Image.Image:
    with Image.open(path) as picture:
        return picture.convert("RGB")


def _same(one: Image.Image, other: Image.Image) -> bool:
    return one.size == other.size and ImageChops.difference(one, other).getbbox() is None
