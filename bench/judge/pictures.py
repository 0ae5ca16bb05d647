"""Frames as a judge sees them: plain pictures without names or metadata, and digests of their pixels.

Digests are of decoded pixels, since renderers add metadata (date, duration, path) and encoders differ. The pictures are
re-encoded, so that no metadata gives away a path or the name of a system.
"""

from __future__ import annotations

import hashlib
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PIL import Image

from bench.judge.errors import NotJudged
from simworlds.counting import format_list
from simworlds.llm.messages import Picture
from simworlds.llm.picture_file import BadPicture, read_picture

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

MOST = 20
"""Frames per request; with more, providers accept only small pictures."""

_NAMED = 3  # files that are not there


@dataclass(frozen=True, slots=True)
class JudgedFrames:
    """Pictures in order of time, and the SHA-256 of the pixels of each."""

    pictures: tuple[Picture, ...]
    digests: tuple[str, ...]


def read_frames(frames: Sequence[Path], *, static: bool) -> JudgedFrames:
    """Reads the frames of a film, or the one frame of a still. Raises NotJudged."""
    if missing := [str(path) for path in frames if not path.exists()]:
        raise NotJudged("frames", f"There is no file {format_list(missing, _NAMED)}.")
    if static and len(frames) != 1:
        raise NotJudged("frames", f"Give one frame for a still, not {len(frames)}.")
    if not static and not 2 <= len(frames) <= MOST:
        raise NotJudged("frames", f"Give 2 to {MOST} frames for a film, not {len(frames)}.")
    flat = [_flattened(path) for path in frames]
    return JudgedFrames(tuple(map(_encoded, flat)), tuple(map(_digest, flat)))


def _flattened(path: Path) -> Image.Image:
    """A frame without transparency, on black as in a video player."""
    try:
        data = read_picture(path).data
    except BadPicture as error:
        raise NotJudged("frames", str(error)) from error
    with Image.open(io.BytesIO(data)) as image:
        rgba = image.convert("RGBA")
    return Image.alpha_composite(Image.new("RGBA", rgba.size, "black"), rgba).convert("RGB")


def _encoded(image: Image.Image) -> Picture:
    png = io.BytesIO()
    image.save(png, "PNG")
    return Picture(png.getvalue())


def _digest(image: Image.Image) -> str:
    head = f"{image.width} {image.height}\n".encode()
    return hashlib.sha256(head + image.tobytes()).hexdigest()
