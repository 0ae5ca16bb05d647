# SPDX-License-Identifier: GPL-3.0-or-later
"""Converts Blender's values for JSON: the same value gives the same text, on every run."""

import math

_LARGEST = 1e30


def text(value):
    """A name as valid Unicode."""
    return str(value).encode("utf-8", "backslashreplace").decode("utf-8")


def called(block):
    """The name of a data-block, with its library's if it is linked; None if there is no data-block."""
    if block is None:
        return None
    return text(block.name_full if block.library is not None else block.name)


def number(value):
    """A value rounded to six significant digits, the precision of Blender's floats; 0 if it is not finite or huge."""
    value = float(value)
    if not math.isfinite(value) or abs(value) > _LARGEST:
        return 0.0
    return float(f"{value:.6g}") + 0.0


def vector(values, scale=1.0):
    """Numbers, each times ``scale``, to 0.01 mm (playback may differ in the last bits); 0 for those not finite."""
    found = []
    for each in values:
        value = float(each) * scale
        found.append(round(value, 5) + 0.0 if math.isfinite(value) and abs(value) < _LARGEST else 0.0)
    return found
