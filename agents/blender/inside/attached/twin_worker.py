# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker of the sandboxed copy: it also rehearses code, and opens a part of a scene."""

from .. import worker
from .code import code_guard

TOOLS = {"rehearse": ("attached.code.apply", "rehearse"), "load_part": ("attached.files.parts", "load_part")}


def main(arguments):
    """Serves the tools on the socket whose descriptor is the first argument."""
    code_guard.install()  # during a call it would count as left behind
    worker.main(arguments, TOOLS)
