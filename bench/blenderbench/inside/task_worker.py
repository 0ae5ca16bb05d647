# SPDX-License-Identifier: GPL-3.0-or-later
"""The program that prepares and renders one scene of BlenderBench."""

from bench.audit.inside.serve import serve
from simworlds.sandbox.inside import service

# Job → the module and function that do it. Modules are named in full: they lie in two packages.
JOBS = {
    "open": ("audit.inside.opening", "open_file"),
    "prepare": ("blenderbench.inside.scene_setup", "prepare"),
    "execute": ("blenderbench.inside.task_code", "execute"),
    "choose_camera": ("blenderbench.inside.scene_setup", "choose_camera"),
    "save": ("blenderbench.inside.packed_copy", "save"),
    "render": ("blenderbench.inside.current_frame", "render"),
}


def main(arguments):
    """Serves the jobs on the socket whose descriptor is the first argument."""
    serve(int(arguments[0]), service.Tools("bench", JOBS))
