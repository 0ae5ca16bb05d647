# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes in the user's open file: their settings and folders stay, and fluids come baked from the copy."""

from ..physics import bake


def bake_in_steps(arguments, report):
    """As ``bake.bake_in_steps``; all fluids must be in ``brought``."""
    return bake.bake_in_steps({**arguments, "folder": None}, report)


def free(arguments, report):
    """As ``bake.free``."""
    return bake.free({**arguments, "in_place": True}, report)
