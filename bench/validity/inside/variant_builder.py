# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes variants of the open scene, and pictures of them."""

from bench.audit.inside.serve import serve
from simworlds.sandbox.inside import service

# What is asked → the module and function that answer. Modules are named in full: they lie in several packages.
JOBS = {
    "open": ("audit.inside.opening", "open_file"),
    "save": ("validity.inside.saving", "save"),
    "sabotage": ("validity.mutations.inside.changes", "sabotage"),
    "guise": ("validity.invariance.inside.rewrites", "dress"),
    "twin": ("validity.counterfeits.inside.copying", "copy"),
    "bare": ("validity.counterfeits.inside.stripping", "show_bare"),
    "take": ("validity.inside.picture_series", "take"),
    "compare": ("validity.inside.picture_series", "compare"),
}


def main(arguments):
    """Serves the jobs on the socket whose descriptor is the first argument."""
    serve(int(arguments[0]), service.Tools("bench", JOBS))
