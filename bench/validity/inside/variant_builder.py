# SPDX-License-Identifier: GPL-3.0-or-later
"""The program that makes variants of the open scene, and renders them."""

from bench.audit.inside.serve import serve
from simworlds.sandbox.inside import service

# Job → the module and function that do it. Modules are named in full: they lie in several packages.
JOBS = {
    "open": ("audit.inside.opening", "open_file"),
    "save": ("validity.inside.saving", "save"),
    "mutate": ("validity.mutations.inside.changes", "mutate"),
    "rewrite": ("validity.invariance.inside.rewrites", "rewrite"),
    "counterfeit": ("validity.counterfeits.inside.counterfeit", "make_counterfeit"),
    "remove_physics": ("validity.counterfeits.inside.physics_removal", "remove_visibly"),
    "render": ("validity.inside.picture_series", "render"),
    "compare": ("validity.inside.picture_series", "compare"),
}


def main(arguments):
    """Serves the jobs on the socket whose descriptor is the first argument."""
    serve(int(arguments[0]), service.Tools("bench", JOBS))
