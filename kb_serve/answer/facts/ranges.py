"""Numbers and their ranges as answers and findings write them."""

from __future__ import annotations


def number_text(value: float, kind: str) -> str:
    """A number of some type, as symbols have it: integers are written whole, floats with the digits that Blender's
    have.
    """
    return f"{value:.0f}" if kind.startswith("int") else f"{value:.7g}"


def range_text(low: float | None, high: float | None, kind: str) -> str:
    """The range of numbers of some type; None is an end that is open."""
    left = "−∞" if low is None else number_text(low, kind)
    right = "∞" if high is None else number_text(high, kind)
    return f"{left} … {right}"
