"""Text on images: fonts, and lines that fit a width."""

from __future__ import annotations

import importlib.util
import math
import unicodedata
from functools import cache
from pathlib import Path

from PIL import ImageFont

_LATIN, _WIDE = "Inter.woff2", "Noto Sans CJK Regular.woff2"
_SYSTEM = ("DejaVuSans.ttf", "LiberationSans-Regular.ttf", "Arial.ttf", "Arial Unicode.ttf")
_FIRST_WIDE = 0x2E80  # first character of East Asian scripts


def text_width(text: str, size: int) -> float:
    """The width of a line of text in pixels."""
    return font_for(text, size).getlength(text)


def one_line(text: str) -> str:
    """The text without line breaks and control characters."""
    words = "".join(" " if unicodedata.category(letter)[0] == "C" else letter for letter in text).split()
    return " ".join(words)


def shortened(text: str, width: float, size: int) -> str:
    """``text`` on one line, with its middle left out if it is wider than ``width`` pixels."""
    text = one_line(text)[:2000]
    if text_width(text, size) <= width:
        return text
    kept = len(text)
    while kept > 2:
        kept = min(kept - 1, int(kept * 0.95))
        head = kept * 2 // 3
        short = f"{text[:head].rstrip()}…{text[len(text) - (kept - head) :].lstrip()}"
        if text_width(short, size) <= width:
            return short
    return "…"


def wrapped(text: str, width: float, size: int) -> list[str]:
    """``text`` as lines of at most ``width`` pixels; words that are too long are shortened."""
    lines: list[str] = []
    for piece in text.splitlines() or [""]:
        line = ""
        for word in one_line(piece).split():
            longer = f"{line} {word}" if line else word
            if text_width(longer, size) <= width:
                line = longer
                continue
            if line:
                lines.append(line)
            line = shortened(word, width, size)
        lines.append(line)
    return lines


def round_length(longest: float) -> float:
    """The largest of …, 0.5, 1, 2, 5, 10, 20, … that is at most ``longest``."""
    step = 10.0 ** math.floor(math.log10(longest))
    return max((factor * step for factor in (1, 2, 5) if factor * step <= longest * (1 + 1e-9)), default=step)


def format_length(metres: float) -> str:
    """A length, always in metres so that lengths can be compared, with four digits at most."""
    if metres == 0 or 1e-4 <= abs(metres) < 1e4:
        digits = max(0, 2 - math.floor(math.log10(abs(metres)))) if metres else 0
        number = f"{metres:.{digits}f}"
        return f"{number.rstrip('0').rstrip('.') if '.' in number else number} m"
    return f"{metres:.3g} m"


def font_for(text: str, size: int) -> ImageFont.FreeTypeFont:
    """A font that has the characters of ``text``, if there is one."""
    wide = any(ord(letter) >= _FIRST_WIDE for letter in text)
    return _font(_WIDE if wide else _LATIN, size)


@cache
def _font(name: str, size: int) -> ImageFont.FreeTypeFont:
    # bpy is only located: it must not run in this process.
    spec = importlib.util.find_spec("bpy")
    inside = Path(spec.origin).parent.glob(f"*/datafiles/fonts/{name}") if spec and spec.origin else ()
    for choice in (*map(str, inside), *_SYSTEM):
        try:
            return ImageFont.truetype(choice, size)
        except OSError:
            continue
    font = ImageFont.load_default(size)
    assert isinstance(font, ImageFont.FreeTypeFont)
    return font
