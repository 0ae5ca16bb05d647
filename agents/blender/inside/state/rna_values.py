# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's values as short JSON, and the settings of a struct that are not at their defaults."""

import math

import bpy

from .rna_defaults import DEFAULTS, LEFT_OUT

LONGEST_TEXT = 120
LONGEST_LIST = 16
LONGEST_DICT = 24
_DEEPEST = 4
_MISSING = object()

_plans = {}


def number(value):
    """A number rounded to five significant digits; one that is not finite is a string ("nan", "inf")."""
    if not math.isfinite(value):
        return str(float(value))
    short = float(f"{value:.5g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


def numbers(values):
    """Each of them, as ``number``."""
    return [number(value) for value in values]


def text(value):
    """A string of limited length in one line."""
    if len(value) > LONGEST_TEXT:
        value = f"{value[: LONGEST_TEXT - 1]}…"
    if value.isprintable():
        return value
    return "".join(
        character if character.isprintable() else character.encode("unicode_escape").decode()
        for character in value
    )


def to_json(value, depth=0):
    """Any value of a property as JSON of limited size; a data-block is its name."""
    if value is None or isinstance(value, bool):
        return value
    for kind, shorten in _SHORT.items():
        if isinstance(value, kind):
            return shorten(value)
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
    set: lambda value: sorted(str(item) for item in value)[:LONGEST_LIST],
    bpy.types.ID: lambda block: text(block.name),
}


def _plain_dict(value, depth):
    if depth >= _DEEPEST:
        return f"{{{len(value)} entries}}"
    entries = {}
    for key in value.keys():  # noqa: SIM118 - property groups are not mappings
        if len(entries) == LONGEST_DICT:
            entries["…"] = f"{len(value) - LONGEST_DICT} more"
            break
        entries[text(str(key))] = to_json(value[key], depth + 1)
    return entries


def shortened(names, most=LONGEST_LIST):
    """The first of many names, and how many more there are."""
    names = [text(name) for name in names]
    return [*names[:most], f"… {len(names) - most} more"] if len(names) > most else names


_KINDS = {"b": "bool", "i": "int", "f": "float", "d": "float"}


def _plain_list(value, depth):
    count = len(value)
    if count > LONGEST_LIST and isinstance(value[0], str) and isinstance(value[-1], str):
        return shortened([item for item in value if isinstance(item, str)])
    if count > LONGEST_LIST or depth >= _DEEPEST:
        return f"{_KINDS.get(getattr(value, 'typecode', ''), 'list')}[{count}]"
    return [to_json(value[index], depth + 1) for index in range(count)]


def custom_properties(block):
    """The custom properties of a data-block as {name: value}."""
    return {key: value for key, value in block.items() if key not in {"_RNA_UI", "cycles"}}


def changed_settings(struct, *, leave=(), variant=""):
    """The settings of a struct that are not at their defaults: {identifier: value}.

    Without read-only, deprecated and user interface settings, and those that ``leave`` names. ``variant``: which of
    several sets of defaults counts ("LIQUID" of a fluid domain).
    """
    settings = {}
    for identifier, default in _plan(struct.bl_rna, variant):
        if identifier in leave:
            continue
        value = getattr(struct, identifier, _MISSING)
        if value is _MISSING or _same(value, default):
            continue
        settings[identifier] = to_json(value)
    return settings


def _same(value, default):
    if isinstance(default, float):
        return abs(value - default) <= 1e-6 * max(1.0, abs(default))
    if isinstance(default, tuple):
        if len(value) != len(default):
            return False
        return all(_same(item, default_item) for item, default_item in zip(value, default, strict=True))
    if default is None:
        return value is None
    return value == default


def _plan(rna, variant):
    """[(identifier, default)] of the settings to compare; cached, as it is the same for all structs of a type."""
    key = (rna.identifier, variant)
    plan = _plans.get(key)
    if plan is None:
        plan = _plans[key] = _make_plan(rna, variant)
    return plan


def _make_plan(rna, variant):
    defaults, left_out = {}, set(LEFT_OUT["*"])
    lineage = [rna]
    while lineage[-1].base is not None:
        lineage.append(lineage[-1].base)
    for ancestor in reversed(lineage):
        defaults.update(DEFAULTS.get(ancestor.identifier, {}))
        left_out.update(LEFT_OUT.get(ancestor.identifier, ()))
    defaults.update(DEFAULTS.get(f"{rna.identifier}:{variant}", {}))
    plan = []
    for prop in rna.properties:
        identifier = prop.identifier
        if (
            identifier in left_out
            or prop.is_readonly
            or prop.is_hidden
            or getattr(prop, "is_deprecated", False)
        ):
            continue
        if prop.type == "POINTER":
            if issubclass(_type_of(prop), bpy.types.ID):
                plan.append((identifier, None))
        elif prop.type != "COLLECTION":
            default = defaults.get(identifier, defaults.get(f"*{prop.type}", _MISSING))
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
