# SPDX-License-Identifier: GPL-3.0-or-later
"""Rings and arches, and points on a circle."""

import math

from .props import revolved


def around(radius, count):
    """``count`` points (x, y) evenly spaced on a circle, from +X on."""
    turns = (2 * math.pi * number / count for number in range(count))
    return [(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]


def arch(wide, high, parts=10):
    """Half an ellipse as an outline (x, z) for ``props.prism``, from +X to -X: ``wide`` at its foot, ``high``."""
    turns = (math.pi * part / parts for part in range(parts + 1))
    return [(wide / 2 * math.cos(turn), high * math.sin(turn)) for turn in turns]


def ring(name, radius, thick, at=(0, 0, 0), *, parts=10, sides=32, **look):
    """A ring that lies flat around ``at``: ``radius`` to the middle of its tube, whose own radius is ``thick``."""
    tube = [(radius + out, up) for out, up in around(thick, parts)]
    return revolved(name, [*tube, tube[0]], at, sides=sides, **look)
