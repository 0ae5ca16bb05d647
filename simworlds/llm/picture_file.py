"""Picture files as models get them."""

from __future__ import annotations

import io
import warnings
from typing import TYPE_CHECKING

from PIL import Image, ImageOps, UnidentifiedImageError

from simworlds.errors import UserError
from simworlds.llm.messages import Picture

if TYPE_CHECKING:
    from pathlib import Path

_FORMATS = ("PNG", "JPEG", "WEBP")
_MODES = {"L", "LA", "RGB", "RGBA"}
_LARGEST = 1568  # pixels; models see no more of a picture
_MOST_BYTES = 3_500_000  # of a PNG, so that a request may hold it
_SHRINK = 0.75


class BadPicture(UserError):  # noqa: N818 - reads as the state it names
    """A file that cannot be read as a picture; the message says why."""


def read_picture(path: Path) -> Picture:
    """Reads a picture as an upright PNG, shrunk where it is larger than models see. Raises BadPicture."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path, formats=_FORMATS) as opened:
                opened.draft("RGB", (_LARGEST, _LARGEST))
                upright = ImageOps.exif_transpose(opened)
                plain = upright.copy() if upright.mode in _MODES else upright.convert("RGBA")
    except UnidentifiedImageError as error:
        raise BadPicture(f"{path} is not a picture of a known kind: give a PNG, JPEG or WebP.") from error
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise BadPicture(f"{path} has too many pixels; give a smaller picture.") from error
    except (OSError, ValueError, SyntaxError) as error:  # what Pillow raises for broken files
        raise BadPicture(f"{path} cannot be read as a picture: {error}.") from error
    size = _LARGEST
    while True:
        plain.thumbnail((size, size), Image.Resampling.LANCZOS)
        written = io.BytesIO()
        plain.save(written, "PNG")
        if written.tell() <= _MOST_BYTES:
            return Picture(written.getvalue())
        size = round(max(plain.size) * _SHRINK)
