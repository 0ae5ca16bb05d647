"""Pictures that Blender has left in its workspace, as pixels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.blender.sheets.contact_sheet import PAPER

if TYPE_CHECKING:
    from PIL import Image

    from agents.blender.sheets.contact_sheet import Colour
    from agents.blender.supervisor import Supervisor

_MOST_PIXELS = 4096 * 4096
_LARGEST = 256 << 20  # bytes


def taken_picture(blender: Supervisor, name: str, under: Colour = PAPER) -> Image.Image:
    """A PNG as an RGB picture, ``under`` behind what is transparent; the file is removed. Raises Refusal."""
    workspace = blender.folder.workspace
    try:
        with workspace.open(name, at_most=_LARGEST) as file:
            return blender.pictures.decode(file, name, most_pixels=_MOST_PIXELS, under=under).image
    finally:
        workspace.remove(name)
