# SPDX-License-Identifier: GPL-3.0-or-later
"""Members of ``bpy.context``: those of its class, and those that the screen provides.

Which of the latter exist, and of what type, depends on editor and mode: a member's type is what Blender
returns for it in one of the scratch situations made here, and so is where it is None. The reference lists them
below ``bpy.context`` in some versions, below ``bpy.types.Context`` in others; both names are written.
"""

import bpy

from .rna import describe

MODES = ("EDIT", "POSE", "OBJECT")
# What names of members begin with, besides the class: all, and those of members that hold several things.
OF_SEVERAL = ("selected_", "editable_", "visible_", "selectable_")
PREFIXES = ("active_", "edit_", *OF_SEVERAL)
# The bones of the context are those of an armature in Edit Mode.
SEVERAL_OF = {"Bone": "EditBone"}
# Of the class Context, what an area gives. Nothing else of it is read: where more was, four of ten runs of Blender 4.2
# ended later, in the poll of some operator.
OF_AREAS = ("area", "space_data", "region", "region_data")
# Flags of what is None: where no object is active, in whatever editor; outside the areas of windows.
WITHOUT_ACTIVE, WITHOUT_AREA = "none-without-active-object", "none-without-area"


def member_names():
    """Names by where they come from (``screen``, ``view3d``, ``buttons``, …)."""
    import _bpy

    if hasattr(_bpy, "context_members"):
        return {place: tuple(names) for place, names in _bpy.context_members().items()}
    rna = set(bpy.types.Context.bl_rna.properties.keys()) | set(bpy.types.Context.bl_rna.functions.keys())
    return {
        "screen": tuple(name for name in dir(bpy.context) if name not in rna and not name.startswith("_"))
    }


def type_of(value):
    """(type, target) of a context member's value; ("", "") when there is nothing to tell from."""
    if isinstance(value, bpy.types.bpy_struct):
        return "pointer", value.bl_rna.identifier
    if isinstance(value, (list, tuple)) or hasattr(value, "foreach_get"):
        first = next(iter(value), None)
        if isinstance(first, bpy.types.bpy_struct):
            return "collection", first.bl_rna.identifier
    elif isinstance(value, (str, bool, int)):
        return type(value).__name__, ""
    return "", ""


def ask(names, found):
    """Reads every name whose type is still unknown in the present situation."""
    for name in names:
        if name not in found:
            try:
                answer = type_of(getattr(bpy.context, name, None))
            except Exception:
                continue
            if answer[0]:
                found[name] = answer


def ask_editors(names, found):
    """Does the same in every kind of area of the window, if there is a window."""
    ask(names, found)
    window = bpy.context.window_manager.windows[0] if bpy.context.window_manager.windows else None
    if window is None or not hasattr(bpy.context, "temp_override"):
        return
    for area in window.screen.areas:
        region = next((item for item in area.regions if item.type == "WINDOW"), None)
        with bpy.context.temp_override(window=window, area=area, region=region):
            ask(names, found)


def make_object(kind):
    """Adds a scratch object and makes it active; False when this Blender refuses."""
    try:
        if kind == "ARMATURE":
            bpy.ops.object.armature_add()
        elif kind == "CURVE":
            bpy.ops.curve.primitive_bezier_curve_add()
        else:
            bpy.ops.mesh.primitive_cube_add()
            bpy.ops.object.particle_system_add()
    except Exception:
        return False
    return True


def probe(names):
    """name → (type, target), from a mesh, a curve and an armature in each mode that they have; names → where None."""
    found, none = {}, {}
    bpy.context.view_layer.objects.active = None
    ask(names, found)
    outside = set(found)
    ask_editors(names, found)
    none |= dict.fromkeys(found.keys() - outside, WITHOUT_AREA)
    in_areas = set(found)
    there = {}  # of those that areas alone gave, what is there outside of them once an object is active
    for kind in ("MESH", "CURVE", "ARMATURE"):
        if not make_object(kind):
            continue
        for mode in MODES:
            try:
                bpy.ops.object.mode_set(mode=mode)
            except Exception:
                continue
            ask(none, there)
            ask_editors(names, found)
    # An editor may go on showing an object that is no longer active: what it gave was not due to the area.
    return found, none | dict.fromkeys({*there, *(found.keys() - in_areas)}, WITHOUT_ACTIVE)


def guess(name):
    """A class whose name the member bears (``node_tree``… ``texture_slot`` → TextureSlot), as Blender names them."""
    stem = name
    for prefix in PREFIXES:
        stem = stem[len(prefix) :] if stem.startswith(prefix) else stem
    stem = stem.replace("editable_", "")
    forms = [(stem, "pointer")]
    if stem.endswith("s"):
        forms.insert(0 if name.startswith(OF_SEVERAL) else 1, (stem[:-1], "collection"))
    for candidate, kind in forms:
        camel = "".join(part.title() for part in candidate.split("_"))
        camel = SEVERAL_OF.get(camel, camel) if kind == "collection" else camel
        if hasattr(bpy.types, camel):
            return kind, camel
    return "", ""


def write_global(write):
    """The properties of the class ``Context`` as members of ``bpy.context``. They are there whatever editor has others
    of their names.
    """
    for prop in bpy.types.Context.bl_rna.properties:
        name = prop.identifier
        if name != "rna_type":
            row = describe(prop)
            row["flags"] = [*row["flags"], f"same-as:bpy.types.Context.{name}"]
            if name in OF_AREAS and getattr(bpy.context, name) is None:
                row["flags"].append(WITHOUT_AREA)
            write("symbol", path=f"bpy.context.{name}", kind="context", owner="bpy.context", **row)


def write_all(write):
    """One record a member, with the editors that provide it."""
    own = set(bpy.types.Context.bl_rna.properties.keys())
    places = {}
    for place, names in member_names().items():
        for name in names:
            if name not in own:
                places.setdefault(name, []).append(place)
    write_global(write)
    found, none = probe(tuple(places))
    for name in sorted(places):
        kind, target = found.get(name) or guess(name)
        flags = ["readonly", *(f"from:{place}" for place in sorted(places[name]))]
        if kind == "pointer" and name in none:
            flags.append(none[name])
        row = {"kind": "context", "type": kind, "target": target}
        write("symbol", path=f"bpy.context.{name}", owner="bpy.context", flags=flags, **row)
        also = [*flags, f"same-as:bpy.context.{name}"]
        write("symbol", path=f"bpy.types.Context.{name}", owner="bpy.types.Context", flags=also, **row)
