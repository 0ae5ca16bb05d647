# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds functions and classes of ``gpu`` that want a window: here is none, and each is called."""

import types

import bpy

from ..apart import sent_apart
from .modules import load

MODULE = "gpu"
MOST_ARGUMENTS = 2  # what wants one says so before it looks at what is given
MOST_ENDINGS = 8


def functions():
    """Path → function or class, of the module's own modules."""
    found = {}
    package = load(MODULE)
    for name in dir(package):
        module = getattr(package, name, None)
        if isinstance(module, types.ModuleType):
            for member in dir(module):
                value = getattr(module, member)
                if not member.startswith("_") and callable(value):
                    found[f"{MODULE}.{name}.{member}"] = value
    return found


def wish(function):
    """What Blender says of a call without a window; empty where it says nothing of the kind."""
    for count in range(MOST_ARGUMENTS + 1):
        try:
            function(*(None,) * count)
        except SystemError as error:
            return str(error)
        except Exception:
            continue
    return ""


def find_all(write):
    """One ``windowless`` record for each. Wants a system that can work apart."""
    left = functions() if bpy.app.background else {}

    def work(send):
        for path, function in left.items():
            send([path, ""])
            send([path, wish(function)])

    for _ in range(MOST_ENDINGS):
        ended, rows = sent_apart(work)
        for path, said in rows:
            left.pop(path, None)
            if said:
                write("windowless", path=path, said=said)
        if ended:
            break
