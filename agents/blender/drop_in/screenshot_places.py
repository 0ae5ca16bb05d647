"""Where screenshots are written: to a path that a client gives, if it leads to a place that is meant for them."""

from __future__ import annotations

import tempfile
from pathlib import Path

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import HostileGround

_PNG = b"\x89PNG\r\n\x1a\n"


class ScreenshotPlaces:
    """The temporary folder, in which clients make up names, and the folders of ``more``.

    Others can write to these folders too. So no link below them is followed, and nothing is replaced but pictures.
    """

    def __init__(self, more: tuple[Path, ...] = ()) -> None:
        self._folders = (Path(tempfile.gettempdir()), *more)

    def write(self, path: str, png: bytes) -> None:
        """Writes a picture, whole or not at all. Raises Refusal."""
        ground, relative = self._find(path)
        if not png.startswith(_PNG):
            raise Refusal(f"What is to be written to {path[:300]} is not a PNG.")
        try:
            ground.write(relative, png, over=_PNG)
        except Refusal as error:
            raise Refusal(f"The screenshot cannot be written to {path[:300]}: {error}") from error

    @property
    def spellings(self) -> tuple[str, ...]:
        """The folders, as they are spelled and as they really are."""
        return tuple(
            dict.fromkeys(str(one) for folder in self._folders for one in (folder, folder.resolve()))
        )

    def check(self, path: str) -> None:
        """Raises Refusal for a path that no screenshot may be written to."""
        self._find(path)

    def _find(self, path: str) -> tuple[HostileGround, str]:
        """(folder, path in it)."""
        wanted = Path(path)
        if "\0" not in path and ".." not in wanted.parts and wanted.suffix.lower() == ".png":
            for folder in self._folders:
                # A client spells a folder as it knows it, which may be by a link.
                for spelled in (folder, folder.resolve()):
                    if wanted.is_relative_to(spelled):
                        return HostileGround(folder.resolve()), wanted.relative_to(spelled).as_posix()
        raise Refusal(
            f"The screenshot cannot be written to {path[:300]!r}: give a path that ends in .png below "
            f"{' or '.join(map(str, self._folders))}. Start the server with --screenshots FOLDER to allow another one."
        )
