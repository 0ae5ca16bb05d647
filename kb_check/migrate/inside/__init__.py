# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in Blender: a script, and then what it left in the scene."""
