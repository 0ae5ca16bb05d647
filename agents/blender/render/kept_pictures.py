"""Pictures of the scene that are kept, so that none is rendered again while all that it shows is unchanged."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from PIL import Image

from agents.blender.sheets.contact_sheet import to_png
from simworlds.files import write_whole
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from pathlib import Path

_MOST = 100


class KeptPictures:
    """Those in ``folder``, the latest hundred, by keys: digests of all that they show."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    @property
    def keys(self) -> list[str]:
        """Of all that are there, the latest last."""
        return [path.stem for path in self._paths()]

    def get(self, key: str) -> Image.Image:
        """The picture of a key. Raises Refusal."""
        path = self._folder / f"{key}.png"
        try:
            with Image.open(path) as picture:
                return picture.convert("RGB")
        except OSError as error:
            raise Refusal(f"{path}, a picture that was kept, cannot be read: {error}. Call again.") from error

    def keep(self, key: str, picture: Image.Image) -> None:
        """Keeps a picture, in place of the oldest where there are many."""
        write_whole(self._folder / f"{key}.png", to_png(picture), durable=False)
        for path in self._paths()[:-_MOST]:
            path.unlink(missing_ok=True)

    def _paths(self) -> list[Path]:
        found: list[tuple[int, str, Path]] = []
        for path in self._folder.glob("*.png"):
            with suppress(OSError):
                found.append((path.stat().st_mtime_ns, path.name, path))
        return [path for _, _, path in sorted(found)]
