"""Saves images for the model below ``previews`` in the run's folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.blender.tools.base import SavedImage
from simworlds.files import write_whole

if TYPE_CHECKING:
    from agents.blender.files.run_folder import RunFolder

FOLDER = "previews"


def new_preview(folder: RunFolder, name: str, png: bytes) -> SavedImage:
    """Saves a PNG under the next free number: ``previews/0007-NAME.png``."""
    previews = folder.root / FOLDER
    begins = (path.name.partition("-")[0] for path in previews.glob("[0-9]*-*.png"))
    numbers = (int(begin) for begin in begins if begin.isdecimal())
    path = previews / f"{1 + max(numbers, default=0):04d}-{name}.png"
    write_whole(path, png, durable=False)
    return SavedImage(png, path)
