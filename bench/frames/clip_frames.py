"""Frames for the judge and the report: five of a clip (0, 25, 50, 75, 100 %), one of a static scene (see the paper).

A .blend is rendered by Cycles with few samples and a denoiser: Workbench shows no lights and materials, which are
judged, and EEVEE needs a graphics card. It runs in a sandboxed Blender, see ``bench.audit.untrusted_blend``. A video or
a picture is decoded in a sandboxed process, too. The output of either is re-encoded from its pixels.
"""

from __future__ import annotations

import base64
import binascii
import io
import math
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from PIL import Image
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.audit.untrusted_blend import Means, NotScored, Untrusted
from bench.frames import video
from simworlds.files import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
SECONDS = 300.0  # time limit for all frames of one file
_LONGEST_SIDE = 1280  # pixels of a frame of a video
_MOST_PIXELS = 60_000_000
Source = Literal["blend", "video", "picture"]


@dataclass(frozen=True, slots=True)
class Look:
    """How a .blend is rendered: about ``pixels`` pixels, in the scene's own proportions, with ``samples`` per pixel."""

    pixels: int = 480 * 270
    samples: int = 16


@dataclass(frozen=True, slots=True)
class Taken:
    """Frames as PNG files, and notes on them in words (an added camera, unbaked physics)."""

    source: Source
    paths: tuple[Path, ...]
    notes: tuple[str, ...] = ()


class _Frame(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    frame: int
    png: str


class _Rendered(BaseModel):
    """The reply of ``bench/audit/inside/frames.py``."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    frames: tuple[_Frame, ...] = Field(max_length=len(SHARES))
    camera: str | None
    unbaked: tuple[str, ...]


def frames_of(source: Path, static: bool, folder: Path) -> tuple[Path, ...]:
    """The frames of a .blend, a video or (``static``) a picture, as PNG files in ``folder``. Raises NotScored."""
    return take_frames(source, static, folder).paths


def take_frames(
    source: Path, static: bool, folder: Path, look: Look | None = None, means: Means | None = None
) -> Taken:
    """As ``frames_of``, with notes. Raises NotScored, or CannotStart if no Blender works."""
    shares = SHARES[:1] if static else SHARES
    kind = kind_of(source)
    if kind == "blend":
        return _of_blend(source, shares, folder, look or Look(), means or Means(seconds=SECONDS))
    if kind == "picture" and not static:
        raise NotScored("a picture has one frame only; a clip needs a video or a .blend")
    return Taken(kind, tuple(_kept(folder, shares, video.pictures(source, shares))))


def kind_of(source: Path) -> Source:
    """The kind of a file, by its name."""
    suffix = source.suffix.lower()
    if suffix == ".blend":
        return "blend"
    return "picture" if suffix in video.PICTURES else "video"


def _of_blend(blend: Path, shares: Sequence[float], folder: Path, look: Look, means: Means) -> Taken:
    """Renders with unbaked physics simulated; if that takes too long or Blender ends, again without that physics."""
    notes: list[str] = []
    try:
        rendered = _rendered(blend, shares, look, means, jump=False)
    except NotScored as error:
        first, why = error, str(error)
        try:
            rendered = _rendered(blend, shares, look, means, jump=True)
        except NotScored:
            raise first from None
        notes.append(f"rendered without unbaked physics, after a first try failed ({why})")
    else:
        notes += [f"not baked, simulated while rendering: {each}" for each in rendered.unbaked]
    if rendered.camera is None:
        notes.append("the scene has no camera; one that sees all of it was added")
    return Taken("blend", tuple(_kept(folder, shares, _contents(rendered))), tuple(notes))


def _rendered(blend: Path, shares: Sequence[float], look: Look, means: Means, *, jump: bool) -> _Rendered:
    asked: dict[str, Any] = {
        "shares": list(shares),
        "pixels": look.pixels,
        "samples": look.samples,
        "jump": jump,
    }
    with Untrusted(blend, means) as file:
        answer = file.ask("frames", **asked, doing="rendering it")
    try:
        rendered = _Rendered.model_validate(answer)
    except ValidationError:
        raise NotScored("Blender's reply after rendering it was not valid") from None
    if len(rendered.frames) != len(shares):
        raise NotScored(f"Blender rendered {len(rendered.frames)} frames of it instead of {len(shares)}")
    return rendered


def _contents(rendered: _Rendered) -> list[bytes]:
    try:
        return [base64.b64decode(each.png, validate=True) for each in rendered.frames]
    except (binascii.Error, ValueError):
        raise NotScored("a rendered frame of it is not a picture") from None


def _kept(folder: Path, shares: Sequence[float], contents: Sequence[bytes]) -> list[Path]:
    """Writes the pictures, named after their per cent of the clip, and deletes older ones. Raises NotScored."""
    pictures = [_anew(content) for content in contents]
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{round(100 * share):03}.png" for share in shares]
    for path in {*folder.glob("*.png")} - {*paths}:
        path.unlink()
    for path, content in zip(paths, pictures, strict=True):
        write_whole(path, content, durable=False)
    return paths


def _anew(content: bytes) -> bytes:
    """A PNG of the same pixels and nothing else, shrunk to the size that is judged. Raises NotScored."""
    try:
        with (
            warnings.catch_warnings(action="error"),
            Image.open(io.BytesIO(content), formats=("PNG",)) as image,
        ):
            if math.prod(image.size) > _MOST_PIXELS:
                raise NotScored(f"a frame of {image.width} by {image.height} pixels is too large")
            plain = image.convert("RGB")
    except NotScored:
        raise
    except Exception:  # a broken file can raise anything
        raise NotScored("a frame is not a picture") from None
    plain.thumbnail((_LONGEST_SIDE, _LONGEST_SIDE))
    made = io.BytesIO()
    plain.save(made, "PNG")
    return made.getvalue()
