# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds numbers that may lie outside the range that RNA tells of them: their setters do not ask for it. And arrays
that are not as long as RNA tells: their length is the instance's.

Of one instance of each class the ends of the range and what lies beyond are assigned and read again. What a maker
makes is tried in a process of its own: what extreme values end there is left out.
"""

from .apart import sent_apart
from .instances import same
from .new_things import MAKERS, scratch_scene
from .rna import path_of
from .wire import limit

NUMBERS = frozenset({"INT", "FLOAT"})
MOST = 1e6  # beyond it a number may take all memory
PAST = 1  # how far beyond an end is tried


def read_back(struct, name, value):
    """What a property has after a value was assigned; None where it cannot be."""
    try:
        setattr(struct, name, value)
        return getattr(struct, name)
    except Exception:
        return None


def kept_beyond(struct, prop):
    """The ends of a number's range beyond which a value stays: ``min``, ``max``."""
    name, before = prop.identifier, getattr(struct, prop.identifier)
    found = []
    for side, end, step in (("min", prop.hard_min, -PAST), ("max", prop.hard_max, PAST)):
        if limit(end) is None or abs(end) > MOST:
            continue
        kept = read_back(struct, name, end + step)
        if same(kept, end + step) and not same(kept, end):
            found.append(side)
    read_back(struct, name, before)
    return found


def has_other_length(struct, prop):
    """Whether an array of an instance is not as long as RNA tells."""
    if prop.array_dimensions[1]:
        return False
    try:
        return len(getattr(struct, prop.identifier)) != prop.array_length
    except Exception:
        return False


def look(struct, writable, seen, send):
    """Tries the numbers of an instance, those of each class once."""
    for prop in struct.bl_rna.properties:
        if prop.type in NUMBERS and prop.is_array:
            path = path_of(struct.bl_rna, prop.identifier)
            if path not in seen and has_other_length(struct, prop):
                seen.add(path)
                send({"path": path, "ends": [], "varies": True})
            continue
        path = writable.get(prop.identifier)
        if (
            path is None
            or path in seen
            or prop.type not in NUMBERS
            or struct.is_property_readonly(prop.identifier)
        ):
            continue
        seen.add(path)
        if ends := kept_beyond(struct, prop):
            send({"path": path, "ends": ends})


def found_apart(make, observer):
    """What is found in what one maker makes, up to where Blender ends."""

    def work(send):
        scratch_scene()
        seen = set()
        for _, thing, *_ in make():
            for struct in observer.parts(thing) if thing is not None else ():
                look(struct, observer.layout(struct).writable, seen, send)

    return sent_apart(work)[1]


def find_all(write, observer):
    """One ``limits`` record for each number whose range is not kept, and each array of another length.

    Wants a system that can work apart.
    """
    found = {}
    for make in MAKERS:
        for row in found_apart(make, observer):
            found.setdefault(row["path"], row)
    for _, row in sorted(found.items()):
        write("limits", **row)
