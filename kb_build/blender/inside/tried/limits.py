# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds values that Blender keeps, or does not keep, otherwise than RNA tells.

Numbers outside their range whose setters do not ask for it; numbers that stop before its end, as the rest of the
instance has it; arrays that are not as long as RNA tells; items of enumerations that are taken as others, or leave what
there was; and texts
that are left out but where they name a part of the object, as a cloth's pin group is. Of one
instance of each class such values are assigned and read again. What a maker makes is tried in a process of its own:
what extreme values end there is left out.
"""

import bpy

from ..apart import sent_apart
from ..classes.rna import path_of
from ..instances.assigning import refused_value_items, same
from ..instances.layouts import CHOSEN
from ..instances.making import scratch_scene
from ..instances.new_things import MAKERS
from ..wire import limit
from .crashes import nodes

NUMBERS = frozenset({"INT", "FLOAT"})
MOST = 2e6  # beyond it a number may take all memory
PAST = 1  # how far beyond an end is tried
NEAR = 0.01  # … as a share of the end, and of one: what turns round at a limit of its own takes no more
FAR = 1000  # assigned where there is no end
# Numbers that are assigned by making another instance in its place: what is read of the first one then is anything.
MADE_ANEW = frozenset({("MovieTrackingMarker", "frame")})
NAME = "part"
TWO = 2
# Parts of an object that a text may name → the collection of them in an object, which some have not.
PARTS = {"vertex group": lambda obj: obj.vertex_groups, "UV map": lambda obj: obj.data.uv_layers}


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
        near = NEAR * step * max(abs(end), PAST) if prop.type == "FLOAT" else step
        if any(is_kept(struct, name, end + by, end) for by in (step, near)):
            found.append(side)
    read_back(struct, name, before)
    return found


def is_kept(struct, name, value, end):
    """Whether a value beyond an end of the range stays."""
    kept = read_back(struct, name, value)
    if isinstance(value, int):
        return kept == value
    return same(kept, value) and not same(kept, end)


def stop(struct, prop, side):
    """Where a number of an instance stops before one end of its range: two values far beyond are read as that, and so
    is the next one; or None.

    What Blender refuses altogether leaves the number as it was, which need not be next to what is refused.
    """
    name, before = prop.identifier, getattr(struct, prop.identifier)
    end, far = (prop.hard_min, -FAR) if side == "min" else (prop.hard_max, FAR)
    has_end = limit(end) is not None and abs(end) <= MOST
    last = end if has_end else far
    nearer = type(before)((last + before) / 2) if has_end else last / 2
    kept = read_back(struct, name, last)
    is_stop = kept is not None and not same(kept, last)
    is_stop = is_stop and same(kept, read_back(struct, name, type(before)(nearer)))
    beyond = -PAST if side == "min" else PAST
    is_stop = is_stop and kept is not None and same(kept, read_back(struct, name, kept + beyond))
    read_back(struct, name, before)
    return kept if is_stop else None


def stopping(struct, prop, side, kept):
    """The other number of an instance that decides where one stops: the stop goes as far as it does; "" for none."""
    for other in struct.bl_rna.properties:
        name = other.identifier
        is_alike = other.type == prop.type and not other.is_array and other != prop
        if not is_alike or getattr(other, "is_deprecated", False) or struct.is_property_readonly(name):
            continue
        before, own = getattr(struct, name), getattr(struct, prop.identifier)
        # Towards the number itself, so that it need not give way.
        moved = read_back(struct, name, before + (1 if side == "max" else -1) * PAST)
        goes = 0 if moved is None else moved - before
        again = stop(struct, prop, side) if goes else None
        read_back(struct, name, before)
        read_back(struct, prop.identifier, own)
        if again is not None and same(again - kept, goes) and keeps_apart(struct, prop, side, kept, name):
            return name
    return ""


def keeps_apart(struct, prop, side, kept, other):
    """Whether a stop is as far from another number as before, once the number that stops there has moved away from it.

    A strip's duration ends its left handle only as long as the strip begins at frame 1.
    """
    own, distance = getattr(struct, prop.identifier), kept - getattr(struct, other)
    moved = read_back(struct, prop.identifier, own + (-1 if side == "max" else 1) * PAST)
    again = None if moved is None or same(moved, own) else stop(struct, prop, side)
    apart = again is None or same(again - getattr(struct, other), distance)
    read_back(struct, prop.identifier, own)
    return apart


def stops(struct, prop):
    """side → where a number of an instance stops before the end of its range: the other number there that decides, or
    what it is.
    """
    kept = {side: stop(struct, prop, side) for side in ("min", "max")}
    return {
        side: stopping(struct, prop, side, value) or f"{value:g}"
        for side, value in kept.items()
        if value is not None
    }


def read_otherwise(struct, prop):
    """What is read once an item was assigned that an enumeration takes, where that is another one: ``read_as`` has item
    → the other one, whatever there was before; ``left_out`` those that leave what there was.
    """
    name, before = prop.identifier, getattr(struct, prop.identifier)
    kept = {item: read_back(struct, name, item) for item in refused_value_items(struct, name)}
    steady = [item for item in kept if kept[item] == item]
    read_as, left_out = {}, []
    for item, other in kept.items():
        if not other or other == item:
            continue
        seen = [(start, assigned_after(struct, name, start, item)) for start in starts(steady, other)]
        if seen and all(kept_now == start for start, kept_now in seen):
            left_out += [item] if len(seen) == TWO else []
        elif seen and seen[0][1] == other:
            read_as[item] = other
    read_back(struct, name, before)
    return {"read_as": read_as, "left_out": left_out}


def starts(steady, other):
    """Two items that are kept and differ from what was read: the first of them decides."""
    return [item for item in steady if item != other][:TWO]


def assigned_after(struct, name, start, item):
    """What is read of an enumeration that had one item, and was assigned another one."""
    read_back(struct, name, start)
    return read_back(struct, name, item)


def part_named(struct, name):
    """The part of its object that a text of an instance names, as it keeps the name of no other; "" for others."""
    obj = struct.id_data
    if not isinstance(obj, bpy.types.Object) or read_back(struct, name, NAME) == NAME:
        return ""
    for part, collection_of in PARTS.items():
        try:
            collection = collection_of(obj)
            added = collection.new(name=NAME)
        except Exception:
            continue  # objects of this type have no such parts
        is_kept = read_back(struct, name, NAME) == NAME
        collection.remove(added)
        if is_kept:
            return part
    return ""


def has_other_length(struct, prop):
    """Whether an array of an instance is not as long as RNA tells."""
    if prop.array_dimensions[1]:
        return False
    try:
        return len(getattr(struct, prop.identifier)) != prop.array_length
    except Exception:
        return False


def tried(struct, prop):
    """What is told of a property of an instance that can be assigned; {} for nothing."""
    if prop.type == "ENUM":
        found = {} if prop.is_enum_flag else read_otherwise(struct, prop)
    elif prop.type == "STRING":
        found = {"names": part_named(struct, prop.identifier)}
    else:
        found = {"ends": kept_beyond(struct, prop)}
        if prop.identifier not in CHOSEN and (struct.bl_rna.identifier, prop.identifier) not in MADE_ANEW:
            found["stops"] = stops(struct, prop)
    return {name: told for name, told in found.items() if told}


def look(observer, struct, seen, send):
    """Tries the properties of an instance, those of each class once."""
    writable, before = observer.layout(struct).writable, observer.read(struct)
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if prop.type in NUMBERS and prop.is_array:
            path = path_of(struct.bl_rna, name)
            if path not in seen and has_other_length(struct, prop):
                seen.add(path)
                send({"path": path, "varies": True})
        elif (
            name in writable
            and prop.type in {"ENUM", "STRING", *NUMBERS}
            and not struct.is_property_readonly(name)
        ):
            path = writable[name]
            if path not in seen:
                seen.add(path)
                if found := tried(struct, prop):
                    send({"path": path, **found})
                    observer.restored(struct, before)  # some setters change other properties


def found_apart(make, observer):
    """What is found in what one maker makes, up to where Blender ends."""

    def work(send):
        scratch_scene()
        seen = set()
        for _, thing, *_ in make():
            for struct in observer.parts(thing) if thing is not None else ():
                look(observer, struct, seen, send)

    return sent_apart(work)[1]


def find_all(write, observer):
    """One ``limits`` record for each property of which Blender keeps something else than RNA tells.

    Wants a system that can work apart.
    """
    found = {}
    for make in (*MAKERS, nodes):
        for row in found_apart(make, observer):
            found.setdefault(row["path"], row)
    for _, row in sorted(found.items()):
        write("limits", **row)
