# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds how functions written in C take their arguments, where their documentation does not say it.

Some take none by its name, though it names them: they refuse a call with any keyword before they look at what is given.
Others take only the first few by their places, and likewise refuse more, or take no names for those alone. Of some, the
call is documented without its arguments, or as if it required all.
"""

import functools
import inspect
import re
import types
from contextlib import suppress

import bmesh
import bpy
import mathutils
from mathutils import bvhtree, kdtree

NO_KEYWORDS = "no-keywords"
BY_PLACE = "by-place:"  # and how many arguments are taken so
PLACE_ONLY = "place-only:"  # and how many of the arguments take no name, the first ones
BY_NAME = "by-name:"  # and one that is taken so, though its documentation says that it is not
OPTIONAL = "all-optional"
REQUIRES = "requires:"  # and how many of the arguments that are documented below a call without any
REFUSED = ("takes no keyword arguments", "no keywords are expected")
TAKES = re.compile(r"takes at most (\d+) arguments?")
MISSING = re.compile(r"missing required argument '(\w+)' \(pos 1\)")
WANTS_BY_PLACE = re.compile(r"takes (?:at least|exactly) (\d+) positional arguments?")
UNEXPECTED = re.compile(r"unexpected keyword argument '(\w+)'|'(\w+)' is an invalid keyword argument")
TAKES_BY_PLACE = re.compile(r"takes (?:at most|exactly) (\d+) positional|takes (no|0) positional")
# What definitions of properties say of what is given by its place, the first of which is a class.
PROPERTIES = "bpy.props"
NONE_BY_PLACE, ONE_BY_PLACE = "all args must be keywords", "expected one positional arg"
NO_TEXT = "argument 1 must be str"
# Of bpy.data and the context, which change nothing when they are called.
LOOKUPS = ("file_path_map", "user_map", "temp_override")
NOBODYS = "no argument's name"
NO_NAME = {NOBODYS: None}
FILLERS = (0, "no name", object())
EXACTLY = re.compile(r"takes exactly (\w+) arguments?")
MISSES = re.compile(r"missing required argument '\w+' \(pos (\d+)\)")
NONE_IN_CALL = re.compile(r"\.\. \w+:: *\w+\(\)[^\n]*\n.*^\s*:(?:arg|param) ", re.DOTALL | re.MULTILINE)
MANY = (object(),) * 30
CALL = re.compile(r"\w\(([^)\n]+)\)")
TOLD = re.compile(r"\.\. \w+:: *\w+\(([^)=\[\n]+)\)\s")  # without defaults
AT_LEAST = re.compile(r"takes at least (\d+) arguments? ")
CLASS = re.compile(r"\.\. class:: *\w+\([^)\n]")
NAME = re.compile(r"(?:^|,)\s*(\w+)(?=\s*(?:[=,:]|$))")
ANY_NAME = re.compile(r",?\s*\*\*\w+\s*$")


def sounds():
    """A sound, a sequence, an entry of it, and what plays them; as many of them as this Blender makes."""
    made = []
    with suppress(Exception):
        import aud

        made.append(aud.Sound.sine(440))
        made.append(aud.Sequence())
        made.append(made[1].add(made[0].limit(0, 1), 0.0, 1.0, 0.0))
        made.append(aud.Device("None"))  # plays nothing
        made += [aud.DynamicMusic(made[-1]), aud.PlaybackManager(made[-1])]
    return made


def custom_properties():
    """A group of custom properties, an array of them, and what tells how one is shown."""
    owner = bpy.context.window_manager  # which is in no file
    owner["new"], owner["shown"] = {"array": [1, 2]}, 1.0
    return owner["new"], owner["new"]["array"], owner.id_properties_ui("shown")


@functools.cache
def instances():
    """Class → an instance, of the classes whose methods can only be asked on one."""
    mesh = bmesh.new()
    weights = mesh.verts.layers.float.new("new")
    groups = mesh.verts.layers.deform.verify()
    corners = [mesh.verts.new(place) for place in ((0, 0, 0), (1, 0, 0), (0, 1, 0))]
    face = mesh.faces.new(corners)
    loop = face.loops[0]
    made = [mesh, corners[0], mesh.edges[:][0], face, loop, mesh.verts, mesh.edges, mesh.faces, face.loops]
    made += [mesh.select_history, mesh.verts.layers, mesh.verts.layers.float, weights, corners[0][groups]]
    made += [
        mathutils.Vector(),
        mathutils.Euler(),
        mathutils.Matrix(),
        mathutils.Quaternion(),
        mathutils.Color(),
    ]
    made += [bvhtree.BVHTree.FromPolygons([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]), kdtree.KDTree(1)]
    made += [*sounds(), *custom_properties()]
    found = {type(one): one for one in made}
    found[bpy.types.bpy_struct] = bpy.context.preferences
    found[bpy.types.bpy_prop_collection] = found[bpy.types.bpy_prop] = bpy.data.objects
    found[bpy.types.Context], found[bpy.types.BlendData] = bpy.context, bpy.data
    found[bpy.types.BlendDataLibraries] = bpy.data.libraries
    return found


def callable_of(value):
    """What can be called of a function, a method or a documented class written in C; None for others, and without an
    instance.
    """
    if isinstance(value, types.BuiltinFunctionType) or is_documented_class(value):
        return value
    if isinstance(value, (types.MethodDescriptorType, types.ClassMethodDescriptorType)):
        owner = value.__objclass__
        is_of_class = isinstance(value, types.ClassMethodDescriptorType)
        return getattr(owner if is_of_class else instances().get(owner), value.__name__, None)
    if isinstance(value, classmethod) and isinstance(value.__func__, types.BuiltinFunctionType):
        return value.__func__
    return None


def takes_no_names(said):
    """Whether what Blender says of a call with a name is that the function takes none at all."""
    return any(text in said for text in REFUSED)


def is_documented_class(value):
    """Whether a class's documentation says what it is called with."""
    return isinstance(value, type) and CLASS.match(inspect.getdoc(value) or "") is not None


def refusal(function, /, *given, **named):
    """What Blender says of a call; empty where it says nothing."""
    try:
        function(*given, **named)
    except (TypeError, ValueError) as error:
        return str(error)
    except SystemError as error:  # of a function that gives a result beside its error
        return str(error.__cause__ or "")
    except Exception:
        return ""
    return ""


def of_property(function):
    """The flag of a function that defines a property: none of them tells that it takes names only."""
    said = refusal(function, object(), object())
    if NONE_BY_PLACE in said:
        return [f"{BY_PLACE}0"]
    return [f"{BY_PLACE}1"] if ONE_BY_PLACE in said else []


def lacks_marks(function):
    """Whether the documentation of a function names arguments, and does not say which are given by place or name."""
    call = CALL.search(inspect.getdoc(function) or "")
    return call is not None and "*" not in ANY_NAME.sub("", call[1]) and "/" not in call[1]


def of_names(function, said):
    """The flag of a function that takes its first argument by its name, though its documentation says that it does not;
    ``said``: what Blender says of a call with another name.
    """
    call = CALL.search(inspect.getdoc(function) or "")
    named = MISSING.search(said)
    is_told = call is not None and named is not None and "/" in call[1]
    return [BY_NAME + named[1]] if is_told and named[1] in call[1].partition("/")[0] else []


def of_nameless(function, said):
    """The flag of a function whose first arguments take no name, though its documentation does not say it."""
    call = CALL.search(inspect.getdoc(function) or "")
    if call is None or "/" in call[1]:
        return []
    if wants := WANTS_BY_PLACE.search(said):
        return [PLACE_ONLY + wants[1]]
    count = 0
    for name in NAME.findall(call[1].partition("*")[0]):
        refused = UNEXPECTED.search(refusal(function, **{name: object()}, **NO_NAME))
        if refused is None or name not in refused.groups():
            break
        count += 1
    return [f"{PLACE_ONLY}{count}"] if count else []


def of_lookups(function):
    """The flags of a function that changes nothing, and needs no arguments, whatever is documented."""
    is_free = function.__name__ in LOOKUPS and not refusal(function)
    return [OPTIONAL, *of_places(function)] if is_free else []


def of_places(function):
    """The flag of a function that takes only its first few arguments by their places."""
    takes = TAKES.search(refusal(function, *MANY)) if lacks_marks(function) else None
    if takes is None:
        return []
    given = MANY[: int(takes[1])]
    said = refusal(function, *given)
    if NO_TEXT in said:  # which is looked at before the others are counted
        said = refusal(function, "no name", *given[1:])
    by_place = TAKES_BY_PLACE.search(said)
    return [f"{BY_PLACE}{by_place[1] or 0}"] if by_place else []


def of_untold(function):
    """The flag of a function whose documentation has arguments, and a call without any: how many of them it requires.

    It is only asked with too many or too few, so that nothing happens.
    """
    if not NONE_IN_CALL.match(inspect.getdoc(function) or ""):
        return []
    said = refusal(function, *MANY)
    if exactly := EXACTLY.search(said):
        return [REQUIRES + exactly[1].replace("one", "1")]
    least = 0
    while TAKES.search(said) and (misses := MISSES.search(refusal(function, *MANY[: max(least, 1)]))):
        least = int(misses[1])
    return [f"{REQUIRES}{least}"] if least else []


def least_of(function, said):
    """How many arguments a function requires that takes names; None where it is not known.

    ``said``: what Blender says of a call with another name alone, which is refused after what is missing.
    """
    given = []
    while MISSES.search(said):
        fillers = ((filler, refusal(function, *given, filler, **NO_NAME)) for filler in FILLERS)
        taken = [(filler, more) for filler, more in fillers if MISSES.search(more) or NOBODYS in more]
        if not taken:
            return None
        given.append(taken[0][0])
        said = taken[0][1]
    return len(given)


def of_fewer(function, said):
    """The flag of a function that requires fewer arguments than its documentation, which tells no defaults."""
    told = TOLD.match(inspect.getdoc(function) or "")
    if told is None or not lacks_marks(function):
        return []
    if takes_no_names(said):
        # What counts its arguments first is safe with none; some others crash Blender.
        at_least = AT_LEAST.search(refusal(function)) if TAKES.search(refusal(function, *MANY)) else None
        least = int(at_least[1]) if at_least else None
    else:
        least = least_of(function, said) if MISSES.search(said) or NOBODYS in said else None
    is_fewer = least is not None and least < len(NAME.findall(told[1]))
    return [f"{REQUIRES}{least}"] if is_fewer else []


def flags_of(value):
    """The flags of a function, a class, or a class's method that tell how it takes arguments; none for what is no
    other than its documentation says, and for what cannot be asked.
    """
    function = callable_of(value)
    if function is None:
        return []
    if function.__module__ == PROPERTIES:
        return of_property(function)
    said = refusal(function, **NO_NAME)
    if isinstance(value, type):  # which is not made
        return [NO_KEYWORDS] if takes_no_names(said) else []
    untold = of_untold(function) or of_fewer(function, said)
    if takes_no_names(said):
        return [NO_KEYWORDS, *untold]
    told = untold or of_names(function, said) or of_lookups(function) or of_places(function)
    return [*told, *of_nameless(function, said)]
