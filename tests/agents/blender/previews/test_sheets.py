"""Contact sheets: grids, captions, scale bars, words that fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from PIL import Image, ImageChops

from agents.blender.sheets import contact_sheet
from agents.blender.sheets.text_layout import format_length, round_length, shortened, text_width, wrapped

if TYPE_CHECKING:
    from collections.abc import Sequence

GREY = (200, 200, 200)


def plain(width: int = 100, height: int = 80, colour: contact_sheet.Colour = GREY) -> Image.Image:
    return Image.new("RGB", (width, height), colour)


def changed_box(before: Image.Image, after: Image.Image) -> tuple[int, int, int, int]:
    box = ImageChops.difference(before, after).getbbox()
    assert box is not None, "nothing was drawn"
    return box


def columns_of(picture: Image.Image, y: int, colour: contact_sheet.Colour) -> list[int]:
    return [x for x in range(picture.width) if picture.getpixel((x, y)) == colour]


def test_a_grid_keeps_every_picture_whole_and_apart() -> None:
    colours: Sequence[contact_sheet.Colour] = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]
    block = contact_sheet.grid(
        [contact_sheet.Panel(plain(60, 40, colour), "a") for colour in colours], columns=2
    )
    found = dict(map(reversed, block.getcolors(1 << 20) or []))  # type: ignore[arg-type]
    assert [found[colour] for colour in colours] == [60 * 40] * 3


def test_columns_are_as_wide_as_their_widest_picture() -> None:
    panels = [
        contact_sheet.Panel(plain(60)),
        contact_sheet.Panel(plain(30)),
        contact_sheet.Panel(plain(100)),
        contact_sheet.Panel(plain(30)),
    ]
    assert contact_sheet.grid(panels, columns=2).width == 102 + contact_sheet.GAP + 32


def test_captions_are_written_above_and_never_beyond_their_panel() -> None:
    name = "a caption that is far too long for its panel " * 5
    with_words = contact_sheet.grid([contact_sheet.Panel(plain(), name, "and a note beside it")], columns=1)
    without = contact_sheet.grid([contact_sheet.Panel(plain())], columns=1)
    assert with_words.width == without.width
    assert with_words.height > without.height


def test_a_sheet_grows_with_its_notes() -> None:
    low = contact_sheet.sheet("Title", [plain(300)])
    high = contact_sheet.sheet(
        "Title", [plain(300)], subtitle="frame 1", remarks=["seen"], notes=["a " * 200]
    )
    assert high.height > low.height + 60
    assert high.width == low.width


@pytest.mark.parametrize("metres", [1e-6, 0.0123, 1.0, 47.0, 3e5])
def test_a_scale_bar_is_as_long_as_it_says(metres: float) -> None:
    picture = plain(400, 300)
    scale = metres / 400
    length = contact_sheet.draw_scale_bar(picture, scale)
    inked = columns_of(picture, picture.height - 14, contact_sheet.INK)
    pixels = max(inked[at] for at in range(len(inked)) if inked[at] - inked[0] == at) - inked[0]
    assert pixels == pytest.approx(length / scale, abs=1)
    assert 0.1 < length / metres <= 0.3


def test_an_axis_points_where_it_should() -> None:
    before, right, up = plain(), plain(), plain()
    contact_sheet.draw_axes(right, [("X", 1, 0, 0)])
    contact_sheet.draw_axes(up, [("X", 0, 1, 0)])
    wide, high = changed_box(before, right), changed_box(before, up)
    assert wide[2] - wide[0] > 2 * (wide[3] - wide[1])
    assert high[3] - high[1] > 1.5 * (high[2] - high[0])


def test_a_level_is_drawn_where_it_is_and_not_outside() -> None:
    picture = plain()
    contact_sheet.draw_level(picture, 50, "z = 0")
    assert len(columns_of(picture, 50, contact_sheet.INK)) > 30
    untouched = plain()
    contact_sheet.draw_level(untouched, 90, "z = 0")
    contact_sheet.draw_level(untouched, -5, "z = 0")
    assert ImageChops.difference(untouched, plain()).getbbox() is None


def test_labels_do_not_cover_each_other() -> None:
    picture = plain(200, 200)
    left = contact_sheet.draw_labels(picture, [(f"Thing {at}", 100, 100) for at in range(9)])
    assert len(left) == 4
    assert contact_sheet.draw_labels(plain(200, 200), [("A", 20, 20), ("B", 150, 150), ("C", 900, 100)]) == []


@pytest.mark.parametrize(
    ("longest", "length"), [(0.99, 0.5), (1.0, 1.0), (4.9, 2.0), (7.0, 5.0), (10.0, 10.0), (3.4e-7, 2e-7)]
)
def test_a_round_length_is_the_largest_that_fits(longest: float, length: float) -> None:
    assert round_length(longest) == pytest.approx(length)


@pytest.mark.parametrize(
    ("metres", "said"),
    [(0, "0 m"), (0.2, "0.2 m"), (1.0, "1 m"), (100.0, "100 m"), (2.345, "2.35 m"), (0.01234, "0.0123 m")],
)
def test_formats_lengths_in_metres(metres: float, said: str) -> None:
    assert format_length(metres) == said


def test_a_name_that_is_too_long_keeps_its_ends() -> None:
    short = shortened("A_very_long_name_of_a_thing.001", 120, 15)
    assert text_width(short, 15) <= 120
    assert short.startswith("A_very")
    assert short.endswith("001")
    assert "…" in short


def test_lines_are_broken_at_words() -> None:
    text = "several words that have to be set on more than one line"
    lines = wrapped(text, 120, 13)
    assert " ".join(lines) == text
    assert max(text_width(line, 13) for line in lines) <= 120


@pytest.mark.parametrize("name", ["椅子", "Стул", "Stühl × é", "a\nb\tc\x00d", "🪑", ""])
def test_any_name_can_be_written(name: str) -> None:
    assert contact_sheet.sheet(name, [plain(200)], notes=[name]).width == 200 + 2 * contact_sheet.MARGIN


@pytest.mark.blender
def test_letters_of_other_scripts_are_drawn_and_not_boxes() -> None:
    assert text_width("椅子", 20) == pytest.approx(40, abs=4)
    one, two = (contact_sheet.paragraph(text, 60, contact_sheet.TITLE) for text in ("椅", "子"))
    assert ImageChops.difference(one, two).getbbox() is not None
