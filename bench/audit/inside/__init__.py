# SPDX-License-Identifier: GPL-3.0-or-later
"""The audit's side in Blender."""

LARGEST_REPLY = 256 << 20  # bytes: the facts of a large scene, or frames of it
