# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's values as short JSON, and which settings of a struct are not as Blender makes them."""

import math

import bpy

from .rna_defaults import BORN, UNTOLD

LONGEST_TEXT = 120
LONGEST_LIST = 16
LONGEST_DICT = 24
_DEEPEST = 4
_MISSING = object()

_plans = {}


def number(value):
    """A number with the digits that matter, as JSON knows numbers: what is not finite is named ("nan", "inf")."""
    if not math.isfinite(value):
        return str(float(value))
    short = float(f"{value:.5g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def numbers(values):
    """Each of them, as ``number``."""
    return [number(value) for value in values]


def text(value):
    """A string in one line of bounded length."""
    if len(value) > LONGEST_TEXT:
        value = f"{value[: LONGEST_TEXT - 1]}…"
    if value.isprintable():
        return value
    return "".join(one if one.isprintable() else one.encode("unicode_escape").decode() for one in value)


def plain(value, depth=0):
    """Any value of a property as bounded JSON; a data-block is its name."""
    if value is None or isinstance(value, bool):
        return value
    for kind, told in _SHORT.items():
        if isinstance(value, kind):
            return told(value)
    if hasattr(value, "items"):
        return _plain_dict(value, depth)
    if hasattr(value, "__len__") and hasattr(value, "__getitem__"):
        return _plain_list(value, depth)
    name = getattr(value, "name", None)
    return text(name) if isinstance(name, str) else f"<{type(value).__name__}>"


_SHORT = {
    str: text,
    float: number,
    int: lambda value: value if abs(value) < 1 << 63 else str(value)[:40],
    bytes: lambda value: f"bytes[{len(value)}]",
    set: lambda value: sorted(str(one) for one in value)[:LONGEST_LIST],
    bpy.types.ID: lambda block: text(block.name),
}


def _plain_dict(value, depth):
    if depth >= _DEEPEST:
        return f"{{{len(value)} entries}}"
    told = {}
    for key in value.keys():  # noqa: SIM118 - property groups are no mappings
        if len(told) == LONGEST_DICT:
            told["…"] = f"{len(value) - LONGEST_DICT} more"
            break
        told[text(str(key))] = plain(value[key], depth + 1)
    return told


def few(names, most=LONGEST_LIST):
    """The first of many names, and how many more there are."""
    names = [text(name) for name in names]
    return [*names[:most], f"… {len(names) - most} more"] if len(names) > most else names


_KINDS = {"b": "bool", "i": "int", "f": "float", "d": "float"}


def _plain_list(value, depth):
    count = len(value)
    if count > LONGEST_LIST and isinstance(value[0], str) and isinstance(value[-1], str):
        return few([one for one in value if isinstance(one, str)])
    if count > LONGEST_LIST or depth >= _DEEPEST:
        return f"{_KINDS.get(getattr(value, 'typecode', ''), 'list')}[{count}]"
    return [plain(value[index], depth + 1) for index in range(count)]


def custom(thing):
    """The custom properties of a data-block as {name: value}."""
    return {key: value for key, value in thing.items() if key not in {"_RNA_UI", "cycles"}}


def differing(struct, *, leave=(), variant=""):
    """The settings of a struct that are not as Blender makes them: {identifier: value}.

    What cannot be set, what concerns the user interface alone and what is deprecated is not among them, nor is what
    ``leave`` names. ``variant``: which of several ways of making such a struct counts ("LIQUID" of a fluid domain).
    """
    told = {}
    for identifier, default in _plan(struct.bl_rna, variant):
        if identifier in leave:
            continue
        value = getattr(struct, identifier, _MISSING)
        if value is _MISSING or _same(value, default):
            continue
        told[identifier] = plain(value)
    return told


def _same(value, default):
    if isinstance(default, float):
        return abs(value - default) <= 1e-6 * max(1.0, abs(default))
    if isinstance(default, tuple):
        if len(value) != len(default):
            return False
        return all(_same(one, other) for one, other in zip(value, default, strict=True))
    if default is None:
        return value is None
    return value == default


def _plan(rna, variant):
    """[(identifier, default)] of what is compared. The same for all structs of a type, so found out once."""
    key = (rna.identifier, variant)
    plan = _plans.get(key)
    if plan is None:
        plan = _plans[key] = _make_plan(rna, variant)
    return plan


def _make_plan(rna, variant):
    born, untold = {}, set(UNTOLD["*"])
    lineage = [rna]
    while lineage[-1].base is not None:
        lineage.append(lineage[-1].base)
    for ancestor in reversed(lineage):
        born.update(BORN.get(ancestor.identifier, {}))
        untold.update(UNTOLD.get(ancestor.identifier, ()))
    born.update(BORN.get(f"{rna.identifier}:{variant}", {}))
    plan = []
    for prop in rna.properties:
        identifier = prop.identifier
        if (
            identifier in untold
            or prop.is_readonly
            or prop.is_hidden
            or getattr(prop, "is_deprecated", False)
        ):
            continue
        if prop.type == "POINTER":
            if issubclass(_type_of(prop), bpy.types.ID):
                plan.append((identifier, None))
        elif prop.type != "COLLECTION":
            default = born.get(identifier, born.get(f"*{prop.type}", _MISSING))
            plan.append((identifier, _default(prop) if default is _MISSING else default))
    return plan


def _type_of(prop):
    return getattr(bpy.types, prop.fixed_type.identifier, object)


def _default(prop):
    if prop.type in {"BOOLEAN", "INT", "FLOAT"} and prop.is_array:
        flat = tuple(prop.default_array)
        rows, columns = prop.array_dimensions[0], prop.array_dimensions[1]
        if columns:
            return tuple(tuple(flat[row * columns : (row + 1) * columns]) for row in range(rows))
        return flat
    if prop.type == "ENUM" and prop.is_enum_flag:
        return set(prop.default_flag)
    return prop.default
