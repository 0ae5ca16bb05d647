"""Checks the inputs of an edit: a .blend and, optionally, a reference picture."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.loop.errors import Unusable
from simworlds.formats.blend_file import HEAD, begins_blend
from simworlds.llm.picture_file import BadPicture, read_picture

if TYPE_CHECKING:
    from pathlib import Path

    from agents.loop.options import Options
    from simworlds.llm.messages import Picture


def check_inputs(options: Options) -> None:
    """Checks that the files are a .blend and a picture. Raises Unusable."""
    if options.mode != "edit":
        return
    if options.file is None:
        raise Unusable("There is nothing to edit: give a .blend.")
    try:
        with options.file.open("rb") as file:
            head = file.read(HEAD)
    except OSError as error:
        raise Unusable(f"{options.file} cannot be read: {error.strerror or error}.") from error
    if not begins_blend(head):
        raise Unusable(f"{options.file} is not a .blend file: its first bytes are not those of one.")
    if options.reference is not None:
        picture(options.reference)


def picture(path: Path) -> Picture:
    """A picture as models get it. Raises Unusable."""
    try:
        return read_picture(path)
    except BadPicture as error:
        raise Unusable(str(error)) from error
