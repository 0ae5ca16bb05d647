"""Rendered pictures as models are shown them, and what makes them useless."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from agents.blender.render.picture_numbers import numbers_of
from agents.blender.sheets.contact_sheet import to_png

if TYPE_CHECKING:
    from pathlib import Path

    from PIL import Image

    from agents.blender.render.picture_numbers import PictureNumbers
    from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

LARGEST_PREVIEW, LARGEST_STILL = 768, 1568  # pixels a side, of one of many and of a picture alone
_DARK = 6  # of 255


@dataclass(frozen=True, slots=True)
class RenderedPicture:
    """A picture at ``path``; ``image``: a copy, shrunk if it is large; its ``numbers``; lowest and highest value of its
    channels (0 to 255); a ``digest`` of its pixels."""

    path: Path
    image: Image.Image
    numbers: PictureNumbers
    ranges: tuple[tuple[int, int], ...]
    digest: str

    @property
    def png(self) -> bytes:
        """The copy as a PNG file."""
        return to_png(self.image)


def look_at(decoder: PictureDecoder, path: Path, longest: int = LARGEST_PREVIEW) -> RenderedPicture:
    """A picture that Blender has rendered, at most ``longest`` pixels a side. Raises Refusal for what is no PNG."""
    with path.open("rb") as file:
        picture = decoder.decode(file, path.name, longest=longest)
    return RenderedPicture(path, picture.image, numbers_of(picture.image), picture.ranges, picture.digest)


def image_faults(pictures: list[RenderedPicture]) -> list[str]:
    """Sentences on what makes pictures useless: black, of one colour, or all frames alike."""
    faults: list[str] = []
    for picture in pictures:
        if max(high for _, high in picture.ranges) <= _DARK:
            faults.append(f"{picture.path.name} is black: there is no light, or something blocks the camera.")
        elif all(high - low <= 1 for low, high in picture.ranges):
            faults.append(
                f"{picture.path.name} is one colour: nothing is in view, or the camera is inside an object."
            )
    if not faults and len(pictures) > 1 and len({picture.digest for picture in pictures}) == 1:
        faults.append("The first, middle and last frame are identical: nothing moves in view.")
    return faults
