# SPDX-License-Identifier: GPL-3.0-or-later
"""RNA classes with their own properties and functions, and the methods that Python or C adds to them."""

import functools
import types

import bpy

from ..wire import limit, plain
from .own_groups import GROUP, settable

UI_BASES = (
    "Panel", "Menu", "Header", "UIList", "AssetShelf", "KeyingSetInfo", "Gizmo", "GizmoGroup", "FileHandler",
    "RenderEngine", "HydraRenderEngine",
)  # fmt: skip
READ_ONLY = "readonly"
# ``is_overridable`` is left out: reading it on Image.pixels crashes Blender.
FLAGS = (
    ("is_readonly", READ_ONLY), ("is_animatable", "animatable"), ("is_library_editable", "library-editable"),
    ("is_never_none", "never-none"), ("is_enum_flag", "enum-flag"),
    ("is_hidden", "hidden"), ("is_runtime", "runtime"), ("is_required", "required"),
    ("is_path_supports_blend_relative", "blend-relative"),
)  # fmt: skip
METHOD_TYPES = (
    types.FunctionType, types.BuiltinFunctionType, types.MethodDescriptorType, types.ClassMethodDescriptorType,
    classmethod, staticmethod,
    *{type(value) for value in vars(bpy.types.Gizmo).values() if type(value).__name__ == "instancemethod"},
)  # fmt: skip
LAYOUT = "UILayout"  # of which RNA's defaults are no layout's
SET_OF_ITEMS = "set[enum]"
LONGEST = 64  # for RNA an array that a function takes in any length may be declared so
# The flags of functions that classes of scripts define and Blender calls, and of those that it insists on.
DEFINED, DEFINED_ALWAYS = "defined", "defined-always"
ATTRIBUTE_TYPES = (property, types.GetSetDescriptorType, types.MemberDescriptorType)


def version_text(version):
    """``(5, 0, 0)`` → ``"5.0"``; nothing for the zero that Blender keeps where it knows no version."""
    return f"{version[0]}.{version[1]}" if version and any(version) else ""


@functools.cache
def declared(rna):
    """name → (address, the class whose own it is) of each property of a class; of two of one name that of the first,
    which Blender finds by it.
    """
    inherited, found = declared(rna.base) if rna.base is not None else {}, {}
    for prop in rna.properties:
        name, pointer = prop.identifier, prop.as_pointer()
        if name not in found:
            known = inherited.get(name)
            found[name] = known if known and known[0] == pointer else (pointer, rna.identifier)
    return found


def declaring_class(rna, name):
    """The class whose own property it is, seen from one of its descendants."""
    if name not in declared(rna):
        declared.cache_clear()  # it was registered since
    return declared(rna)[name][1]


def path_of(rna, name):
    """The full path of a class's property, where it is declared."""
    return f"bpy.types.{declaring_class(rna, name)}.{name}"


def ancestry(rna):
    """The identifiers of a class and of those that it inherits from."""
    names = []
    while rna is not None:
        names.append(rna.identifier)
        rna = rna.base
    return names


def read_items(items):
    """Enum items as rows. Each is read while the iteration stands on it: computed ones are freed after it."""
    return [
        {"identifier": item.identifier, "name": item.name, "description": item.description}
        for item in items
        if item.identifier
    ]


def enum_items(prop):
    """(items, computed): the static items, or the ones Blender computes for a bare context."""
    rows = read_items(prop.enum_items_static)
    return (rows, False) if rows else (read_items(prop.enum_items), True)


def in_rows(values, columns):
    """The values of a matrix as an instance has them; those of another array as they are: it has no ``columns``."""
    if not columns:
        return values
    return [values[start : start + columns] for start in range(0, len(values), columns)]


def default_of(prop):
    """The value a new property has, or None where RNA has no such notion (pointers, collections)."""
    kind = prop.type
    if kind in {"POINTER", "COLLECTION"}:
        return None
    if kind == "ENUM":
        return sorted(prop.default_flag) if prop.is_enum_flag else prop.default
    if kind in {"BOOLEAN", "INT", "FLOAT"} and prop.is_array:
        return in_rows([plain(item) for item in prop.default_array], prop.array_dimensions[1])
    return plain(prop.default)


def describe(prop):
    """Everything RNA knows of one property, in the terms of ``records.Symbol``."""
    kind = prop.type
    row = {
        "label": prop.name,
        "description": prop.description,
        "type": kind.lower(),
        "subtype": prop.subtype if prop.subtype != "NONE" else "",
        "unit": prop.unit if prop.unit != "NONE" else "",
        "flags": [text for attribute, text in FLAGS if getattr(prop, attribute, False)],
        "default": default_of(prop),
    }
    if kind in {"INT", "FLOAT"}:
        for bound in ("hard_min", "hard_max", "soft_min", "soft_max"):
            row[bound] = limit(getattr(prop, bound))
    if getattr(prop, "is_array", False):
        row["array"] = [n for n in prop.array_dimensions if n] or [prop.array_length]
    if kind == "ENUM":
        row["enum_items"], row["enum_computed"] = enum_items(prop)
    if kind in {"POINTER", "COLLECTION"} and prop.fixed_type:
        row["target"] = prop.fixed_type.identifier
    if kind == "COLLECTION" and prop.srna:
        row["collection"] = prop.srna.identifier
    if getattr(prop, "is_deprecated", False):
        row["deprecation"] = {
            "note": prop.deprecated_note,
            "since": version_text(prop.deprecated_version),
            "removal": version_text(prop.deprecated_removal_version),
        }
    return row


def parameter(prop):
    """One argument or result of an RNA function, in the terms of ``records.Parameter``."""
    row = describe(prop)
    if row.get("array") == [LONGEST]:
        row["array"] = [1]
    kept = ("description", "default", "enum_items", "label", "hard_min", "hard_max", "unit")
    result = {key: row[key] for key in kept if row.get(key) not in (None, "", [])}
    length = "".join(f"[{n}]" for n in row.get("array", ()))
    result.update(name=prop.identifier, type=row.get("target") or row["type"] + length)
    if prop.type == "COLLECTION":
        result["type"] = f"list of {row.get('target', 'items')}"
    if prop.type == "STRING" and not prop.is_never_none and not prop.is_output:
        result["type"] += " or None"
    if prop.type == "ENUM" and prop.is_enum_flag:
        result["default"] = row["default"]
        if prop.is_required or prop.is_output:
            result["type"] = SET_OF_ITEMS
    if row.get("array") == [1]:  # of any length: left out, it is none or all
        result.pop("default", None)
    if prop.is_required and not prop.is_output:
        result["required"] = True
    if prop.is_required or prop.is_output:
        result.pop("default", None)
    return result


def addon_preferences():
    """The preferences of add-ons by class name: they are in no ``bpy.types``, and pointers know only their base."""
    return {cls.__name__: cls for cls in bpy.types.AddonPreferences.__subclasses__() if cls.is_registered}


def all_structs():
    """Every RNA class by identifier: those of ``bpy.types``, and those that hang only on pointers."""
    structs = {}
    queue = []
    for name in dir(bpy.types):
        rna = getattr(getattr(bpy.types, name), "bl_rna", None)
        if rna is not None:
            queue.append(rna)
    queue.extend(cls.bl_rna for cls in addon_preferences().values())
    while queue:
        rna = queue.pop()
        if rna.identifier in structs:
            continue
        structs[rna.identifier] = rna
        if rna.base is not None:
            queue.append(rna.base)
        for prop in rna.properties:
            if prop.type in {"POINTER", "COLLECTION"}:
                queue.extend(target for target in (prop.fixed_type, prop.srna) if target is not None)
    return structs


def group_of(rna):
    """``data``, ``ui`` or ``operator``: whether a script works with the class or only the interface does."""
    if rna.identifier in UI_BASES:
        return "data"
    ancestor = rna.base
    while ancestor is not None:
        if ancestor.identifier in UI_BASES:
            return "ui"
        if ancestor.identifier in {"Operator", "Macro"}:
            return "operator"
        ancestor = ancestor.base
    return "operator" if "_OT_" in rna.identifier else "data"


@functools.cache
def own(rna, kind):
    """The properties or functions that a class adds to its base, those that replace one of it included."""
    inherited = {item.as_pointer() for item in getattr(rna.base, kind)} if rna.base is not None else set()
    return [
        item
        for item in getattr(rna, kind)
        if item.as_pointer() not in inherited and item.identifier != "rna_type"
    ]


def same_as(rna, name):
    """The flag of a function that a base has too: where that one is."""
    base = rna.base
    while base is not None:
        if any(item.identifier == name for item in own(base, "functions")):
            return [f"same-as:bpy.types.{base.identifier}.{name}"]
        base = base.base
    return []


def write_function(write, owner, function, flags):
    """One RNA function with its arguments and results."""
    parameters = list(function.parameters)
    write(
        "symbol",
        path=f"{owner}.{function.identifier}",
        kind="function",
        owner=owner,
        description=function.description,
        parameters=[parameter(item) for item in parameters if not item.is_output],
        returns=[result_of(function, item) for item in parameters if item.is_output],
        flags=flags + kind_of(function),
    )


def result_of(function, prop):
    """One result of a function; of one that scripts define it has to be given, but nothing stands for False."""
    row = parameter(prop)
    return {**row, "required": True} if function.is_registered and prop.type != "BOOLEAN" else row


def kind_of(function):
    """The flags that tell what calls a function, and on what."""
    if not function.is_registered:
        is_of_class = getattr(function, "use_self_type", False)
        return [] if function.use_self else ["classmethod" if is_of_class else "static"]
    defined = DEFINED if function.is_registered_optional else DEFINED_ALWAYS
    return [defined] if function.use_self else [defined, "classmethod"]


def write_struct(write, identifier, rna):
    """One class, its own properties and its own functions."""
    path = f"bpy.types.{identifier}"
    addon = addon_preferences().get(identifier)
    write(
        "symbol",
        path=path,
        kind="class",
        owner="bpy.types",
        label=rna.name,
        description=rna.description,
        base=f"bpy.types.{rna.base.identifier}" if rna.base is not None else "bpy.types.bpy_struct",
        group=group_of(rna),
        reached=f'bpy.context.preferences.addons["{addon.bl_idname}"].preferences' if addon else "",
    )
    key = rna.name_property.identifier if rna.name_property else ""
    called_back = {function.identifier for function in own(rna, "functions") if function.is_registered}
    for prop in own(rna, "properties"):
        if prop.identifier in called_back:  # which the function of the script's class takes the place of
            continue
        row = describe(prop)
        if identifier == LAYOUT:
            row["default"] = None
        if identifier == GROUP and prop.identifier in settable():
            row["flags"] = [flag for flag in row["flags"] if flag != READ_ONLY]
        if prop.identifier == key and key != "name":
            row["flags"].append("names-items")
        write("symbol", path=f"{path}.{prop.identifier}", kind="property", owner=path, **row)
    for function in own(rna, "functions"):
        write_function(write, path, function, same_as(rna, function.identifier))


def is_described(identifier):
    """Whether the reference has the class: it has the interface's lists and handlers, not its panels."""
    return not any(infix in identifier for infix in ("_OT_", "_MT_", "_PT_", "_HT_", "_KSI_"))


def repeats(value):
    """Whether the reference lists an inherited member of this kind again on each class."""
    if isinstance(value, (property, types.FunctionType, types.ClassMethodDescriptorType)):
        return True
    function = getattr(value, "__func__", None)
    if isinstance(value, classmethod):
        return isinstance(function, types.BuiltinFunctionType)
    return isinstance(function, (types.FunctionType, types.BuiltinFunctionType))


def added_members(cls, rna):
    """(name, value, class that it is inherited from or "") of what Python or C adds to an RNA class.

    Mix-ins count as the class' own. Properties registered by add-ons are RNA already; what begins with an
    underscore is left out, and so are RNA's own names, unless a Python function takes their place.
    """
    seen = {item.identifier for kind in ("properties", "functions") for item in own(rna, kind)}
    seen |= {"bl_rna", "rna_type"}
    inherited = set(rna.properties.keys()) | set(rna.functions.keys())
    base = None
    for ancestor in cls.__mro__:
        if ancestor is object or ancestor is bpy.types.bpy_struct:
            continue
        if ancestor is not cls and "bl_rna" in vars(ancestor):
            base = ancestor
        source = base.bl_rna.identifier if base is not None and issubclass(base, ancestor) else ""
        for name, value in vars(ancestor).items():
            if name.startswith("_") or name in seen or not isinstance(value, METHOD_TYPES + ATTRIBUTE_TYPES):
                continue
            seen.add(name)
            if name in inherited and (source or not isinstance(value, types.FunctionType)):
                continue
            if not source or repeats(value):
                yield name, value, source


def subclass_lookups():
    """The class methods of ``bpy_struct``, which the reference lists on every class."""
    for name, value in vars(bpy.types.bpy_struct).items():
        if isinstance(value, types.ClassMethodDescriptorType):
            yield name, value, "bpy_struct"


def write_added(write, structs, write_member):
    """Methods and attributes that RNA does not list, for the classes that the reference has."""
    for identifier, rna in structs.items():
        cls = getattr(bpy.types, identifier, None) or addon_preferences().get(identifier)
        group = group_of(rna)
        if cls is None or group == "operator" or (group == "ui" and not is_described(identifier)):
            continue
        members = list(added_members(cls, rna))
        for name, value, source in [*members, *(subclass_lookups() if group == "ui" else ())]:
            flags = [f"same-as:bpy.types.{source}.{name}"] if source else []
            write_member(write, f"bpy.types.{identifier}", name, value, flags)


def write_all(write, write_member):
    """Every RNA class. Returns the classes by identifier."""
    structs = all_structs()
    for identifier in sorted(structs):
        write_struct(write, identifier, structs[identifier])
    write_added(write, structs, write_member)
    return structs
