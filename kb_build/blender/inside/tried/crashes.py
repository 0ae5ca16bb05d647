# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what crashes Blender of what a script may well write: None where a thing is wanted, a call without arguments.

Of new things, of what belongs to them and of their collections, each pointer is assigned None, and each function is
called with None for the things that it wants and the plainest other arguments, in processes of their own. What crashes
one is tried in other ways: with things for None, with arguments that may be left out, with a scene for the sequencer.
"""

import itertools
from contextlib import suppress
from functools import partial

import bpy

from ..apart import MOMENT, apart, crashes, is_crash, sent_apart, sent_with_status
from ..classes import rna
from ..instances.making import (
    SEQUENCER_SCENE,
    called,
    has_sequencer_scene,
    no_sequencer_scene,
    scratch_scene,
)
from ..instances.new_things import BY_FUNCTIONS, animation, constraints, strips
from ..nodes import TREES
from ..nodes import make as make_in
from .refusals import LEAVING_GAPS, objects, plain_argument

# Each setting and each function is tried on so many things.
MOST_THINGS = 3
MOST_FURTHER = 2  # arguments that may be left out
DEPTH = 4  # of elements in elements
PATHS = frozenset({"FILE_PATH", "DIR_PATH", "FILE_NAME"})
NUMBERS = frozenset({"BOOLEAN", "INT", "FLOAT"})
# The one is for the tests of Blender's developers, the other waits for a render that may never come.
NOT_TRIED = frozenset({"asset_generate_preview", "unit_test_compare"})


class UnknownArgumentError(Exception):
    """It is not known what an argument takes."""


def editors():
    """The file, the manager of the windows, and the editors of the first screen."""
    yield "file", bpy.data
    yield "window manager", bpy.context.window_manager
    for area in (bpy.context.screen or bpy.data.screens[0]).areas:
        yield "area", area
        for space in area.spaces:
            yield called(space), space


def nodes():
    """A node of each class."""
    trees = {name: bpy.data.node_groups.new("new", name) for name in TREES}
    for name in sorted(dir(bpy.types)):
        cls = getattr(bpy.types, name)
        if isinstance(cls, type) and issubclass(cls, bpy.types.Node):
            for node in list(make_in(trees, name).values())[:1]:
                yield called(node), node


# Their things stay, and none changes another: all of them are tried together.
STAYING = (nodes, constraints)


def whole_strips():
    """Strips, as they are when all was made: one of them has modifiers by then."""
    yield from list(strips())


def collections(struct):
    """(collection, whether it has functions or settings of its own) of a thing."""
    for prop in struct.bl_rna.properties:
        if prop.type == "COLLECTION":
            # Some ask for what is not there without a window.
            with suppress(Exception):
                yield getattr(struct, prop.identifier), prop.srna is not None


def reached(observer, root):
    """A thing, what belongs to it, their collections, and the first element of each, with all of that again."""
    queue, seen = [(root, DEPTH)], set()
    while queue:
        thing, left = queue.pop(0)
        for struct in observer.parts(thing):
            key = (struct.as_pointer(), struct.bl_rna.identifier)
            if key in seen:
                continue
            seen.add(key)
            yield struct
            for collection, is_own in collections(struct):
                if is_own:
                    yield collection
                first = next(iter(collection), None) if left else None
                if isinstance(first, bpy.types.bpy_struct) and not isinstance(first, bpy.types.ID):
                    queue.append((first, left - 1))


def value_for(item):
    """The plainest value for an argument that is no thing."""
    if item.type in NUMBERS and item.is_array and item.array_length:
        return [0] * item.array_length
    if item.type == "ENUM" and len(item.enum_items_static):  # some are computed of what is not there
        first = item.enum_items_static[0].identifier
        return {first} if item.is_enum_flag else first
    value = None if item.type == "STRING" and item.subtype in PATHS else plain_argument(item)
    if value is None:
        raise UnknownArgumentError(item.identifier)
    return value


def fitting(item, things):
    """The first of these things, else of the file's, that an argument takes; None for none."""
    wanted = getattr(bpy.types, item.fixed_type.identifier, None)
    blocks = (
        getattr(bpy.data, prop.identifier)
        for prop in bpy.data.bl_rna.properties
        if prop.type == "COLLECTION" and wanted is not None and issubclass(wanted, bpy.types.ID)
    )
    found = itertools.chain(things, itertools.chain.from_iterable(blocks))
    return next((thing for thing in found if wanted is not None and isinstance(thing, wanted)), None)


def tried(run, *, unset=True):
    """Does what may crash Blender, then or when the scene is computed next: without a scene for the sequencer."""
    if unset:
        no_sequencer_scene()
    with suppress(Exception):
        run()
    bpy.context.view_layer.update()
    return True


class Assignment:
    """None for a pointer of an owner, which belongs to what was ``made``."""

    leaves_gaps = False

    def __init__(self, made, owner, prop):
        self.made, self.owner, self.item = made, owner, prop
        self.path = rna.path_of(owner.bl_rna, prop.identifier)

    def run(self):
        """Assigns it."""
        setattr(self.owner, self.item.identifier, None)

    def causes(self):
        """What is to be said of the crash: ``none``, what is None; ``instead``, the index that unsets it as well."""
        name = self.item.identifier

        def work():
            setattr(self.owner, f"{name}_index", -1)
            bpy.context.view_layer.update()
            return getattr(self.owner, name) is None

        return {"none": [name], "instead": f"{name}_index" if apart(work) else ""}


class Call:
    """A function with the plainest arguments that it must have, and None for things.

    Raises UnknownArgumentError.
    """

    def __init__(self, made, owner, function, path, things):
        self.made, self.owner, self.item, self.path = made, owner, function, path
        self.leaves_gaps = owner.bl_rna.identifier in LEAVING_GAPS
        is_collection = isinstance(owner, bpy.types.bpy_prop_collection)
        self.things = [*(owner if is_collection else ()), *things]
        required = [item for item in function.parameters if item.is_required and not item.is_output]
        self.wanted = [item for item in required if item.type == "POINTER"]
        self.plain = {item.identifier: value_for(item) for item in required if item.type != "POINTER"}

    def run(self):
        """Calls it."""
        self.call()

    def call(self, **given):
        """Calls it, with what is given besides."""
        nothing = {item.identifier: None for item in self.wanted}
        getattr(self.owner, self.item.identifier)(**{**nothing, **self.plain, **given})

    def ends(self, *, unset=True, **given):
        """Whether that crashes Blender."""
        return crashes(lambda: tried(lambda: self.call(**given), unset=unset))

    def filled(self):
        """Things for the arguments that want some; None where there is none that fits."""
        return {item.identifier: fitting(item, self.things) for item in self.wanted}

    def causes(self):
        """What is to be said of the crash; nothing where it is not known what it is of.

        ``without``: what must not be None; ``none``: each argument of which None alone crashes Blender; ``left_out``:
        those of which giving none does; ``always``: that nothing prevented it.
        """
        if has_sequencer_scene() and not self.ends(unset=False):
            return {"without": SEQUENCER_SCENE}
        given = self.filled()
        if None in given.values():
            return {"none": list(given)} if len(given) == 1 else {}
        if given and not self.ends(**given):
            # Of one alone it is known: that is the call that crashed.
            alone = [name for name in given if len(given) == 1 or self.ends(**{**given, name: None})]
            return {"none": alone} if alone else {}
        further = list(self.further())
        for count in range(1, MOST_FURTHER + 1):
            for more in itertools.combinations(further, count):
                if not self.ends(**given, **dict(more)):
                    return {"left_out": [name for name, _ in more]}
        return {} if given else {"always": True}

    def further(self):
        """(name, value) of the arguments that may be left out."""
        for item in self.item.parameters:
            if not item.is_required and not item.is_output and item.type != "POINTER":
                with suppress(UnknownArgumentError):
                    yield item.identifier, value_for(item)


class FilledCall(Call):
    """The same with things that fit."""

    def run(self):
        """Calls it, where there are some."""
        given = self.filled()
        if given and None not in given.values():
            self.call(**given)

    def causes(self):
        """``without``: what must not be None. Of other causes nothing is known: it may be of just these things."""
        if has_sequencer_scene() and not self.ends(unset=False, **self.filled()):
            return {"without": SEQUENCER_SCENE}
        return {}


def try_each(attempts, send):
    """Does all of it; the number of each is sent before."""
    for number, attempt in enumerate(attempts):
        send(number)
        tried(attempt.run)


class Trial:
    """Tries things, and sends what crashed Blender, a line each.

    ``counts`` are how often each setting and function was tried already.
    """

    def __init__(self, observer, counts, send):
        self.observer = observer
        self.counts = counts
        self.send = send
        self.survived = set()
        self.things = []

    def look(self, made):
        """Tries what was not tried often enough on (label, thing) pairs and what belongs to them, all in one process.

        What ended that is the first in another one, with the rest behind it: what ends that too does so by itself. What
        spoils a mesh for the others is the last.
        """
        left = []
        for label, thing in made:
            owners = list(reached(self.observer, thing))
            left += [attempt for owner in owners for attempt in self.attempts(label, owner)]
            self.things += owners
        left.sort(key=lambda attempt: attempt.leaves_gaps)
        while left:
            status, begun = sent_with_status(partial(try_each, left), MOMENT)
            place = len(left) if status == 0 else begun[-1] if begun else 0
            self.survived.update(attempt.path for attempt in left[:place])
            if place == 0:
                alone = left.pop(0)
                if is_crash(status):
                    self.tell(alone)
            left = left[place:]

    def tell(self, attempt):
        """Sends what is to be said of an attempt that crashes Blender by itself, if that is known."""
        if causes := attempt.causes():
            is_own = attempt.path.startswith(f"bpy.types.{attempt.owner.bl_rna.identifier}.")
            if is_own:
                self.counts[self.key(attempt.item)] = MOST_THINGS
            self.send({"path": attempt.path, "made": attempt.made, "is_own": is_own, **causes})

    def attempts(self, made, owner):
        """What is tried on a thing; what changes most of it comes last."""
        calls = list(self.calls(made, owner))
        yield from calls
        for prop in owner.bl_rna.properties:
            if prop.type == "POINTER" and not prop.is_readonly and self.is_left(prop):
                yield Assignment(made, owner, prop)
        for call in calls:
            yield FilledCall(made, owner, call.item, call.path, self.things)

    def calls(self, made, owner):
        """The calls of a thing's functions."""
        struct = owner.bl_rna
        while struct is not None:
            for function in rna.own(struct, "functions"):
                name = function.identifier
                is_called = function.use_self and not function.is_registered and name not in NOT_TRIED
                if is_called and self.is_left(function):
                    with suppress(UnknownArgumentError):
                        yield Call(
                            made, owner, function, f"bpy.types.{struct.identifier}.{name}", self.things
                        )
            struct = struct.base

    def is_left(self, item):
        """Whether it was not tried often enough; it is counted."""
        key = self.key(item)
        self.counts[key] = self.counts.get(key, 0) + 1
        return self.counts[key] <= MOST_THINGS

    def key(self, item):
        """What a setting or function is known by in another process."""
        return str(item.as_pointer())


def try_all(make, trial):
    """Tries what one maker makes, and what belongs to it."""
    scratch_scene()
    trial.things.append(bpy.context.evaluated_depsgraph_get())
    made = ((label, thing) for label, thing, *_ in make() if thing is not None)
    if make in STAYING:
        trial.look(made)
    else:
        for each in made:
            trial.look([each])


def try_apart(make, observer, counts, send):
    """The same in a process of its own."""
    trial = Trial(observer, counts, send)
    try_all(make, trial)
    send({"counts": trial.counts, "survived": sorted(trial.survived)})


def find_all(write, observer):
    """One ``crashes`` record for each setting and function. Wants a system that can work apart.

    What a class inherits may crash Blender for a reason of its own: it is told where it did on all that was tried.
    """
    found, counts, survived = {}, {}, set()
    for make in (editors, animation, whole_strips, objects, nodes, *BY_FUNCTIONS):
        for row in sent_apart(partial(try_apart, make, observer, counts))[1]:
            if "path" in row:
                found.setdefault(row["path"], row)
            else:
                counts = row["counts"]
                survived.update(row["survived"])
    for path, row in sorted(found.items()):
        if row.pop("is_own") or path not in survived:
            write("crashes", **row)
