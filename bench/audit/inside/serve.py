# SPDX-License-Identifier: GPL-3.0-or-later
"""Serves the audit's jobs on one untrusted .blend. No script of the file runs."""

from simworlds.sandbox.inside import mantaflow, service
from simworlds.sandbox.inside.refusal import Refused

from . import LARGEST_REPLY

REPORTING = {"frames"}  # jobs that tell how far they are
# Job → the module and function that do it; they get the arguments of the call.
JOBS = {
    "open": ("opening", "open_file"),
    "facts": ("facts", "read_facts"),
    "measure": ("measure", "measure"),
    "frames": ("frames", "render"),
}


def main(arguments):
    """Serves the audit on the socket whose descriptor is the first argument."""
    serve(int(arguments[0]), service.Tools(__package__, JOBS))


def serve(descriptor, jobs):
    """Answers ``jobs`` until the other end is closed."""

    def answer(job, arguments, report):
        told = {"report": report} if job in REPORTING else {}
        try:
            return jobs.find(job)(**arguments, **told)
        except MemoryError:
            raise Refused("it needs more memory than its limit") from None

    mantaflow.mend()
    service.serve(descriptor, answer, largest=LARGEST_REPLY)
