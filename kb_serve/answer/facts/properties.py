"""What is told of a property or socket in a word or two each: type, default, range, unit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.symbols.accepted import accepted_text, part_text
from kb_build.symbols.flag_names import (
    ANIMATABLE,
    ENUM_FLAG,
    HIDDEN,
    KEEPS_ITEMS,
    NAMES_PART,
    NEVER_NONE,
    OF_CLASS,
    READ_ONLY,
    SAME_VALUE,
    SETS_ALSO,
    STATIC,
    STOPS,
    UNBOUNDED,
)
from kb_build.symbols.flags import is_locked
from kb_build.symbols.lines import default_text, locked_text, shown_when, subscripts_text, type_text
from kb_serve.answer.facts.ranges import range_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.symbols.records import Symbol

UNITS = {
    "LENGTH": "metres", "ROTATION": "radians", "TIME": "frames", "TIME_ABSOLUTE": "seconds", "MASS": "kg",
    "VELOCITY": "m/s", "ACCELERATION": "m/s²", "AREA": "m²", "VOLUME": "m³", "CAMERA": "mm", "POWER": "W",
    "TEMPERATURE": "K", "WAVELENGTH": "nm", "COLOR_TEMPERATURE": "K", "FREQUENCY": "Hz",
}  # fmt: skip
_NO_NUMBERS = frozenset(
    {"string", "pointer", "collection", "boolean", "enum"}
)  # RNA gives some of them units
_SHOWN_FLAGS = (
    READ_ONLY,
    ANIMATABLE,
    ENUM_FLAG,
    STATIC,
    OF_CLASS,
    HIDDEN,
)


def facts(symbol: Symbol) -> Iterator[str]:
    """The one-line facts of a property or socket."""
    if symbol.type:
        yield f"type: `{type_text(symbol)}`"
    if symbol.kind == "socket" and (text := subscripts_text(symbol)):
        yield text
    # The context's members have RNA's defaults only, and are what is the case.
    if symbol.kind != "context" and (text := default_text(symbol)):
        yield f"default: {text}"
    yield from _range_facts(symbol)
    if symbol.unit and symbol.type not in _NO_NUMBERS:
        yield f"unit: {UNITS.get(symbol.unit, symbol.unit.lower())}"
    if symbol.subtype and symbol.subtype != "UNSIGNED":
        yield f"subtype: {symbol.subtype}"
    if flags := [flag for flag in symbol.flags if flag in _SHOWN_FLAGS and not symbol.is_called_back]:
        yield ", ".join(flags)
    if NEVER_NONE in symbol.flags and symbol.type == "pointer" and not is_locked(symbol):
        yield "cannot be set to `None`"
    yield from filter(None, (locked_text(symbol), accepted_text(symbol)))
    if others := symbol.flagged(SETS_ALSO):
        yield f"assigning it may change {' and '.join(f'`{other}`' for other in others)}, too"
    yield from map(part_text, symbol.flagged(NAMES_PART))
    if KEEPS_ITEMS in symbol.flags:
        yield "given an empty set it keeps what it has"
    for other in symbol.flagged(SAME_VALUE):
        yield f"always the value of `{other}`: setting one sets both"
    if shown := shown_when(symbol):
        yield f"shown when {shown}"


def _range_facts(symbol: Symbol) -> Iterator[str]:
    """What a number may be: its range as RNA has it, and as tried."""
    if symbol.hard_min is not None or symbol.hard_max is not None:
        text = f"range: {range_text(symbol.hard_min, symbol.hard_max, symbol.type)}"
        if (symbol.soft_min, symbol.soft_max) not in {(symbol.hard_min, symbol.hard_max), (None, None)}:
            text += f" (usual: {range_text(symbol.soft_min, symbol.soft_max, symbol.type)})"
        yield text + _not_kept(symbol)
    elif symbol.soft_min is not None or symbol.soft_max is not None:
        usual = f"usual: {range_text(symbol.soft_min, symbol.soft_max, symbol.type)}"
        yield usual if symbol.flagged(STOPS) else f"{usual}, no limit"
    if text := _stops_text(symbol):
        yield text


def _not_kept(symbol: Symbol) -> str:
    """Which end of a range Blender does not keep to, as tried."""
    ends = symbol.flagged(UNBOUNDED)
    sides = {"min": "below", "max": "above"}
    return f", not enforced: a value {' or '.join(sides[end] for end in ends)} stays" if ends else ""


def _stops_text(symbol: Symbol) -> str:
    """What keeps a number from the end of its range, as tried. A number that was found on one thing may be only its."""
    sides, kept = {"min": "below", "max": "above"}, {"min": "less", "max": "more"}
    known: list[str] = []
    where: list[str] = []
    tried: list[str] = []
    for found in symbol.flagged(STOPS):
        side, _, end = found.partition("=")
        if end.isidentifier():
            known.append(f"`{end}` limits it from {sides[side]}")
        else:
            where.append(sides[side])
            tried.append(f"no {kept[side]} than {end}")
    if tried:
        told = f"other settings may limit it from {' and '.join(where)}"
        known.append(f"{told} (a new one: {' and '.join(tried)})")
    return ", ".join(known)
