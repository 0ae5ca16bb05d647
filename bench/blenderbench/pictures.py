"""Reads renders to compare: PNGs as RGB. The files are untrusted: their size is limited."""

from __future__ import annotations

import warnings
from contextlib import contextmanager
from typing import TYPE_CHECKING

from PIL import Image, UnidentifiedImageError

from bench.blenderbench.errors import UnreadableRender

if TYPE_CHECKING:
    from collections.abc import Generator
    from pathlib import Path

MOST_PIXELS = 4096 * 4096
LONGEST = 16  # times the shorter side
_DEEP_GREY = ("I", "F")  # how the names of Pillow's modes with more than 8 bits begin


def size_of(path: Path) -> tuple[int, int]:
    """Width and height of a PNG that can be compared, from its first bytes. Raises UnreadableRender."""
    with _opened(path) as picture:
        return picture.size


def read_picture(path: Path) -> Image.Image:
    """A PNG as RGB; transparency is left out, as by the peer. Raises UnreadableRender."""
    with _opened(path) as picture:
        picture.load()
        if picture.mode == "P":  # a palette may hold transparency of its own kind
            return picture.convert("RGBA").convert("RGB")
        return picture.convert("RGB")


@contextmanager
def _opened(path: Path) -> Generator[Image.Image]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path, formats=("PNG",)) as picture:
                _check(path, picture)
                yield picture
    except UnidentifiedImageError as error:
        raise UnreadableRender(f"{path} is not a PNG.") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise UnreadableRender(f"{path} is larger than {MOST_PIXELS:,} pixels.") from error
    except (OSError, ValueError, SyntaxError, MemoryError) as error:  # what Pillow raises for broken files
        raise UnreadableRender(f"{path} cannot be read as a picture: {error}.") from error


def _check(path: Path, picture: Image.Image) -> None:
    width, height = picture.size
    if width * height > MOST_PIXELS:
        raise UnreadableRender(f"{path} has {width} × {height} pixels; {MOST_PIXELS:,} at most.")
    if max(width, height) > LONGEST * min(width, height):
        raise UnreadableRender(
            f"{path} is {width} × {height}: one side is more than {LONGEST} times the other."
        )
    if picture.mode.startswith(_DEEP_GREY):
        raise UnreadableRender(f"{path} is grey with more than 8 bits; save it as RGB with 8 bits a channel.")
