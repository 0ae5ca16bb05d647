"""Checks the inputs of an edit: a .blend and, optionally, a reference picture."""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING

from PIL import Image, ImageOps, UnidentifiedImageError

from agents.loop.errors import Unusable
from simworlds.llm.messages import Picture

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.options import Options

_FORMATS = ("PNG", "JPEG", "WEBP")
_MODES = {"L", "LA", "RGB", "RGBA"}
_LARGEST = 1568  # pixels; models see no more of a picture
_MOST_BYTES = 3_500_000  # of a PNG, so that a request may hold it
_SHRINK = 0.75
_BLEND = (b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")  # plain, and packed by zstd or gzip


def check_inputs(options: Options) -> None:
    """Checks that the files are a .blend and a picture. Raises Unusable."""
    if options.mode != "edit":
        return
    if options.file is None:
        raise Unusable("There is nothing to edit: give a .blend.")
    try:
        with options.file.open("rb") as file:
            start = file.read(8)
    except OSError as error:
        raise Unusable(f"{options.file} cannot be read: {error.strerror or error}.") from error
    if not start.startswith(_BLEND):
        raise Unusable(f"{options.file} is not a .blend file: its first bytes are not those of one.")
    if options.reference is not None:
        picture(options.reference)


def picture(path: Path) -> Picture:
    """A picture as models get it: a PNG, upright, shrunk where it is larger than they see. Raises Unusable."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path, formats=_FORMATS) as opened:
                opened.draft("RGB", (_LARGEST, _LARGEST))
                upright = ImageOps.exif_transpose(opened)
                plain = upright.copy() if upright.mode in _MODES else upright.convert("RGBA")
    except UnidentifiedImageError as error:
        raise Unusable(f"{path} is not a readable picture: give a PNG, JPEG or WebP.") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise Unusable(f"{path} has too many pixels; give a smaller picture.") from error
    except (OSError, ValueError, SyntaxError) as error:  # what Pillow raises for broken files
        raise Unusable(f"{path} cannot be read as a picture: {error}.") from error
    size = _LARGEST
    while True:
        plain.thumbnail((size, size), Image.Resampling.LANCZOS)
        written = io.BytesIO()
        plain.save(written, "PNG")
        if written.tell() <= _MOST_BYTES:
            return Picture(written.getvalue())
        size = round(max(plain.size) * _SHRINK)
