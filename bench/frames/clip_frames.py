"""Frames for the judge and the report: five of a clip (0, 25, 50, 75, 100 %), one of a static scene (see the paper).

A .blend is rendered by Cycles with few samples and a denoiser: Workbench shows no lights and materials, which are
judged, and EEVEE needs a graphics card. It runs in a sandboxed Blender, see ``bench.audit.untrusted_blend``. A video or
a picture is decoded in a sandboxed process, too. The output of either is re-encoded from its pixels.
"""

from __future__ import annotations

import base64
import binascii
import io
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bench.audit.untrusted_blend import BlenderOptions, NotScored, UntrustedBlend
from bench.frames import video
from simworlds.files import write_whole
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
SECONDS = 300.0  # time limit for all frames of one file
_LONGEST_SIDE = 1280  # pixels of a frame of a video
_MOST_PIXELS = 60_000_000
Source = Literal["blend", "video", "picture"]


@dataclass(frozen=True, slots=True)
class RenderQuality:
    """How a .blend is rendered: about ``pixels`` pixels, in the scene's own proportions, with ``samples`` per pixel."""

    pixels: int = 480 * 270
    samples: int = 16


@dataclass(frozen=True, slots=True)
class FrameSet:
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


def take_frames(  # noqa: PLR0913 - what is taken, how, and who is told
    source: Path,
    static: bool,
    folder: Path,
    quality: RenderQuality | None = None,
    options: BlenderOptions | None = None,
    *,
    tell: Callable[[str], None] | None = None,
) -> FrameSet:
    """As ``frames_of``, with notes. ``tell`` is called with each frame that is being rendered, in words.

    Raises NotScored, or CannotStart if no Blender works.
    """
    shares = SHARES[:1] if static else SHARES
    kind = kind_of(source)
    if kind == "blend":
        means = options or BlenderOptions(seconds=SECONDS)
        return _frames_of_blend(source, shares, folder, quality or RenderQuality(), means, tell=tell)
    if kind == "picture" and not static:
        raise NotScored("a picture has one frame only; a clip needs a video or a .blend")
    return FrameSet(kind, tuple(_write_pictures(folder, shares, video.pictures(source, shares))))


def kind_of(source: Path) -> Source:
    """The kind of a file, by its name."""
    suffix = source.suffix.lower()
    if suffix == ".blend":
        return "blend"
    return "picture" if suffix in video.PICTURES else "video"


def _frames_of_blend(  # noqa: PLR0913 - as above
    blend: Path,
    shares: Sequence[float],
    folder: Path,
    quality: RenderQuality,
    options: BlenderOptions,
    *,
    tell: Callable[[str], None] | None,
) -> FrameSet:
    """Renders with unbaked physics simulated; if that takes too long or Blender ends, again without that physics."""
    notes: list[str] = []
    try:
        rendered = _rendered(blend, shares, quality, options, tell=tell, jump=False)
    except NotScored as error:
        first, why = error, str(error)
        try:
            rendered = _rendered(blend, shares, quality, options, tell=tell, jump=True)
        except NotScored:
            raise first from None
        notes.append(f"rendered without unbaked physics, after a first try failed ({why})")
    else:
        notes += [f"not baked, simulated while rendering: {each}" for each in rendered.unbaked]
    if rendered.camera is None:
        notes.append("the scene has no camera; one that sees all of it was added")
    return FrameSet("blend", tuple(_write_pictures(folder, shares, _decoded(rendered))), tuple(notes))


def _rendered(  # noqa: PLR0913 - as above
    blend: Path,
    shares: Sequence[float],
    quality: RenderQuality,
    options: BlenderOptions,
    *,
    tell: Callable[[str], None] | None,
    jump: bool,
) -> _Rendered:
    arguments: dict[str, Any] = {
        "shares": list(shares),
        "pixels": quality.pixels,
        "samples": quality.samples,
        "jump": jump,
    }

    def progress(done: float, total: float | None, _: str) -> None:
        if tell is not None and total is not None:
            tell(f"rendering frame {done + 1:.0f} of {total:.0f}")

    with UntrustedBlend(blend, options) as file:
        answer = file.ask("frames", **arguments, doing="rendering it", progress=progress)
    try:
        rendered = _Rendered.model_validate(answer)
    except ValidationError:
        raise NotScored("Blender's reply after rendering it was not valid") from None
    if len(rendered.frames) != len(shares):
        raise NotScored(f"Blender rendered {len(rendered.frames)} frames of it instead of {len(shares)}")
    return rendered


def _decoded(rendered: _Rendered) -> list[bytes]:
    try:
        return [base64.b64decode(each.png, validate=True) for each in rendered.frames]
    except (binascii.Error, ValueError):
        raise NotScored("a rendered frame of it is not a picture") from None


def _write_pictures(folder: Path, shares: Sequence[float], contents: Sequence[bytes]) -> list[Path]:
    """Writes the pictures, named after their per cent of the clip, and deletes older ones. Raises NotScored."""
    with closing(PictureDecoder(best_sandbox())) as decoder:
        pictures = [_reencoded(decoder, content) for content in contents]
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{round(100 * share):03}.png" for share in shares]
    for path in {*folder.glob("*.png")} - {*paths}:
        path.unlink()
    for path, content in zip(paths, pictures, strict=True):
        write_whole(path, content, durable=False)
    return paths


def _reencoded(decoder: PictureDecoder, content: bytes) -> bytes:
    """A PNG of the same pixels and nothing else, shrunk to the size that is judged. Raises NotScored."""
    try:
        picture = decoder.decode(
            io.BytesIO(content), "of a frame", longest=_LONGEST_SIDE, most_pixels=_MOST_PIXELS
        )
    except Refusal as error:
        raise NotScored(f"a frame is not a picture: {error}") from None
    png = io.BytesIO()
    picture.image.save(png, "PNG")
    return png.getvalue()
