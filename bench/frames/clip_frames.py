"""Frames for judge and page: five of a clip (at 0, 25, 50, 75, 100 %), one of a static scene (paper, on its judge).

A .blend is rendered by Cycles with few samples and a denoiser: Workbench knows neither light nor materials, which the
judge is asked about, and EEVEE needs a graphics card. That happens in a Blender of its own, confined, see
``bench.audit.untrusted_blend``. A video or a picture is decoded in a confined process, too. Whatever
comes out of either is made anew from its pixels.
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
SECONDS = 300.0  # for all frames of one file
_LONGEST_SIDE = 1280  # pixels of a frame of a video
_MOST_PIXELS = 60_000_000
Source = Literal["blend", "video", "picture"]


@dataclass(frozen=True, slots=True)
class Look:
    """How a .blend is rendered: about so many ``pixels``, in the scene's own proportions, and ``samples`` of each."""

    pixels: int = 480 * 270
    samples: int = 16


@dataclass(frozen=True, slots=True)
class Taken:
    """Frames as PNG files, and in words what is to be known of them (a camera that was made, physics without bake)."""

    source: Source
    paths: tuple[Path, ...]
    notes: tuple[str, ...] = ()


class _Frame(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)

    frame: int
    png: str


class _Rendered(BaseModel):
    """What ``bench/audit/inside/frames.py`` answers."""

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
    """As ``frames_of``, with what is to be known of them. Raises NotScored, CannotStart where no Blender works."""
    shares = SHARES[:1] if static else SHARES
    kind = kind_of(source)
    if kind == "blend":
        return _of_blend(source, shares, folder, look or Look(), means or Means(seconds=SECONDS))
    if kind == "picture" and not static:
        raise NotScored("a picture shows no clip")
    return Taken(kind, tuple(_kept(folder, shares, video.pictures(source, shares))))


def kind_of(source: Path) -> Source:
    """What a file is by its name."""
    suffix = source.suffix.lower()
    if suffix == ".blend":
        return "blend"
    return "picture" if suffix in video.PICTURES else "video"


def _of_blend(blend: Path, shares: Sequence[float], folder: Path, look: Look, means: Means) -> Taken:
    """Rendered as the whole clip would be; where that takes too long, or Blender does not survive it, by jumps."""
    notes: list[str] = []
    try:
        rendered = _rendered(blend, shares, look, means, jump=False)
    except NotScored as error:
        first, why = error, str(error)
        try:
            rendered = _rendered(blend, shares, look, means, jump=True)
        except NotScored:
            raise first from None
        notes.append(f"frames stand alone, without physics that is not baked ({why})")
    else:
        notes += [f"simulated while it was rendered: {each}" for each in rendered.unbaked]
    if rendered.camera is None:
        notes.append("the scene has no camera; one was made that sees all of it")
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
        raise NotScored("what was rendered of it makes no sense") from None
    if len(rendered.frames) != len(shares):
        raise NotScored("what was rendered of it is not what was asked for")
    return rendered


def _contents(rendered: _Rendered) -> list[bytes]:
    try:
        return [base64.b64decode(each.png, validate=True) for each in rendered.frames]
    except (binascii.Error, ValueError):
        raise NotScored("what was rendered of it is no picture") from None


def _kept(folder: Path, shares: Sequence[float], contents: Sequence[bytes]) -> list[Path]:
    """Writes the pictures, by their share of the clip in per cent; others that lie there go. Raises NotScored."""
    pictures = [_anew(content) for content in contents]
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{round(100 * share):03}.png" for share in shares]
    for path in {*folder.glob("*.png")} - {*paths}:
        path.unlink()
    for path, content in zip(paths, pictures, strict=True):
        write_whole(path, content, durable=False)
    return paths


def _anew(content: bytes) -> bytes:
    """A PNG of the same pixels and nothing else, no larger than is looked at. Raises NotScored."""
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
    except Exception:  # a file that is no picture fails in any way
        raise NotScored("a frame is no picture") from None
    plain.thumbnail((_LONGEST_SIDE, _LONGEST_SIDE))
    made = io.BytesIO()
    plain.save(made, "PNG")
    return made.getvalue()
