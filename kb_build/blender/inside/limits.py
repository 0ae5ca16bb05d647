# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds numbers that may lie outside the range that RNA tells of them: their setters do not ask for it.

Of one instance of each class the ends of the range and what lies beyond are assigned and read again. What a maker
makes is tried in a process of its own: what extreme values end there is left out.
"""

import json
import tempfile

from .apart import apart
from .new_things import MAKERS, scratch_scene
from .wire import limit

MOST = 1e6  # beyond it a number may take all memory
PAST = 1  # how far beyond an end is tried


def read_back(struct, name, value):
    """What a property has after a value was assigned; None where it cannot be."""
    try:
        setattr(struct, name, value)
        return getattr(struct, name)
    except Exception:
        return None


def is_near(left, right):
    """Whether two numbers are equal as far as single precision goes."""
    return left is not None and abs(left - right) <= 1e-5 * max(1.0, abs(right))


def kept_beyond(struct, prop):
    """The ends of a number's range beyond which a value stays: ``min``, ``max``."""
    name, before = prop.identifier, getattr(struct, prop.identifier)
    found = []
    for side, end, beyond in (("min", prop.hard_min, -PAST), ("max", prop.hard_max, PAST)):
        if (
            limit(end) is not None
            and abs(end) <= MOST
            and is_near(read_back(struct, name, end + beyond), end + beyond)
        ):
            found.append(side)
    read_back(struct, name, before)
    return found


def look(struct, writable, seen, send):
    """Tries the numbers of an instance, those of each class once."""
    for prop in struct.bl_rna.properties:
        path = writable.get(prop.identifier)
        is_number = prop.type in {"INT", "FLOAT"} and not prop.is_array
        if path is None or path in seen or not is_number or struct.is_property_readonly(prop.identifier):
            continue
        seen.add(path)
        if ends := kept_beyond(struct, prop):
            send({"path": path, "ends": ends})


def found_apart(make, observer):
    """What is found in what one maker makes, up to where Blender ends."""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as file:

        def send(row):
            file.write(json.dumps(row) + "\n")
            file.flush()

        def work():
            scratch_scene()
            seen = set()
            for _, thing, *_ in make():
                for struct in observer.parts(thing) if thing is not None else ():
                    look(struct, observer.layout(struct).writable, seen, send)
            return True

        apart(work)
        file.seek(0)
        return [json.loads(line) for line in file]


def find_all(write, observer):
    """One ``limits`` record for each number whose range is not kept. Wants a system that can work apart."""
    found = {}
    for make in MAKERS:
        for row in found_apart(make, observer):
            found.setdefault(row["path"], row["ends"])
    for path, ends in sorted(found.items()):
        write("limits", path=path, ends=ends)
