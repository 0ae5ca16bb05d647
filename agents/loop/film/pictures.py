"""Rendered files of a run: their pictures as models see them, and their place in the run's folder."""

from __future__ import annotations

import os
import shutil
from contextlib import closing
from typing import TYPE_CHECKING

from agents.blender.render.image_checks import LARGEST_STILL, look_at
from simworlds.llm.messages import Picture
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

LARGEST_FRAME = 1024  # pixels a side, of one of several frames


def pictures_of(paths: Sequence[Path]) -> tuple[tuple[Path, Picture], ...]:
    """Rendered frames with their pictures as models see them; Blender has written the files."""
    largest = LARGEST_STILL if len(paths) == 1 else LARGEST_FRAME
    with closing(PictureDecoder(best_sandbox())) as decoder:
        return tuple((path, Picture(look_at(decoder, path, largest).png)) for path in paths)


def link(made: Path, result: Path) -> None:
    """Puts a file into a place in the run's folder as well."""
    result.unlink(missing_ok=True)
    try:
        os.link(made, result)
    except OSError:
        shutil.copyfile(made, result)
