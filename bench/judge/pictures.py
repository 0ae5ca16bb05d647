"""Frames as a judge sees them: plain pictures without names or metadata, and a digest of what they show.

The digest is of decoded pixels: files of one rendering differ in what the renderer writes beside them (its date, how
long it took, the scene's path), and encoders in how they pack. What is shown is encoded anew for the same reason: no
path and no name of a system comes along.
"""

from __future__ import annotations

import hashlib
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PIL import Image

from bench.judge.errors import NotJudged
from simworlds.llm.messages import Picture
from simworlds.llm.picture_file import BadPicture, read_picture

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

MOST = 20
"""Of more pictures in one request, providers take only small ones."""


@dataclass(frozen=True, slots=True)
class Shown:
    """Pictures in the order of time, and the SHA-256 of the pixels of each."""

    pictures: tuple[Picture, ...]
    digests: tuple[str, ...]


def read_frames(frames: Sequence[Path], *, static: bool) -> Shown:
    """The frames of a film, or the one of a still. Raises NotJudged."""
    if static and len(frames) != 1:
        raise NotJudged("frames", f"A still is judged by one frame; {len(frames)} are given.")
    if not static and not 2 <= len(frames) <= MOST:
        raise NotJudged("frames", f"A film is judged by 2 to {MOST} frames; {len(frames)} are given.")
    flat = [_flat(path) for path in frames]
    return Shown(tuple(map(_encoded, flat)), tuple(map(_digest, flat)))


def _flat(path: Path) -> Image.Image:
    """As a player shows it: what is transparent is black."""
    try:
        data = read_picture(path).data
    except BadPicture as error:
        raise NotJudged("frames", str(error)) from error
    with Image.open(io.BytesIO(data)) as opened:
        seen = opened.convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", seen.size, "black"), seen).convert("RGB")


def _encoded(image: Image.Image) -> Picture:
    written = io.BytesIO()
    image.save(written, "PNG")
    return Picture(written.getvalue())


def _digest(image: Image.Image) -> str:
    head = f"{image.width} {image.height}\n".encode()
    return hashlib.sha256(head + image.tobytes()).hexdigest()
