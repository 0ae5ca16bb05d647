# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules that RNA does not describe: their docstrings, and what calls of their functions tell."""
