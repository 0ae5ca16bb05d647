"""PL, by hand and by another formula; pictures that cannot be compared."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image

from bench.blenderbench.errors import UnreadableRender
from bench.blenderbench.photometric import photometric_loss
from bench.blenderbench.pictures import read_picture

if TYPE_CHECKING:
    from pathlib import Path


def plain(size: tuple[int, int], colour: tuple[int, int, int]) -> Image.Image:
    return Image.new("RGB", size, colour)


def noise(size: tuple[int, int], seed: int) -> Image.Image:
    values = np.random.default_rng(seed).integers(0, 256, (size[1], size[0], 3), dtype=np.uint8)
    return Image.fromarray(values)


def by_fractions(first: Image.Image, second: Image.Image) -> float:
    """The same by exact arithmetic, channel by channel."""
    pairs = zip(first.tobytes(), second.tobytes(), strict=True)
    total = sum((Fraction(a - b, 255) ** 2 for a, b in pairs), Fraction())
    return float(total / len(first.tobytes()))


@pytest.mark.parametrize(
    ("first", "second", "by_hand"),
    [
        ((0, 0, 0), (0, 0, 0), 0.0),
        ((0, 0, 0), (255, 255, 255), 100.0),
        ((255, 0, 0), (0, 0, 0), 100 / 3),  # one channel of three is wholly off
        ((51, 51, 51), (0, 0, 0), 4.0),  # 0.2² × 100
        ((0, 102, 204), (0, 0, 0), (0.16 + 0.64) / 3 * 100),
    ],
)
def test_plain_pictures_match_distances_by_hand(
    first: tuple[int, int, int], second: tuple[int, int, int], by_hand: float
) -> None:
    assert photometric_loss(plain((2, 2), first), plain((2, 2), second)) == pytest.approx(by_hand, abs=1e-5)


def test_one_pixel_of_four_counts_a_quarter() -> None:
    render = plain((2, 2), (0, 0, 0))
    render.putpixel((1, 0), (255, 255, 255))
    assert photometric_loss(render, plain((2, 2), (0, 0, 0))) == pytest.approx(25.0)


def test_it_agrees_with_exact_arithmetic() -> None:
    first, second = noise((37, 23), 1), noise((37, 23), 2)
    assert photometric_loss(first, second) == pytest.approx(100 * by_fractions(first, second), rel=1e-6)
    assert photometric_loss(first, second, "peer") == pytest.approx(by_fractions(first, second), rel=1e-6)


def test_the_paper_uses_the_goals_size_and_the_peer_the_renders() -> None:
    render, goal = noise((40, 30), 3), noise((24, 16), 4)
    at_goal = by_fractions(render.resize((24, 16), Image.Resampling.BICUBIC), goal)
    at_render = by_fractions(render, goal.resize((40, 30), Image.Resampling.BICUBIC))
    assert at_goal != pytest.approx(at_render, rel=0.1)
    assert photometric_loss(render, goal) == pytest.approx(100 * at_goal, rel=1e-6)
    assert photometric_loss(render, goal, "peer") == pytest.approx(at_render, rel=1e-6)


def test_sizes_do_not_matter_to_plain_colours() -> None:
    assert photometric_loss(plain((64, 64), (51, 0, 0)), plain((17, 31), (0, 0, 0))) == pytest.approx(4 / 3)


def test_drops_transparency_and_resolves_palettes(tmp_path: Path) -> None:
    Image.new("RGBA", (4, 4), (200, 100, 50, 0)).save(tmp_path / "clear.png")
    indexed = Image.new("P", (4, 4), 1)
    indexed.putpalette([0, 0, 0, 200, 100, 50])
    indexed.save(tmp_path / "indexed.png", transparency=b"\x00\x10")
    Image.new("L", (4, 4), 77).save(tmp_path / "grey.png")
    assert read_picture(tmp_path / "clear.png").getpixel((0, 0)) == (200, 100, 50)
    assert read_picture(tmp_path / "indexed.png").getpixel((0, 0)) == (200, 100, 50)
    assert read_picture(tmp_path / "grey.png").getpixel((0, 0)) == (77, 77, 77)


def test_names_a_truncated_picture(tmp_path: Path) -> None:
    noise((64, 64), 5).save(tmp_path / "whole.png")
    (tmp_path / "torn.png").write_bytes((tmp_path / "whole.png").read_bytes()[:3000])
    with pytest.raises(UnreadableRender, match=r"torn\.png cannot be read as a picture"):
        read_picture(tmp_path / "torn.png")


@pytest.mark.parametrize("name", ["none.png", "folder.png"])
def test_rejects_what_is_not_a_file(name: str, tmp_path: Path) -> None:
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(UnreadableRender, match=name.replace(".", r"\.")):
        read_picture(tmp_path / name)


def test_rejects_a_renamed_jpeg_and_deep_grey(tmp_path: Path) -> None:
    noise((8, 8), 6).save(tmp_path / "photo.png", format="JPEG")
    with pytest.raises(UnreadableRender, match="is not a PNG"):
        read_picture(tmp_path / "photo.png")
    Image.fromarray(np.full((8, 8), 40_000, dtype=np.uint16)).save(tmp_path / "deep.png")
    with pytest.raises(UnreadableRender, match="grey with more than 8 bits"):
        read_picture(tmp_path / "deep.png")
