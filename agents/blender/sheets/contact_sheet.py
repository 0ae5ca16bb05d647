"""Contact sheets: images in a grid, each with its caption, under one title.

A sheet is made of blocks, which are images themselves:

    views = grid([Panel(picture, "front"), Panel(other, "right")], columns=2)
    to_png(sheet("Chair", [views], subtitle="frame 12", notes=["Cloth is not baked."]))
"""

from __future__ import annotations

import io
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw

from agents.blender.sheets.text_layout import (
    font_for,
    format_length,
    round_length,
    shortened,
    text_width,
    wrapped,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

Colour = tuple[int, int, int]
Rectangle = tuple[float, float, float, float]  # left, top, right, bottom

PAPER: Colour = (250, 250, 248)
INK: Colour = (24, 26, 30)
GREY: Colour = (92, 96, 104)
FRAME: Colour = (172, 176, 182)
RUST: Colour = (168, 60, 0)
WHITE: Colour = (255, 255, 255)
X_RED: Colour = (205, 40, 55)
Y_GREEN: Colour = (62, 135, 20)
Z_BLUE: Colour = (40, 100, 215)

MARGIN, GAP = 12, 8
_BAR_SHARE = 0.3  # of an image's width, for the scale bar
_GIZMO_REACH = 28


@dataclass(frozen=True, slots=True)
class Style:
    """A style of text: ``size`` in pixels; ``halo``: width of a white outline, for text on images."""

    size: int = 15
    colour: Colour = INK
    halo: int = 0


TITLE = Style(22)
TEXT = Style()
FAINT = Style(colour=GREY)
SMALL = Style(13, GREY)
WARNING = Style(colour=RUST)
ON_PICTURE = Style(14, halo=2)
LABEL = Style(12, halo=2)


@dataclass(frozen=True, slots=True)
class Panel:
    """An image with its ``caption`` above it; ``side_note`` is at the right end of the caption's line.

    ``border`` is the colour of its frame.
    """

    picture: Image.Image
    caption: str = ""
    side_note: str = ""
    border: Colour = FRAME


def to_png(picture: Image.Image) -> bytes:
    """The image as the bytes of a PNG file."""
    file = io.BytesIO()
    picture.save(file, "PNG")
    return file.getvalue()


# Blocks


def grid(panels: Sequence[Panel], columns: int) -> Image.Image:
    """The panels row by row; each column is as wide, and each row as high, as its largest image."""
    rows = [panels[start : start + columns] for start in range(0, len(panels), columns)]
    widths = [2 + max(panel.picture.width for panel in panels[at::columns]) for at in range(len(rows[0]))]
    line = TEXT.size + 8 if any(panel.caption or panel.side_note for panel in panels) else 0
    heights = [line + 2 + max(panel.picture.height for panel in row) for row in rows]
    size = (sum(widths) + GAP * (len(widths) - 1), sum(heights) + GAP * (len(heights) - 1))
    block = Image.new("RGB", size, PAPER)
    draw = ImageDraw.Draw(block)
    y = 0
    for row, height in zip(rows, heights, strict=True):
        x = 0
        for panel, width in zip(row, widths, strict=False):
            if line:
                _write_caption(draw, panel, (x, y + TEXT.size), width)
            block.paste(panel.picture, (x + 1, y + line + 1))
            right, bottom = x + 1 + panel.picture.width, y + line + 1 + panel.picture.height
            draw.rectangle((x, y + line, right, bottom), outline=panel.border)
            x += width + GAP
        y += height + GAP
    return block


def _write_caption(draw: ImageDraw.ImageDraw, panel: Panel, place: tuple[int, int], width: int) -> None:
    x, y = place
    note = shortened(panel.side_note, width * 0.7, SMALL.size)
    taken = text_width(note, SMALL.size) + GAP if note else 0
    write(draw, place, shortened(panel.caption, width - taken, TEXT.size), anchor="ls")
    write(draw, (x + width, y), note, SMALL, anchor="rs")


def paragraph(text: str, width: int, style: Style = TEXT) -> Image.Image:
    """Text, wrapped at ``width`` pixels."""
    lines = wrapped(text, width, style.size)
    height = math.ceil(style.size * 1.35)
    block = Image.new("RGB", (width, height * len(lines)), PAPER)
    draw = ImageDraw.Draw(block)
    for number, line in enumerate(lines):
        write(draw, (0, number * height + style.size), line, style, anchor="ls")
    return block


def stack(blocks: Sequence[Image.Image], gap: int = GAP) -> Image.Image:
    """The blocks below each other, aligned left."""
    height = sum(block.height for block in blocks) + gap * (len(blocks) - 1)
    whole = Image.new("RGB", (max(block.width for block in blocks), height), PAPER)
    y = 0
    for block in blocks:
        whole.paste(block, (0, y))
        y += block.height + gap
    return whole


def sheet(
    title: str,
    blocks: Sequence[Image.Image],
    *,
    subtitle: str = "",
    remarks: Sequence[str] = (),
    notes: Sequence[str] = (),
) -> Image.Image:
    """The blocks below each other under a title, with a margin around all.

    ``remarks`` and ``notes`` are at the end; notes are coloured, since a reader must not miss them.
    """
    width = max(block.width for block in blocks)
    parts = [paragraph(shortened(title, width, TITLE.size), width, TITLE)]
    if subtitle:
        parts.append(paragraph(subtitle, width, FAINT))
    parts += blocks
    parts += [paragraph(remark, width, SMALL) for remark in remarks]
    parts += [paragraph(note, width, WARNING) for note in notes]
    body = stack(parts)
    whole = Image.new("RGB", (body.width + 2 * MARGIN, body.height + 2 * MARGIN), PAPER)
    whole.paste(body, (MARGIN, MARGIN))
    return whole


# Marks on an image


def write(
    draw: ImageDraw.ImageDraw, place: tuple[float, float], text: str, style: Style = TEXT, anchor: str = "la"
) -> None:
    """One line of text; ``anchor`` as in Pillow ("ls": left, on the baseline)."""
    draw.text(
        place,
        text,
        style.colour,
        font_for(text, style.size),
        anchor=anchor,
        stroke_width=style.halo,
        stroke_fill=WHITE,
    )


def draw_scale_bar(picture: Image.Image, metres_per_pixel: float) -> float:
    """A scale bar at the lower left, with its length beside it; returns the length in metres."""
    length = round_length(picture.width * _BAR_SHARE * metres_per_pixel)
    pixels = round(length / metres_per_pixel)
    draw = ImageDraw.Draw(picture)
    x, y = 10, picture.height - 14
    for rim, colour in ((1, WHITE), (0, INK)):
        draw.rectangle((x - rim, y - 1 - rim, x + pixels + rim, y + 1 + rim), fill=colour)
        for end in (x, x + pixels - 1):
            draw.rectangle((end - rim, y - 5 - rim, end + 1 + rim, y + 5 + rim), fill=colour)
    draw.rectangle((x, y - 1, x + pixels, y + 1), fill=INK)
    write(draw, (x + pixels + 8, y), format_length(length), ON_PICTURE, anchor="lm")
    return length


def draw_level(picture: Image.Image, y: float, name: str) -> None:
    """A thin dashed line at ``y`` pixels from the top, with its name at the left; nothing if that is outside."""
    if not 0 <= y < picture.height - 1:
        return
    draw = ImageDraw.Draw(picture)
    for x in range(0, picture.width, 8):
        draw.line((x, round(y), x + 3, round(y)), fill=INK)
    write(draw, (4, y - 2 if y > LABEL.size + 4 else y + LABEL.size), name, LABEL, anchor="ls")


def draw_axes(picture: Image.Image, axes: Sequence[tuple[str, float, float, float]]) -> None:
    """An axes gizmo at the lower right. ``axes``: letter (X, Y, Z) and unit vector (right, up, towards the viewer).

    An axis seen end on is a dot, with a cross if it points away.
    """
    draw = ImageDraw.Draw(picture)
    x, y = picture.width - _GIZMO_REACH - 18, picture.height - _GIZMO_REACH - 18
    for letter, right, up, towards in sorted(axes, key=lambda axis: axis[3]):
        colour = {"X": X_RED, "Y": Y_GREEN, "Z": Z_BLUE}[letter]
        style = Style(ON_PICTURE.size, colour, ON_PICTURE.halo)
        if math.hypot(right, up) < 0.1:
            _draw_end(draw, (x, y), colour, away=towards < 0)
            write(draw, (x - 9, y + 10), letter, style, anchor="mm")
            continue
        for width, shade in ((5, WHITE), (3, colour)):
            draw.line((x, y, x + right * _GIZMO_REACH, y - up * _GIZMO_REACH), fill=shade, width=width)
        beyond = _GIZMO_REACH + 9 / math.hypot(right, up)
        write(draw, (x + right * beyond, y - up * beyond), letter, style, anchor="mm")


def draw_labels(picture: Image.Image, labels: Sequence[tuple[str, float, float]]) -> list[str]:
    """Names, each as near to its place (pixels) as the earlier ones allow; returns those without room."""
    draw = ImageDraw.Draw(picture)
    taken: list[Rectangle] = []
    left: list[str] = []
    for text, x, y in labels:
        name = shortened(text, picture.width * 0.35, LABEL.size)
        half = text_width(name, LABEL.size) / 2 + 2
        at = min(max(x, half + 2), picture.width - half - 2)
        for aside in (0, 1, -1, 2, -2):
            middle = y + aside * LABEL.size * 1.25
            box = (at - half, middle - LABEL.size * 0.6, at + half, middle + LABEL.size * 0.6)
            inside = box[1] > 2 and box[3] < picture.height - 2
            if inside and not any(overlap(box, other) for other in taken):
                taken.append(box)
                write(draw, (at, middle), name, LABEL, anchor="mm")
                break
        else:
            left.append(text)
    return left


def overlap(first: Rectangle, second: Rectangle) -> bool:
    """Whether two rectangles overlap."""
    return first[0] < second[2] and second[0] < first[2] and first[1] < second[3] and second[1] < first[3]


def _draw_end(draw: ImageDraw.ImageDraw, centre: tuple[int, int], colour: Colour, *, away: bool) -> None:
    x, y = centre
    draw.ellipse((x - 5, y - 5, x + 5, y + 5), fill=WHITE, outline=colour, width=2)
    if away:
        draw.line((x - 3, y - 3, x + 3, y + 3), fill=colour, width=1)
        draw.line((x - 3, y + 3, x + 3, y - 3), fill=colour, width=1)
    else:
        draw.ellipse((x - 2, y - 2, x + 2, y + 2), fill=colour)
