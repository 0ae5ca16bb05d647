"""The flags that a symbol may have, by name. A leaf module: it imports nothing of the project."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

# The flags of properties that scripts cannot assign, that can have keyframes, that are a set of items, and that are a
# pointer which is never None.
READ_ONLY, ANIMATABLE, ENUM_FLAG, NEVER_NONE = "readonly", "animatable", "enum-flag", "never-none"
# The flags of functions that are called on a class, and that need neither a class nor an instance.
OF_CLASS, STATIC = "classmethod", "static"
# The flag of what was compared with newly made things, so that its default is what these have.
COMPARED = "compared"
# The flag of a property that an add-on has registered.
RUNTIME = "runtime"
# The flags of sockets that a new node hides, and that their name gives while they are shown.
HIDDEN, NAME_WHEN_SHOWN = "hidden-by-default", "name-when-shown"
# How flags of sockets begin: with the identifier, another name in some mode, and a setting that chooses the type.
IDENTIFIER, ALSO_NAMED, TYPE_BY = "identifier:", "also-named:", "type-by:"
# How a flag begins that names what the symbol repeats, or is another name of; and one that names a kind of editor which
# provides a member of the context.
SAME_AS, PROVIDED_BY = "same-as:", "from:"
# How flags begin that say what fills a pointer that is None on a new thing, and on which new things it is not None.
FILLED_BY = "filled-by:"
FILLED_ON = "filled-on:"
# The flags of a member of the context that is None: where no object is active, and outside the areas of windows.
WITHOUT_ACTIVE = "none-without-active-object"
WITHOUT_AREA = "none-without-area"
# … and while the interface shows no such thing: no popup, no asset.
WITHOUT_SHOWN = "none-unless-shown"
# The flag of a socket that its identifier gives in no mode of its node.
NEVER_BY_IDENTIFIER = "identifier-never"
# How flags begin that name the other operators which an operator's own script calls.
CALLS = "calls:"
# How flags begin that name the types of areas in which alone an operator runs (``any``), and the member of the context
# that it takes instead.
AREAS = "areas:"
GIVEN = "given:"
# How flags begin that name what must be set besides, where an operator runs only in areas: statements, in their order,
# or what is said of an area that is not enough where that was not found.
ALSO = "also:"
NOT_ENOUGH = "..."
# The flags of an operator whose poll said no to all that was tried, and of one that was not asked or did not answer
# alike.
REFUSED_ALL = "refused-all"
NOT_KNOWN = "poll-not-known"
# How a flag begins that says what must not be None: Blender ends when the function is called.
ENDS_WITHOUT = "ends-without:"
# How flags begin that name an argument for which None ends Blender, or the pointer itself to which None is assigned;
# and the argument without which a call does, although it may be left out.
ENDS_ON_NONE, ENDS_LEFT_OUT = "ends-on-none:", "ends-left-out:"
# The flag of a function that ends a Blender without a window.
ENDS_WINDOWLESS = "ends-windowless"
# The flags of a function that ends Blender whatever it is given, and of one that does so where Blender is a module of
# Python.
ENDS_EVERY_TIME, ENDS_IN_MODULE = "ends-every-time", "ends-in-module"
# How a flag begins that names the index of -1 by which a pointer comes to be None.
UNSET_BY = "unset-by:"
# How a flag begins that says what must be called before an operator's mode is entered: else Blender ends where there is
# no undo step yet, as in one without a window.
ENDS_BEFORE = "ends-before:"
# How the flag of an operator begins that adds an object whose data RNA has no class for, before what to call instead.
BARE_DATA = "bare-data:"
# The flag of a switch that some panel shows the other way round.
INVERTED = "inverted"
# How a flag begins that names an end of a number's range that is not kept: ``min`` or ``max``.
UNBOUNDED = "unbounded:"
# How a flag begins that says where a number of a new thing stops before the end of its range: ``min=0``, ``max=1``, or
# by which other number of it, ``min=frame_start``.
STOPS = "stops:"
# The flag of a socket that a node of a zone has once it is paired with the other one, and the method that does it.
WHEN_PAIRED = "when-paired"
PAIRS = "pair_with_output"
# How the flag of a class of nodes begins that says what ``type`` is of all such nodes.
NODE_TYPE = "node-type:"
# How a flag begins that says in which of a node's modes a socket is shown, where its modes cannot say it.
SHOWN_WHEN = "shown-when:"
# The flag of a property, not called ``name``, by whose value collections find such an item.
NAMES_ITEMS = "names-items"
# The flag of a collection that has no elements on what is newly made.
EMPTY = "empty-when-new"
# The flag of a collection whose elements only a loop gives.
ITERATED = "only-iterated"
# The flag of what a module has as a name alone, as this Blender is built: it is None.
STUB = "stub"
# The flag of a pointer that is None on some new things of a kind and not on others.
NONE_ON_SOME = "none-on-some"
# The flags of a collection of ``bpy.data`` or the window manager that is empty when Blender starts, and of a pointer
# that leads to something on what it starts with.
EMPTY_AT_START, FILLED_AT_START = "empty-at-start", "filled-at-start"
# The flag of a function that gave None for every index, and of a method that changes its value and returns None.
GIVES_NONE, RETURNS_NONE = "gives-none", "returns-none"
# How a flag begins with what Blender said of a call where it had no window.
WINDOWLESS = "windowless:"
# How a flag begins that names the property of the same class which always has the same value.
SAME_VALUE = "same-value:"
# How flags begin that name another property of its class which assigning a set of items changes, and the flag of such a
# set that keeps its items where it is given none.
SETS_ALSO, KEEPS_ITEMS = "sets-also:", "keeps-items"
# How flags begin of a property that RNA calls writable, and Blender does not always let be assigned: on which things it
# is locked, or is not (``any``: on all that were tried), in which modes, and which setting frees it.
LOCKED_ON = "locked-on:"
FREE_ON = "free-on:"
LOCKED_WITH = "locked-with:"
FREED_BY = "freed-by:"
ANY = "any"
# How a flag begins that says which part of its object alone a text may name, and is left out else: ``UV map``.
NAMES_PART = "names-part:"
# How a flag begins that says what becomes of a kind of thing that a pointer is given: ``takes:MESH`` (see accepted.py).
ACCEPTS = "accepts:"
# How a flag begins that names what a class of a script's own must have, or Blender does not register it.
MUST_HAVE = "must-have:"
# The flags of functions that such classes define and Blender calls: if they want, and in any case.
DEFINED, DEFINED_ALWAYS = "defined", "defined-always"
# The flag of what Blender computes for evaluated objects, and leaves empty on the originals.
EVALUATED = "evaluated-only"
THEN = " then "  # between calls that fill it one after the other


def told_by(flags: Iterable[str], prefix: str) -> tuple[str, ...]:
    """What the flags that begin with ``prefix`` say."""
    return tuple([flag.removeprefix(prefix) for flag in flags if flag.startswith(prefix)])
