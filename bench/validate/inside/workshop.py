# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes variants of a scene: ``workshop.py -- DESCRIPTOR``, spoken to as the audit's own Blender is."""

import os
import sys

_BENCH = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
for folder in ("twins", "guises", "sabotage", "validate", ""):
    sys.path.insert(0, os.path.join(_BENCH, folder, "inside"))

import entry  # noqa: E402 - it lies in a folder that was just named

JOBS = {
    "open": ("opening", "open_file"),
    "save": ("saving", "save"),
    "sabotage": ("changes", "sabotage"),
    "guise": ("dressing", "dress"),
    "twin": ("copying", "copy"),
    "bare": ("stripping", "show_bare"),
    "take": ("pictures", "take"),
    "compare": ("pictures", "compare"),
}

if __name__ == "__main__":
    entry.serve(int(sys.argv[-1]), JOBS)
