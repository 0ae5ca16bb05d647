# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers the supervisor instead of the worker: what it is told to answer, or else what a Blender might."""

import json
import os
import sys

from simworlds.sandbox.inside import service

LIES = ".lies.json"  # in the current folder: {"source": code that comes first, "lies": {tool: code}, "truth": {tool: value}}


def main(arguments):
    """Serves on the socket whose descriptor is the first argument."""
    service.serve(int(arguments[0]), answer)


def answer(tool, arguments, report):
    """The lie for a tool; the truth if there is none."""
    told = _told()
    source = told.get("lies", {}).get(tool)
    if source is None:
        return truth(tool, arguments, told)
    namespace = {"truth": lambda: truth(tool, arguments, told)}
    exec(told.get("source", ""), namespace)
    body = "\n".join("    " + line for line in source.splitlines())
    exec("def lie(arguments, report):\n" + body, namespace)
    return namespace["lie"](arguments, report)


def truth(tool, arguments, told):
    """What an honest worker with an empty scene would do."""
    if tool == "write":
        with open(arguments["path"], "wb") as file:
            file.write(b"BLENDER-v501RENDH")
        return {"seconds": 0.001, "bytes": 17}
    if tool == "open":
        return {"objects": 0}
    return told.get("truth", {}).get(tool)


def _told():
    try:
        with open(LIES) as file:
            return json.load(file)
    except (OSError, ValueError):
        return {}
