# SPDX-License-Identifier: GPL-3.0-or-later
"""Assigns values to instances, and tells what they take from what they refuse."""

import functools
import re


def refused_items(refusal):
    """The items that Blender names where it refuses a value."""
    return quoted(str(refusal).partition("not found in")[2])


@functools.cache
def quoted(text):
    """What stands in quotes in a text: Blender often names the same items."""
    return tuple(re.findall(r"'([^']*)'", text))


def refused_value_items(owner, name, flag=False):
    """An enum's items as Blender names them when it refuses a value that cannot be one of them."""
    try:
        setattr(owner, name, {"\x01"} if flag else "\x01")
    except (TypeError, ValueError) as refusal:
        return refused_items(refusal)
    except (AttributeError, RuntimeError):
        pass
    return ()


def put(struct, name, value):
    """Gives a setting a value. Returns whether it has it now."""
    try:
        setattr(struct, name, value)
        return getattr(struct, name) == value
    except Exception:
        return False


def same(left, right):
    """Whether two values are equal, floats as far as single precision goes."""
    if isinstance(left, list) and isinstance(right, list):
        return len(left) == len(right) and all(same(*pair) for pair in zip(left, right, strict=True))
    if isinstance(left, (int, float)) and isinstance(right, (int, float)):
        return left == right or abs(left - right) <= 2e-6 * max(abs(left), abs(right))
    return left == right
