# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers the supervisor instead of the worker: what it is told to answer, or else what an honest worker might."""

import json
import traceback

from simworlds.sandbox.inside import service

from . import honest

LIES = ".lies.json"  # in the current folder: {"source": code that comes first, "lies": {tool: code}}


def main(arguments):
    """Serves on the socket whose descriptor is the first argument."""
    service.serve(int(arguments[0]), answer)


def answer(tool, arguments, report):
    """The lie for a tool; the truth if there is none."""
    told = _told()
    source = told.get("lies", {}).get(tool)
    if source is None:
        return _truth(tool, arguments)
    names = {"truth": lambda: _truth(tool, arguments), "changed": honest.changed, "png": honest.png}
    names["chunk"] = honest.chunk
    exec(told["source"], names)
    body = "\n".join("    " + line for line in source.splitlines())
    try:
        exec("def lie(arguments, report):\n" + body, names)
        return names["lie"](arguments, report)
    except Exception:
        raise RuntimeError(f"THE LIE FAILED: {traceback.format_exc()[-2000:]}") from None


def _truth(tool, arguments):
    return getattr(honest, f"on_{tool}")(arguments)


def _told():
    try:
        with open(LIES) as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}
