"""What a rendered picture comes to in numbers: how much of it is black or burnt out, and how bright it is."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from PIL import Image, ImageChops

from simworlds.counting import format_list

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

_BLACK, _BURNT = 8, 250  # of 255: no channel is above, and none is below
_SHOWN = 12
_LEAST_SHARE = 0.00005


@dataclass(frozen=True, slots=True)
class PictureNumbers:
    """Shares of the picture's area, and brightness as displayed (0 to 1) below which 5, 50 and 95 % of it are."""

    black: float
    burnt_out: float
    dark: float
    middle: float
    bright: float

    @property
    def data(self) -> dict[str, float]:
        """The same as JSON data, rounded."""
        return {name: round(value, 4) for name, value in asdict(self).items()}

    def __str__(self) -> str:
        return (
            f"{_percent(self.black)} black, {_percent(self.burnt_out)} burnt out; brightness (0 to 1, as displayed) "
            f"{self.dark:.2f} at the 5th, {self.middle:.2f} at the 50th, {self.bright:.2f} at the 95th percentile"
        )


@dataclass(frozen=True, slots=True)
class SubjectNumbers:
    """How much of the picture an object covers, and its mean brightness as displayed (0 to 1).

    What is seen through an object that is ``clear`` counts as of that object.
    """

    name: str
    share: float
    brightness: float
    clear: bool = False

    @property
    def data(self) -> dict[str, Any]:
        """The same as JSON data, rounded."""
        return {"name": self.name, "share": round(self.share, 5), "brightness": round(self.brightness, 3)}


def numbers_of(picture: Image.Image) -> PictureNumbers:
    """The numbers of an RGB picture."""
    red, green, blue = picture.split()
    highest = ImageChops.lighter(ImageChops.lighter(red, green), blue).histogram()
    lowest = ImageChops.darker(ImageChops.darker(red, green), blue).histogram()
    area = picture.width * picture.height
    below = list(accumulate(picture.convert("L").histogram()))
    dark, middle, bright = (
        next(value for value in range(256) if below[value] >= share * area) / 255
        for share in (0.05, 0.5, 0.95)
    )
    return PictureNumbers(
        sum(highest[: _BLACK + 1]) / area, sum(lowest[_BURNT:]) / area, dark, middle, bright
    )


def subjects_of(
    picture: Image.Image,
    mask: Image.Image,
    colours: Mapping[tuple[int, int, int], str],
    clear: Collection[str] = (),
) -> list[SubjectNumbers]:
    """The numbers of each object of a ``mask``, which shows the same view in flat ``colours``; the largest first.

    ``clear``: the objects through which one sees.
    """
    small = picture.convert("L").resize(mask.size, Image.Resampling.BOX).tobytes()
    counts = dict.fromkeys(colours.values(), 0)
    sums = dict.fromkeys(colours.values(), 0)
    pixels = mask.tobytes()
    for at, value in enumerate(small):
        red, green, blue = pixels[3 * at : 3 * at + 3]
        name = colours.get((red, green, blue))
        if name is not None:
            counts[name] += 1
            sums[name] += value
    found = [
        SubjectNumbers(name, count / len(small), sums[name] / count / 255 if count else 0.0, name in clear)
        for name, count in counts.items()
    ]
    return sorted(found, key=lambda one: (-one.share, one.name))


def format_subjects(subjects: Sequence[SubjectNumbers], frame: int) -> list[str]:
    """Lines on what the picture of a frame shows of each object."""
    seen = [one for one in subjects if one.share > _LEAST_SHARE]
    hidden = [one.name for one in subjects if one.share <= _LEAST_SHARE]
    lines: list[str] = []
    if seen:
        told = [f"{one.name} {_percent(one.share)} ({one.brightness:.2f})" for one in seen[:_SHOWN]]
        more = f" … and {len(seen) - _SHOWN} more" if len(seen) > _SHOWN else ""
        lines.append(f"Frame {frame}, share of the picture (mean brightness): {', '.join(told)}{more}.")
    if hidden:
        clear = format_list([one.name for one in seen if one.clear], _SHOWN)
        through = f", but for what is seen through {clear}, which was not measured" if clear else ""
        lines.append(f"Frame {frame} shows nothing of {format_list(hidden, _SHOWN)}{through}.")
    return lines


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if 0 < share < 0.1 else f"{100 * share:.0f} %"
