# SPDX-License-Identifier: GPL-3.0-or-later
"""The custom property of a scene that tells what its bakes were made from."""

BAKE_INPUTS = "simworlds_bakes"
