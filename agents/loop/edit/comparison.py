"""An edited file's picture beside that of the file as it was, and beside what it is to look like."""

from __future__ import annotations

import io
from contextlib import closing
from typing import TYPE_CHECKING

from PIL import Image, ImageChops

from agents.blender.sheets.contact_sheet import Panel, grid, sheet, to_png
from simworlds.llm.messages import Picture, Text
from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.pictures.decode_pictures import FORMATS
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from agents.loop.running.run import Run
    from agents.loop.task import RunTask
    from simworlds.llm.messages import Block

_WIDTH = 720  # pixels, of each picture
_BEFORE, _NOW, _GOAL = "before the edit", "now", "wanted"


def photometric_loss(picture: Image.Image, other: Image.Image) -> float:
    """PL: the mean squared difference of two RGB pictures' values in [0, 1], × 100; 0 is best.

    ``other`` is brought to the size of ``picture`` by Pillow's bicubic filter.
    """
    counts = ImageChops.difference(picture, _sized(other, picture.size)).histogram()
    squares = sum(count * (value % 256) ** 2 for value, count in enumerate(counts))
    return 100 * squares / 255**2 / (3 * picture.width * picture.height)


def references(task: RunTask) -> list[Block | str]:
    """What an edit is compared with, for whoever makes it."""
    shown: list[Block | str] = []
    if task.before is not None:
        shown += [
            Text(f"The file through its camera, frame {task.before_frame}, before the edit:"),
            task.before,
        ]
    if task.goal is not None:
        shown += [Text("What the result should look like:"), task.goal]
    return shown


def compared(run: Run, task: RunTask, now: Picture) -> list[Block | str]:
    """One sheet with the pictures at the same size, and how far they are from each other."""
    with closing(PictureDecoder(best_sandbox(run.options.sandbox))) as decoder:
        try:
            present = _decoded(decoder, now)
            others = {
                name: _decoded(decoder, picture)
                for name, picture in ((_BEFORE, task.before), (_GOAL, task.goal))
                if picture is not None
            }
        except Refusal as refusal:
            return [Text(f"The pictures cannot be compared: {refusal}")]
    size = (min(_WIDTH, present.width), max(1, round(present.height * min(1, _WIDTH / present.width))))
    losses = {
        name: photometric_loss(_sized(present, size), _sized(other, size)) for name, other in others.items()
    }
    pictures = {_BEFORE: others.get(_BEFORE), _NOW: present, _GOAL: others.get(_GOAL)}
    panels = [
        Panel(_sized(picture, size), name, f"PL {losses[name]:.2f}" if name in losses else "")
        for name, picture in pictures.items()
        if picture is not None
    ]
    told = "; ".join(f"PL between now and {name}: {loss:.2f}" for name, loss in losses.items())
    words = f"{told} (photometric loss: mean squared difference of the pixels × 100; 0 is equal)."
    title = f"Frame {task.before_frame}" if task.before_frame is not None else "The edit"
    made = sheet(title, [grid(panels, min(2, len(panels)))])
    return [Text(words), Picture(to_png(made))]


def _decoded(decoder: PictureDecoder, picture: Picture) -> Image.Image:
    return decoder.decode(io.BytesIO(picture.data), "to compare", longest=2048, formats=FORMATS).image


def _sized(picture: Image.Image, size: tuple[int, int]) -> Image.Image:
    return picture if picture.size == size else picture.resize(size, Image.Resampling.BICUBIC)
