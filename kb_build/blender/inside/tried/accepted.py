# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds which things of its class a pointer does not take, although RNA tells nothing of it.

Blender leaves most of them without a word: a boolean modifier's object stays None when it is given an empty. To the
pointers of one instance of each class an object of each type is assigned, a tree of each kind, and what the instance
itself belongs to; what is read back decides. All that a maker makes is tried in one process of its own; where that is
ended by an attempt, another one goes on behind it.
"""

import itertools
from functools import partial

import bpy

from ..apart import crashes, sent_apart
from ..classes.rna import path_of
from ..instances.making import choices, object_of, scratch_scene
from ..instances.new_things import MAKERS
from ..nodes import TREES
from .crashes import nodes

ITSELF = "itself"
# Of several instances the first of these counts.
CRASHES, TAKEN, REFUSED, LEFT, NOT_KNOWN = OUTCOMES = ("crashes", "takes", "refuses", "leaves", "")


def things():
    """class → {kind: a thing of that class and kind}."""
    objects = {kind: object_of(kind) for kind in choices("Object", "type")}
    trees = {kind: bpy.data.node_groups.new("new", kind) for kind in TREES}
    return {"Object": {kind: obj for kind, obj in objects.items() if obj is not None}, "NodeTree": trees}


def outcome(struct, name, thing):
    """What becomes of a thing that is assigned to a pointer."""
    try:
        setattr(struct, name, thing)
    except Exception:
        return REFUSED
    return TAKEN if getattr(struct, name) == thing else LEFT


def attempts(make, observer):
    """(path, kind, what tries it) for each pointer of what one maker makes, and each thing that it may take."""
    scratch_scene()
    given = things()
    for _, made, *_ in make():
        for struct in observer.parts(made) if made is not None else ():
            for prop in struct.bl_rna.properties:
                if prop.type != "POINTER" or prop.is_readonly or prop.fixed_type.identifier not in given:
                    continue
                path, kinds = path_of(struct.bl_rna, prop.identifier), given[prop.fixed_type.identifier]
                for kind, thing in kinds.items():
                    yield path, kind, partial(outcome, struct, prop.identifier, thing)
                if isinstance(struct.id_data, getattr(bpy.types, prop.fixed_type.identifier)):
                    yield path, ITSELF, partial(outcome, struct, prop.identifier, struct.id_data)


def try_from(make, observer, first, send):
    """Sends [path, kind, outcome] of each attempt with what one maker makes, from one on; what it is of before that."""
    for path, kind, attempt in itertools.islice(attempts(make, observer), first, None):
        send([path, kind, ""])
        send([path, kind, attempt()])


def try_one(make, observer, number):
    """Does one attempt."""
    next(itertools.islice(attempts(make, observer), number, None))[2]()


def found_apart(make, observer):
    """[path, kind, outcome] of each attempt with what one maker makes, in processes of their own."""
    found, is_done = [], False
    while not is_done:
        is_done, rows = sent_apart(partial(try_from, make, observer, len(found)))
        found += rows[1::2]
        if len(rows) % 2:  # a process may end for other reasons than this attempt
            is_fatal = crashes(partial(try_one, make, observer, len(found)))
            found.append([*rows[-1][:2], CRASHES if is_fatal else NOT_KNOWN])
        else:
            is_done = True
    return found


def find_all(write, observer):
    """One ``accepted`` record for each pointer that takes some things of its class and no others: outcome → kinds.

    What one instance takes, or refuses with an error, counts: a bone's constraint takes its own armature as the target.
    Wants a system that can work apart.
    """
    found = {}
    for make in (*MAKERS, nodes):
        for path, kind, result in found_apart(make, observer):
            known = found.setdefault(path, {})
            known[kind] = min(known.get(kind, result), result, key=OUTCOMES.index)
    for path, kinds in sorted(found.items()):
        row = {each: [kind for kind, result in kinds.items() if result == each] for each in OUTCOMES[:-1]}
        # What leaves all of them wants something else of them.
        if {*row[CRASHES], *row[TAKEN]} - {ITSELF} and len(row[TAKEN]) < len(kinds):
            write("accepted", path=path, **row)
