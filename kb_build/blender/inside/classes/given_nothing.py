# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds functions of classes that give None for every index: what they look for is kept elsewhere, or no more."""

from contextlib import suppress

import bpy

from . import rna

TRIED = 8  # indices


def asks_by_index(function):
    """Whether a function is called on a class, with an index, and gives a struct."""
    given = [item for item in function.parameters if not item.is_output]
    results = [item for item in function.parameters if item.is_output]
    return (
        getattr(function, "use_self_type", False)
        and not (function.use_self or function.is_registered)
        and [item.type for item in given] == ["INT"]
        and [item.type for item in results] == ["POINTER"]
    )


def find_all(write, structs):
    """One ``gives_none`` record for each such function."""
    for identifier, struct in sorted(structs.items()):
        cls = getattr(bpy.types, identifier, None)
        for function in rna.own(struct, "functions") if cls is not None else ():
            if asks_by_index(function):
                with suppress(Exception):
                    ask = getattr(cls, function.identifier)
                    if all(ask(index) is None for index in range(TRIED)):
                        write("gives_none", path=f"bpy.types.{identifier}.{function.identifier}")
