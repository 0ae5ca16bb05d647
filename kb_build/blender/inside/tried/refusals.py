# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds calls that Blender refuses although their arguments are what the signature asks for.

The functions that add something, of new things and of their collections, are called with each value of their choices
and the plainest other arguments. A call that is refused is tried again with arguments that may be left out, and in
edit mode; one that is taken is made again.
"""

import itertools
import re
from collections import defaultdict
from contextlib import suppress

import bpy

from ..apart import apart, sent_apart
from ..instances.making import (
    activate,
    called,
    choices,
    object_of,
    scratch_scene,
)
from ..instances.new_things import BY_FUNCTIONS
from ..instances.pointer_fillers import ADDING
from ..nodes import TREES
from ..nodes import make as make_in

NAMED = ADDING | {"insert"}
# A name and a number that no message of Blender's has of itself.
NAME = "plain"
NUMBER = 7
MOST_CALLS = 100
MOST_ATTEMPTS = 4
# What a refusal names: things and what was given.
GIVEN = re.compile(r"'[^']*'|\"[^\"]*\"|\b" + NAME + r"\b|\b7(?:\.0+)?\b")
NONE = "returned None"
# Their new elements stand for nothing: who reads such a mesh crashes, or comes to no end.
LEAVING_GAPS = frozenset({"MeshEdges", "MeshLoops", "MeshLoopTriangles", "MeshPolygons"})
# Built-in nodes have their sockets.
NOT_TRIED = LEAVING_GAPS | {"NodeInputs", "NodeOutputs"}


def is_adding(function):
    """Whether a function may add something, by its name."""
    return function.use_self and not NAMED.isdisjoint(function.identifier.split("_"))


def tried(rna):
    """The functions of a class that may add something and need nothing but texts, numbers and choices."""
    for function in rna.functions if rna.identifier not in NOT_TRIED else ():
        required = [item for item in function.parameters if item.is_required and not item.is_output]
        if not is_adding(function):
            continue
        if all(plain_argument(item) is not None or is_choice(item) for item in required):
            yield function


def is_choice(item):
    """Whether an argument is one of several values."""
    return item.type == "ENUM" and not item.is_enum_flag and len(item.enum_items) > 0


def plain_argument(item):
    """The plainest value that an argument takes; None where that is not known."""
    if item.type == "STRING":
        return NAME
    if item.type == "BOOLEAN" and not item.is_array:
        return False
    if item.type in {"INT", "FLOAT"} and not item.is_array:
        return type(item.default)(min(max(NUMBER, item.hard_min), item.hard_max))
    return None


def calls(function):
    """(the choices that are given, all arguments) of the calls with each value of the required choices."""
    required = [item for item in function.parameters if item.is_required and not item.is_output]
    plain = {item.identifier: plain_argument(item) for item in required if not is_choice(item)}
    names = [item.identifier for item in required if is_choice(item)]
    values = [[each.identifier for each in item.enum_items] for item in required if is_choice(item)]
    for chosen in itertools.islice(itertools.product(*values), MOST_CALLS):
        given = dict(zip(names, chosen, strict=True))
        yield given, {**plain, **given}


def refusal(owner, function, arguments, made=None):
    """Why a call was refused, without what names things; empty if it was not, None if nobody knows.

    What was made is removed again, or put into the list ``made``.
    """
    try:
        new = getattr(owner, function.identifier)(**arguments)
    except RuntimeError as error:
        message = str(error).strip().removeprefix("Error: ").partition("\n")[0]
        return GIVEN.sub("…", message)
    except Exception:
        return None  # of Python's own checks: not what Blender says of the call
    if new is None and any(item.is_output and item.type == "POINTER" for item in function.parameters):
        return NONE
    if made is None:
        take_away(owner, new)
    else:
        made.append(new)
    return ""


def take_away(owner, new):
    """Removes what was added: the next call must not be refused for it."""
    with suppress(Exception):
        owner.remove(new)


def further_arguments(function, things):
    """(name, value) of the arguments that may be left out, and that are nothing if they are.

    ``things`` are those that may be given, each once.
    """
    left = list(things)
    for item in function.parameters:
        if item.is_required or item.is_output:
            continue
        if item.type == "INT" and not item.is_array and not item.default:
            # Beyond the plain one: an end lies behind its start.
            yield item.identifier, int(min(NUMBER + 1, item.hard_max))
        elif item.type == "POINTER":
            cls = getattr(bpy.types, item.fixed_type.identifier, ())
            fitting = next((thing for thing in left if isinstance(thing, cls)), None)
            if fitting is not None:
                left.remove(fitting)
                yield item.identifier, fitting


def taken_with(owner, function, arguments, things):
    """The fewest further arguments with which a refused call is taken; empty for none."""
    further = list(further_arguments(function, things))
    for count in range(1, len(further) + 1):
        for more in itertools.combinations(further, count):
            if refusal(owner, function, {**arguments, **dict(more)}) == "":
                return [name for name, _ in more]
    return []


def object_with(data):
    """A new object of these data; None for what is no object's data."""
    if not isinstance(data, bpy.types.ID) or isinstance(data, bpy.types.Object):
        return None
    try:
        return bpy.data.objects.new("new", data)
    except (TypeError, RuntimeError):
        return None


def is_taken_in_edit_mode(struct, owner, function, arguments):
    """Whether a refused call is taken while the active object, whose data it changes, is in edit mode.

    It is tried apart: leaving edit mode frees the parts of the data, this thing among them.
    """
    obj = object_with(struct.id_data)
    if obj is None:
        return False

    def work():
        bpy.context.scene.collection.objects.link(obj)
        activate(obj)
        bpy.ops.object.mode_set(mode="EDIT")
        return refusal(owner, function, arguments) == ""

    try:
        return apart(work)
    finally:
        bpy.data.objects.remove(obj)


def other_arguments(arguments, given):
    """The same choices with other names and numbers."""
    others = {str: "another", float: NUMBER + 1.0, int: NUMBER + 1}
    return {
        name: value if name in given else others.get(type(value), value) for name, value in arguments.items()
    }


class Trial:
    """Tries functions, and sends what comes of it, a line each; before each function its path alone."""

    def __init__(self, send, skipped):
        self.send = send
        self.skipped = skipped
        self.tried = set()
        self.taken = {}  # function → the arguments of a call with another choice that was taken
        self.things = []
        self.modes = {}

    def look(self, label, struct):
        """Tries the functions of a thing's collections."""
        for prop in struct.bl_rna.properties:
            owner = (
                getattr(struct, prop.identifier, None) if prop.type == "COLLECTION" and prop.srna else None
            )
            for function in tried(prop.srna) if owner is not None else ():
                path = f"bpy.types.{prop.srna.identifier}.{function.identifier}"
                if path not in self.skipped and (path, label) not in self.tried:
                    self.tried.add((path, label))
                    self.send({"path": path})
                    for chosen, arguments in calls(function):
                        for outcome in self.outcomes(struct, owner, function, chosen, arguments):
                            self.send({"path": path, "made": label, "chosen": chosen, **outcome})
        self.things.append(struct)

    def mode(self, message, struct, owner, function, arguments):
        """The mode in which a refused call is taken; empty for none. What is refused for one reason is tried once."""
        key = struct, function, message
        if key not in self.modes:
            is_taken = is_taken_in_edit_mode(struct, owner, function, arguments)
            self.modes[key] = "EDIT" if is_taken else ""
        return self.modes[key]

    def outcomes(self, struct, owner, function, chosen, arguments):
        """What comes of one call, and of the calls that it leads to."""
        made = []
        message = refusal(owner, function, arguments, made)
        if message:
            given = taken_with(owner, function, arguments, [*owner, *self.things])
            mode = "" if given else self.mode(message, struct, owner, function, arguments)
            yield {"message": message, "given": given, "mode": mode}
        elif message is not None:
            yield {"message": ""}
            # The next one that is added may move it elsewhere in memory.
            place = next((place for place, one in enumerate(owner) if one == made[0]), None)
            message = refusal(owner, function, arguments)
            others = message and refusal(owner, function, other_arguments(arguments, chosen))
            take_away(owner, made[0] if place is None else owner[place])
            if message:
                again = "any" if others == message else "same"
                yield {
                    "message": message,
                    "again": "other" if self.is_first(owner, function, arguments) else again,
                }
            else:
                self.taken.setdefault(function, arguments)

    def is_first(self, owner, function, arguments):
        """Whether a call is refused after one with another choice, too."""
        made = []
        if refusal(owner, function, self.taken.get(function, arguments), made) or not made:
            return False
        is_refused = bool(refusal(owner, function, arguments))
        take_away(owner, made[0])
        return is_refused and function in self.taken


def objects():
    """An object of every type."""
    for kind in choices("Object", "type"):
        obj = object_of(kind)
        if obj is not None:
            yield f"{kind} object", obj


def nodes_with_items():
    """A node of each class that has lists of items of its own: what a zone keeps, what a file output writes."""
    trees = {name: bpy.data.node_groups.new("new", name) for name in TREES}
    for name in sorted(dir(bpy.types)):
        cls = getattr(bpy.types, name)
        if not (isinstance(cls, type) and issubclass(cls, bpy.types.Node)) or not has_items(cls.bl_rna):
            continue
        nodes = make_in(trees, name)
        for node in nodes.values():
            # Which items it takes may depend on the tree.
            yield called(node) + (f" in a {called(node.id_data)}" if len(nodes) > 1 else ""), node


def has_items(rna):
    """Whether a class of nodes has a collection that may be added to, besides its sockets."""
    return any(
        prop.type == "COLLECTION" and prop.srna and any(map(is_adding, prop.srna.functions))
        for prop in rna.properties
        if prop.srna is None or prop.srna.identifier not in NOT_TRIED
    )


def try_all(make, observer, trial):
    """Tries what one maker makes, and what belongs to it."""
    scratch_scene()
    for label, thing, *_ in make():
        if thing is None or (isinstance(thing, bpy.types.Object) and make is not objects):
            continue
        for struct in observer.parts(thing):
            trial.look(label, struct)


def attempt(make, observer, skipped):
    """(whether it came to its end, what was sent) of trying what one maker makes, in a process of its own."""
    return sent_apart(lambda send: try_all(make, observer, Trial(send, skipped)))


def tried_apart(make, observer):
    """What comes of trying what one maker makes. What ends Blender, or keeps it waiting, is left out."""
    skipped = set()
    rows = []
    for _ in range(MOST_ATTEMPTS):
        ended, rows = attempt(make, observer, skipped)
        if ended or not rows:
            break
        skipped.add(rows[-1]["path"])
    return [row for row in rows if "message" in row]


def find_all(write, observer):
    """One ``refusals`` record for each function of which a call was refused: all outcomes of the calls.

    Wants a system that can work apart.
    """
    found = defaultdict(list)
    for make in (objects, nodes_with_items, *BY_FUNCTIONS):
        for row in tried_apart(make, observer):
            found[row.pop("path")].append(row)
    for path, outcomes in sorted(found.items()):
        if any(row["message"] for row in outcomes):
            write("refusals", path=path, outcomes=outcomes)
