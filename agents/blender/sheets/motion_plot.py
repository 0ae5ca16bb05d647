"""Draws motion: its trail on images, and a timeline of curves, phases, caches, contacts and keyframes.

Everything on a timeline shares one axis of frames, so that what is above each other happens at the same time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw

from agents.blender.sheets.contact_sheet import GREY, INK, PAPER, RUST, WHITE, Colour, Style, draw_axes, write
from agents.blender.sheets.text_layout import shortened, text_width

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

Place = tuple[float, float]
Curve = list[float | None]

BLUE: Colour = (30, 100, 200)
ORANGE: Colour = (214, 98, 0)
GREEN: Colour = (52, 140, 70)
AMBER: Colour = (214, 150, 20)
KEY: Colour = (236, 190, 40)
PALE: Colour = (226, 228, 230)
TINTS: tuple[Colour, ...] = ((232, 239, 248), (246, 239, 228), (232, 244, 234), (244, 234, 243))
EDGES: tuple[Colour, ...] = ((86, 134, 196), (200, 146, 70), (92, 160, 104), (166, 104, 158))

_LABELS, _RIGHT = 186, 50
_CURVES, _HEAD, _ROW, _AXIS = 130, 54, 20, 26
_GIZMO = (112, 92)
_FINER = 3  # lines are drawn this many times larger, then shrunk
_LABEL = Style(13, GREY)
_NUMBER = Style(12, GREY)


@dataclass(frozen=True, slots=True)
class PhaseBand:
    """A named range of frames; the first of ``summaries`` that fits is written in it."""

    name: str
    start: int
    end: int
    summaries: tuple[str, ...]


def lanes_of(spans: Iterable[tuple[int, int]]) -> list[int]:
    """The lane of each of these ranges of frames, which are in the order of their starts: those of one lane follow one
    another, and may have an end and a start in common.
    """
    ends: list[int] = []
    lanes: list[int] = []
    for start, end in spans:
        lane = next((number for number, before in enumerate(ends) if before <= start), len(ends))
        ends[lane : lane + 1] = [end]
        lanes.append(lane)
    return lanes


@dataclass(frozen=True, slots=True)
class BarRow:
    """Bars over ``spans`` of frames, with ``text`` beside them; ``dashed``: not certain."""

    label: str
    spans: list[tuple[int, int]]
    colour: Colour
    text: str = ""
    dashed: bool = False


@dataclass(frozen=True, slots=True)
class MotionCourse:
    """A motion over ``frames``: ``displacements`` in m, ``speeds`` in m/s (None where unknown)."""

    frames: list[int]
    displacements: Curve
    speeds: Curve
    speed_label: str
    phases: list[PhaseBand]
    sampled: list[int]
    keyframes: list[int]
    rows: list[BarRow]
    axes: list[tuple[str, float, float, float]]  # as draw_axes has them


# On images


def draw_trail(picture: Image.Image, places: Sequence[Place | None], at: int) -> None:
    """The trail of a motion in pixels: strong up to place number ``at``, pale after it, with a dot there."""
    before = [place for place in places[: at + 1] if place is not None]
    after = [place for place in places[at:] if place is not None]

    def draw(layer: ImageDraw.ImageDraw, finer: int) -> None:
        for line, colour, width in (
            (after, (255, 255, 255, 150), 3.0),
            (after, (*BLUE, 110), 1.2),
            (before, (255, 255, 255, 200), 3.6),
            (before, (*BLUE, 255), 1.7),
        ):
            if len(line) > 1:
                points = [(x * finer, y * finer) for x, y in line]
                layer.line(points, fill=colour, width=round(width * finer), joint="curve")
        here = places[at]
        if here is not None:
            x, y = (part * finer for part in here)
            for reach, colour in ((4.4, WHITE), (3.0, BLUE)):
                layer.ellipse(
                    (x - reach * finer, y - reach * finer, x + reach * finer, y + reach * finer),
                    fill=(*colour, 255),
                )

    _layered(picture, draw)


def _layered(picture: Image.Image, draw: Callable[[ImageDraw.ImageDraw, int], None]) -> None:
    """Lets ``draw`` draw on a larger layer, which is shrunk and put over the image with soft edges."""
    width, height = picture.size
    layer = Image.new("RGBA", (width * _FINER, height * _FINER), (0, 0, 0, 0))
    draw(ImageDraw.Draw(layer), _FINER)
    soft = layer.reduce(_FINER)
    picture.paste(soft.convert("RGB"), (0, 0), soft.getchannel("A"))


# Over frames


def timeline(course: MotionCourse, width: int) -> Image.Image:
    """A timeline: phases, two curves, and below them bars and keyframes."""
    rows = len(course.rows) + bool(course.keyframes)
    lanes = lanes_of((phase.start, phase.end) for phase in course.phases)
    head = _HEAD * (max(lanes, default=0) + 1)
    picture = Image.new("RGB", (width, head + _CURVES + _AXIS + _ROW * rows), PAPER)
    _Timeline(picture, course, lanes, head).draw()
    return picture


class _Timeline:
    def __init__(self, picture: Image.Image, course: MotionCourse, lanes: list[int], head: int) -> None:
        self._picture, self._course, self._lanes = picture, course, lanes
        self._draw = ImageDraw.Draw(picture)
        self._left, self._right = _LABELS, picture.width - _RIGHT
        self._top, self._bottom = head, head + _CURVES
        self._first, self._last = course.frames[0], course.frames[-1]

    def _x(self, frame: float) -> float:
        share = (frame - self._first) / max(self._last - self._first, 1)
        return self._left + share * (self._right - self._left)

    def draw(self) -> None:
        """Everything, from back to front."""
        gizmo = Image.new("RGB", _GIZMO, PAPER)
        draw_axes(gizmo, self._course.axes)
        self._picture.paste(gizmo, (0, 0))
        self._draw_phases()
        self._draw_frames()
        course = self._course
        self._draw_curve(course.displacements, "displacement, m", BLUE, left=True)
        self._draw_curve(course.speeds, course.speed_label, ORANGE, left=False)
        y = self._bottom + _AXIS
        for row in course.rows:
            self._draw_row(row, y)
            y += _ROW
        if course.keyframes:
            self._draw_keyframes(y)

    def _draw_phases(self) -> None:
        """Those at one time below each other: their names above the curves, and their tints behind them."""
        starts = {phase.start for phase in self._course.phases}
        ends = {phase.end for phase in self._course.phases}
        count = max(self._lanes, default=0) + 1
        for number, (phase, lane) in enumerate(zip(self._course.phases, self._lanes, strict=True)):
            head = _HEAD * lane
            above, below = (self._top + _CURVES * part // count for part in (lane, lane + 1))
            # Phases that end and begin on neighbouring frames meet half-way between them.
            left = self._x(phase.start - (0.5 if phase.start - 1 in ends else 0))
            right = self._x(phase.end + (0.5 if phase.end + 1 in starts else 0))
            tint, edge = TINTS[number % len(TINTS)], EDGES[number % len(EDGES)]
            self._draw.rectangle((left, above, right, below), fill=tint)
            self._draw.rectangle((left, head, right, head + 2), fill=edge)
            for x in (left, right):
                self._draw.line((x, head, x, head + _HEAD), fill=edge)
                self._draw.line((x, above, x, below), fill=edge)
            room = right - left - 8
            name = f"{phase.name}  {phase.start}–{phase.end}" if phase.name else f"{phase.start}–{phase.end}"
            if room > 24:
                write(self._draw, (left + 5, head + 5), shortened(name, room, 14), Style(14))
                fitting = [words for words in phase.summaries if text_width(words, 13) <= room]
                write(self._draw, (left + 5, head + 24), fitting[0] if fitting else "", _LABEL)

    def _draw_frames(self) -> None:
        draw, y = self._draw, self._bottom
        for frame in self._course.sampled:
            x = self._x(frame)
            draw.line((x, self._top, x, y), fill=(190, 194, 200))
            draw.polygon([(x - 5, self._top - 7), (x + 5, self._top - 7), (x, self._top)], fill=GREY)
        draw.line((self._left, y, self._right, y), fill=GREY)
        step = _round_step((self._last - self._first) / 10, whole=True)
        for frame in range(math.ceil(self._first / step) * int(step), self._last + 1, int(step)):
            x = self._x(frame)
            draw.line((x, y, x, y + 4), fill=GREY)
            write(draw, (x, y + 6), str(frame), _NUMBER, anchor="ma")
        write(draw, (self._left - 12, y + 6), "frame", _LABEL, anchor="ra")

    def _draw_curve(self, values: Curve, label: str, colour: Colour, *, left: bool) -> None:
        known = [value for value in values if value is not None]
        top = max(known, default=0.0)
        step = _round_step(max(top, 1e-3) / 3)
        top = math.ceil(max(top, 1e-3) / step - 1e-6) * step
        style = Style(12, colour)
        x, anchor = (self._left - 6, "rm") if left else (self._right + 6, "lm")
        for number in range(round(top / step) + 1):
            y = self._bottom - number * step / top * _CURVES
            write(self._draw, (x, y), _format(number * step, step), style, anchor=anchor)
        y = self._top + (46 if left else 74)
        self._draw.line((8, y, 22, y), fill=colour, width=3)
        write(self._draw, (28, y), shortened(label, _LABELS - 28 - 34, 13), Style(13, colour), anchor="lm")

        def draw(layer: ImageDraw.ImageDraw, finer: int) -> None:
            for piece in _pieces(self._course.frames, values):
                points = [
                    (self._x(frame) * finer, (self._bottom - value / top * _CURVES) * finer)
                    for frame, value in piece
                ]
                if len(points) > 1:
                    layer.line(points, fill=(*colour, 255), width=2 * finer, joint="curve")
                else:
                    x, y = points[0]
                    layer.ellipse(
                        (x - 2 * finer, y - 2 * finer, x + 2 * finer, y + 2 * finer), fill=(*colour, 255)
                    )

        _layered(self._picture, draw)

    def _draw_row(self, row: BarRow, y: float) -> None:
        draw, middle = self._draw, y + _ROW / 2
        write(draw, (8, middle), shortened(row.label, _LABELS - 20, 13), _LABEL, anchor="lm")
        draw.line((self._left, middle, self._right, middle), fill=PALE)
        ends: list[float] = []
        for first, last in row.spans:
            start, end = max(first, self._first), min(last, self._last)
            if start > end:
                continue
            left, right = self._x(start), max(self._x(end), self._x(start) + 4)
            ends += [left, right]
            width, step = (7, 11) if row.dashed else (right - left, right - left + 1)
            while left < right:
                draw.rectangle((left, y + 4, min(left + width, right), y + _ROW - 4), fill=row.colour)
                left += step
        self._write_beside(row, min(ends, default=self._left), max(ends, default=self._left), middle)

    def _write_beside(self, row: BarRow, left: float, right: float, y: float) -> None:
        """The text of a bar: after it, before it, or on it, wherever there is room."""
        wide, style = text_width(row.text, 12), Style(12, row.colour)
        if right + 12 + wide < self._right:
            x = right + 7
        elif left - 12 - wide > self._left:
            x = left - 7 - wide
        else:
            x, style = (left + right - wide) / 2, Style(12, INK)
        self._draw.rectangle((x - 5, y - 8, x + wide + 5, y + 8), fill=PAPER)
        write(self._draw, (x, y), row.text, style, anchor="lm")

    def _draw_keyframes(self, y: float) -> None:
        middle = y + _ROW / 2
        write(self._draw, (8, middle), f"keyframes ({len(self._course.keyframes)})", _LABEL, anchor="lm")
        self._draw.line((self._left, middle, self._right, middle), fill=PALE)
        crowded = (self._right - self._left) / max(self._last - self._first, 1) < 5
        reach = 3 if crowded and len(self._course.keyframes) > 20 else 5
        for frame in self._course.keyframes:
            x = self._x(frame)
            diamond = [(x, middle - reach), (x + reach, middle), (x, middle + reach), (x - reach, middle)]
            self._draw.polygon(diamond, fill=KEY, outline=(110, 84, 0))


def _pieces(frames: Iterable[int], values: Curve) -> list[list[tuple[int, float]]]:
    """The parts of a curve with known values."""
    pieces: list[list[tuple[int, float]]] = [[]]
    for frame, value in zip(frames, values, strict=True):
        if value is None:
            pieces.append([])
        else:
            pieces[-1].append((frame, value))
    return [piece for piece in pieces if piece]


def _round_step(least: float, *, whole: bool = False) -> float:
    """The smallest of …, 0.5, 1, 2, 5, 10, 20, … that is at least ``least``."""
    power = 10.0 ** math.floor(math.log10(max(least, 1e-9)))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= least * (1 - 1e-9))
    return max(1.0, step) if whole else step


def _format(value: float, step: float) -> str:
    digits = max(0, -math.floor(math.log10(step) + 1e-9))
    return f"{value:.{digits}f}"


STATES: dict[str, Colour] = {"baked": GREEN, "unbaked": AMBER}


def state_colour(state: str) -> Colour:
    """The colour of a cache's state: green if it can be trusted."""
    return RUST if "outdated" in state else STATES.get(state, GREY)
