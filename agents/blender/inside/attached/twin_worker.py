# SPDX-License-Identifier: GPL-3.0-or-later
"""The worker of the sandboxed copy: it has one tool more, which rehearses code."""

from .. import worker
from . import code_guard

TOOLS = {"rehearse": ("attached.apply", "rehearse")}


def main(arguments):
    """Serves the tools on the socket whose descriptor is the first argument."""
    code_guard.install()  # during a call it would count as left behind
    worker.main(arguments, TOOLS)
