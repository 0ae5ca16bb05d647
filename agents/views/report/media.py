"""Pictures and videos of a run, as a page that stands alone can have them.

The paths come from a journal, which anybody may have written: only plain files beneath the run's folder are read, and
pictures are made anew from their pixels, so that nothing but an image gets into the page.
"""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING
from urllib.parse import quote

from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import BlenderError
from simworlds.sandbox.pictures.decode_pictures import FORMATS
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Mapping

LARGEST_VIDEO = 8 * 1024 * 1024  # bytes that are put into the page
LARGEST_PAGE = 40 * 1024 * 1024  # bytes of pictures that are
_SIDE = 1280  # pixels
_QUALITY = 82
_MOST_PIXELS = 60_000_000
_VIDEOS: Mapping[str, str] = {".mp4": "video/mp4", ".webm": "video/webm"}


@dataclass(frozen=True, slots=True)
class MediaItem:
    """A picture or video: ``src`` is its data or where it is, ``link`` leads to its file in the run's folder."""

    src: str
    link: str
    width: int = 0
    height: int = 0


class Media:
    """What is in the folder of one run."""

    def __init__(self, run: Path) -> None:
        self._run = run
        self._known: dict[str, MediaItem | None] = {}
        self._used = 0
        self._decoder = PictureDecoder(best_sandbox())

    def close(self) -> None:
        """Ends what reads pictures."""
        self._decoder.close()

    def picture(self, name: str) -> MediaItem | None:
        """The picture, scaled down where it is large; None where there is none."""
        if name not in self._known:
            path = self._path(name)
            self._known[name] = self._made(name, path) if path else None
        return self._known[name]

    def video(self, name: str) -> MediaItem | None:
        """The video, in the page if it is small; None where there is none."""
        path = self._path(name)
        kind = _VIDEOS.get(path.suffix.lower()) if path else None
        if not path or not kind:
            return None
        try:
            if path.stat().st_size > LARGEST_VIDEO:
                return MediaItem(_link(name), _link(name))
            return MediaItem(_data(kind, path.read_bytes()), _link(name))
        except OSError:
            return None

    def link(self, name: str) -> str:
        """A relative link to a file of the run that is there; "" where it is not."""
        return _link(name) if self._path(name) else ""

    def _path(self, name: str) -> Path | None:
        """The plain file of that name, if it is one beneath the run's folder."""
        relative = PurePosixPath(name)
        if not name or relative.is_absolute() or ".." in relative.parts or "\0" in name:
            return None
        try:
            path = (self._run / relative).resolve()
            inside = path.is_relative_to(self._run.resolve())
            return path if inside and path.is_file() else None
        except (OSError, RuntimeError, ValueError):
            return None

    def _made(self, name: str, path: Path) -> MediaItem | None:
        try:
            with path.open("rb") as file:
                picture = self._decoder.decode(
                    file, name, longest=_SIDE, most_pixels=_MOST_PIXELS, formats=FORMATS
                )
        except (OSError, BlenderError):
            return None
        made = io.BytesIO()
        picture.image.save(made, "WEBP", quality=_QUALITY, method=4)
        self._used += made.tell()
        if self._used > LARGEST_PAGE:
            return MediaItem(_link(name), _link(name), *picture.size)
        return MediaItem(_data("image/webp", made.getvalue()), _link(name), *picture.image.size)


def _data(kind: str, content: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"


def _link(name: str) -> str:
    """Relative, whatever is in the name: a colon in its first part would make it a scheme."""
    return "./" + quote(PurePosixPath(name).as_posix(), safe="/")
