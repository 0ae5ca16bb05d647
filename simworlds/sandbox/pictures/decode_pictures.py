"""Decodes pictures that nobody vouches for. Runs confined, in a process of its own, until its input ends.

A request on standard input: ``REQUEST`` and the bytes of the picture. The answer on standard output: ``FAULT`` and its
text, or ``PICTURE`` and the RGB pixels.
"""

from __future__ import annotations

import hashlib
import io
import os
import struct
import sys
from typing import cast

from PIL import Image, UnidentifiedImageError

FORMATS = ("PNG", "JPEG", "WEBP", "GIF")
# Longest side of the answer in pixels (0: as it is), most pixels, background colour, which of FORMATS (a bit each),
# bytes that follow.
REQUEST = struct.Struct(">II3BBQ")
# 1, bytes of the text that follows.
FAULT = struct.Struct(">BI")
# 0, size before and after shrinking, lowest and highest value of each channel, SHA-256 of the unshrunk pixels.
PICTURE = struct.Struct(">BIIII6B32s")
LONGEST_FAULT = 300


def main() -> None:
    """Answers requests, one by one."""
    while head := _read(REQUEST.size):
        longest, most, red, green, blue, kinds, size = REQUEST.unpack(head)
        formats = [name for bit, name in enumerate(FORMATS) if kinds >> bit & 1]
        try:
            answer = _decode(_read(size), formats, longest, most, (red, green, blue))
        except Exception as error:  # whatever a picture does to the decoder
            text = (str(error) or type(error).__name__).encode("utf-8", "replace")[:LONGEST_FAULT]
            answer = FAULT.pack(1, len(text)) + text
        _write(answer)


def _decode(data: bytes, formats: list[str], longest: int, most: int, under: tuple[int, int, int]) -> bytes:
    try:
        picture = Image.open(io.BytesIO(data), formats=formats)
    except UnidentifiedImageError:
        raise ValueError(f"it is not {' or '.join(formats)}") from None
    before = picture.size
    if before[0] * before[1] > most:
        raise ValueError(f"it has {before[0]} × {before[1]} pixels; the limit is {most:,} in all")
    picture.load()
    if "A" in picture.getbands() or "transparency" in picture.info:
        background = Image.new("RGBA", before, (*under, 255))
        picture = Image.alpha_composite(background, picture.convert("RGBA"))
    picture = picture.convert("RGB")
    ranges = [value for band in picture.split() for value in cast("tuple[int, int]", band.getextrema())]
    digest = hashlib.sha256(picture.tobytes()).digest()
    if 0 < longest < max(before):
        picture.thumbnail((longest, longest), Image.Resampling.LANCZOS)
    return PICTURE.pack(0, *before, *picture.size, *ranges, digest) + picture.tobytes()


def _read(count: int) -> bytes:
    """So many bytes; fewer where the input ends."""
    data = bytearray()
    while len(data) < count and (more := os.read(0, min(1 << 20, count - len(data)))):
        data += more
    return bytes(data)


def _write(data: bytes) -> None:
    left = memoryview(data)
    while left:
        left = left[os.write(1, left) :]


if __name__ == "__main__":
    Image.MAX_IMAGE_PIXELS = None  # each request has a limit of its own
    Image.init()
    sys.exit(main())
