"""A symbol described on one line, and the words for what is known of it."""

from __future__ import annotations

from dataclasses import replace
from itertools import groupby, islice, takewhile
from operator import attrgetter
from typing import TYPE_CHECKING, cast

from kb_build.schema import TEST_OFF, TEST_ON
from kb_build.symbols.accepted import fatal_kinds
from kb_build.symbols.flag_names import (
    ALSO,
    ANY,
    EMPTY,
    ENDS_BEFORE,
    ENDS_EVERY_TIME,
    ENDS_IN_MODULE,
    ENDS_LEFT_OUT,
    ENDS_ON_NONE,
    ENDS_WINDOWLESS,
    ENDS_WITHOUT,
    ENUM_FLAG,
    FILLED_ON,
    FREE_ON,
    GIVEN,
    LOCKED_ON,
    LOCKED_WITH,
    NAME_WHEN_SHOWN,
    NEVER_BY_IDENTIFIER,
    NONE_ON_SOME,
    NOT_ENOUGH,
    NOT_KNOWN,
    REFUSED_ALL,
    SHOWN_WHEN,
    UNSET_BY,
)
from kb_build.symbols.flags import (
    empty_when_new,
    fillers,
    freed_by,
    has_unseen_default,
    is_listed,
    is_locked,
    is_stand_in,
    is_uncompared,
    operator_also,
    operator_areas,
    usual_default,
)
from kb_build.symbols.paths import last_name
from kb_build.symbols.python_values import is_new_list
from kb_build.symbols.records import FACTORY, STARTUP

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import NewValue, Refusal, SettingCondition, Symbol
    from kb_build.symbols.taken import Taken

_ACTIVE = "bpy.context.object"
# Before an operator is said to take nothing (see ``kb_build/blender/inside/preconditions/operator_areas.py``).
TRIED = "objects of every type in every mode, areas of every type, things that calls add and editors show"
IN_MODULE = "Blender is a module of Python (`import bpy`)"
_REGISTERED = "nodes of a class that a script registers: built-in ones refuse it"
_OF_OWN_NODES = frozenset({"bpy.types.NodeInputs", "bpy.types.NodeOutputs"})
GET_EVALUATED = ".evaluated_get(bpy.context.evaluated_depsgraph_get())"
SET = "set of enum items"
_SHOWN_VALUES = 8
_SHOWN_ELEMENTS = 16
_SHOWN_OTHERS = 4
_SHOWN_LABELS = 3
# Names by which scripts hold what is reached from the context.
_HELD = (
    ("bpy.context.object", "obj"),
    ("bpy.context.scene", "scene"),
    ("bpy.context.view_layer", "view_layer"),
)


def literal(value: object, kind: str = "enum") -> str:
    """A value as Python source; long ones are shortened. ``kind`` is the type, of which lists of words are sets."""
    if not isinstance(value, list):
        return repr(value)
    items = cast("list[object]", value)
    shown = ", ".join(
        [literal(item, kind) for item in items[:_SHOWN_ELEMENTS]] + ["…"] * (len(items) > _SHOWN_ELEMENTS)
    )
    if kind == "enum" and all(isinstance(item, str) for item in items):
        return f"{{{shown}}}" if shown else "set()"
    return f"({shown},)" if len(items) == 1 else f"({shown})"


def type_text(symbol: Symbol) -> str:
    """``float[3]``, ``enum``, ``pointer → Mesh``, ``collection of Modifier``, ``list[Object]``."""
    if symbol.type == "collection" and symbol.target:
        is_list = is_new_list(symbol.kind, symbol.type)
        return f"list[{symbol.target}]" if is_list else f"collection of {symbol.target}"
    if symbol.type == "pointer" and symbol.target:
        return f"pointer → {symbol.target}"
    if ENUM_FLAG in symbol.flags:
        return SET
    if symbol.subtype == "BYTE_STRING":
        return "bytes"
    if settings := symbol.type_settings:
        return f"{symbol.type}, or as {' and '.join(settings)} says"
    return symbol.type + "".join(f"[{n or ''}]" for n in symbol.array)  # of any length: none


def first_sentence(text: str) -> str:
    """The first sentence of a description, on one line, without its full stop."""
    line = " ".join(text.split())
    end = line.find(". ")
    sentence = line[:end] if end > 0 else line
    return sentence if sentence.endswith("...") else sentence.rstrip(".")


def held(reached: str) -> str:
    """An expression with the short names that scripts give to the object and the scene."""
    for prefix, name in _HELD:
        if reached == prefix or reached.startswith((f"{prefix}.", f"{prefix}[")):
            return name + reached[len(prefix) :]
    return reached


def locked_text(symbol: Symbol) -> str:
    """Where a property that RNA calls writable cannot be assigned; empty where it always can."""
    locked, free, modes = map(symbol.flagged, (LOCKED_ON, FREE_ON, LOCKED_WITH))
    if freed_by(symbol):
        return f"cannot be assigned before `{freed_by(symbol)}`"
    if is_locked(symbol) and locked:
        return "cannot be assigned: Blender refuses it on all that were tried, though RNA calls it writable"
    if free:
        return f"can be assigned only on {_things(free, _SHOWN_ELEMENTS)}"
    if locked:
        return f"cannot be assigned on {_things(locked, _SHOWN_ELEMENTS)}"
    return f"cannot be assigned with {' or '.join(f'`{mode}`' for mode in modes)}" if modes else ""


def operator_needs(symbol: Symbol) -> str:
    """What an operator's poll wants, of all that was tried; empty where that is not known."""
    given = [f"`{member}` in the context (`temp_override({member}=…)`)" for member in symbol.flagged(GIVEN)]
    needs = symbol.needs.text if symbol.needs else ""
    if not operator_areas(symbol):
        return needs or ", or ".join(given)
    also = operator_also(symbol)
    area = (
        area_text(operator_areas(symbol))
        + (f" and {needs}" if needs else "")
        + (f", with `{'`, then `'.join(also)}`" if also else "")
        + (", which alone is not enough" if ALSO + NOT_ENOUGH in symbol.flags else "")
    )
    return ", or ".join([*given, area])


def poll_line(symbol: Symbol) -> str:
    """What an operator's poll takes, as a sentence, and whether that is known; empty where it refused nothing."""
    if needs := operator_needs(symbol):
        return f"Of all that was tried, its poll takes {needs}."
    if REFUSED_ALL in symbol.flags:
        return f"Its poll took nothing of what was tried ({TRIED})."
    return "What its poll takes is not known." if NOT_KNOWN in symbol.flags else ""


def area_text(types: Sequence[str]) -> str:
    """``an area of type VIEW_3D or IMAGE_EDITOR``."""
    return "an area of any type" if ANY in types else f"an area of type {' or '.join(types)}"


def fatal_lines(symbol: Symbol) -> list[str]:
    """When a call, or an assignment to a property, crashes Blender, and what prevents it, a line each."""
    is_called = symbol.kind != "property"
    index = "".join(f": `{name} = -1` unsets it" for name in symbol.flagged(UNSET_BY))
    return [
        *(f"while `{needed}` is None: set it before" for needed in symbol.flagged(ENDS_WITHOUT)),
        *(
            f"where `{name}` is None, as `get` may give it: test that before"
            if is_called
            else f"where it is set to None{index}"
            for name in symbol.flagged(ENDS_ON_NONE)
        ),
        *([f"where it is given {kinds}"] if (kinds := fatal_kinds(symbol)) else ()),
        *(f"without `{name}`: give it" for name in symbol.flagged(ENDS_LEFT_OUT)),
        *(["where there is no window"] if ENDS_WINDOWLESS in symbol.flags else ()),
        *(["whatever it is given: do not call it"] if ENDS_EVERY_TIME in symbol.flags else ()),
        *([f"where {IN_MODULE}"] if ENDS_IN_MODULE in symbol.flags else ()),
        *(
            "where there is no undo step yet, as in a Blender without a window: make one with "
            f"`{call}`, and only then enter the mode"
            for call in symbol.flagged(ENDS_BEFORE)
        ),
    ]


def refusal_lines(symbol: Symbol) -> list[str]:
    """Which calls of a function were refused although their arguments are those that it asks for, a line each.

    Where both a value and what takes it decide, that is said with the value (see taken_where).
    """
    own = [f"taken only by {_REGISTERED}"] if _is_of_own_nodes(symbol) else []
    return own + [
        _refusal_text(refusal)
        for refusal in symbol.refusals
        if refusal.is_explained and not (refusal.values and refusal.by)
    ]


def taken_where(symbol: Symbol, argument: str) -> dict[str, str]:
    """Value of an argument → what alone takes it, as what follows the word "taken", where some things refuse it."""
    return {
        value: _by(refusal) for refusal in symbol.refusals if refusal.argument == argument and refusal.by
        for value in refusal.values
    }  # fmt: skip


def taken_text(where: Taken) -> str:
    """Where a value is taken, as it is said of it: ``taken only by a shader or geometry node tree``."""
    return where.said(lambda things: _things(things, len(things)))


def said_taken(where: str) -> str:
    """``taken only by a mesh object``, ``not taken by a sound strip``."""
    return f"not taken {where.removeprefix('not ')}" if where.startswith("not ") else f"taken {where}"


def _by(refusal: Refusal) -> str:
    """``only by a MESH object``, or ``not by a sound strip``: whichever names fewer things."""
    few_take = 0 < len(refusal.taken_by) <= len(refusal.by)
    return f"{'only' if few_take else 'not'} by {_things(refusal.taken_by if few_take else refusal.by)}"


def _things(labels: Sequence[str], most: int = _SHOWN_VALUES) -> str:
    """``a poly spline or nurbs spline``, ``a MESH, CURVE or FONT object``: what all end with is said once."""
    shown = list(labels[:most])
    ends = [label.split()[::-1] for label in labels]
    alike = takewhile(lambda column: len(set(column)) == 1, zip(*(end[:-1] for end in ends), strict=False))
    if (common := sum(1 for _ in alike)) and len(shown) > 1:
        shown[:-1] = [" ".join(label.split()[:-common]) for label in shown[:-1]]
    left = len(labels) - len(shown)
    more = f" and {left} more" if left else ""
    return with_article(either(shown)) + more


def either(texts: Iterable[str]) -> str:
    """``'A', 'B' or 'C'``."""
    *others, last = texts
    return f"{', '.join(others)} or {last}" if others else last


def with_article(thing: str) -> str:
    """``a cloth modifier``, ``an action``."""
    return f"{'an' if thing[0].lower() in 'aeiou' else 'a'} {thing}"


def _mode_text(refusal: Refusal) -> str:
    return f"{refusal.mode.capitalize()} Mode"


def _is_of_own_nodes(symbol: Symbol) -> bool:
    return symbol.owner in _OF_OWN_NODES and symbol.kind == "function"


def mode_needed(symbol: Symbol) -> str:
    """``Edit Mode``: where alone a function is taken, whatever it is given; empty for everywhere."""
    if _is_of_own_nodes(symbol):
        return _REGISTERED
    whole = (refusal for refusal in symbol.refusals if refusal.mode and not (refusal.values or refusal.by))
    return "".join(_mode_text(refusal) for refusal in islice(whole, 1))


_AGAIN = {
    "any": "a second time",
    "same": "a second time with the same arguments",
    "other": "after any other",
}


def _refusal_text(refusal: Refusal) -> str:
    """``type='COLOR'|'TEXT'`` without ``length``: “Strips.new_effect: invalid length”."""
    parts: list[str] = []
    if refusal.values:
        parts.append(f"`{refusal.argument}={'|'.join(map(repr, refusal.values))}`")
    if refusal.by:
        parts.append(said_taken(_by(refusal)))
    if refusal.given:
        parts.append("without " + " and ".join(f"`{name}`" for name in refusal.given))
    if refusal.mode:
        parts.append(f"outside of {_mode_text(refusal)}")
    if refusal.again:
        parts.append(_AGAIN[refusal.again])
    said = f"“{refusal.message}”" if refusal.message else "returns `None`"
    return f"{' '.join(parts)}: {'else ' if refusal.by else ''}{said}"


def of_evaluated(expression: str) -> str:
    """An expression over the active object, as one over its evaluated object."""
    if GET_EVALUATED in expression:
        return expression
    return expression.replace(_ACTIVE, f"{_ACTIVE}{GET_EVALUATED}", 1)


def item_of(collection: str) -> str:
    """What a loop over a collection calls each of its elements: ``object_instance``."""
    return collection.removesuffix("s")


def _made_by(symbol: Symbol) -> str:
    """``made by …`` of a pointer that something was seen to fill; empty for others."""
    return "made by " + ", then ".join(f"`{call}`" for call in fillers(symbol)) if fillers(symbol) else ""


def _empty_text(symbol: Symbol, empty: NewValue) -> str:
    """Of a pointer that is None on new things: on which ones, and what fills it."""
    text = f"`None` on a new {_labels(empty.made or (symbol.owner.rpartition('.')[2],))}"
    if others := symbol.flagged(FILLED_ON):
        text += f" (but a new {_labels(others)} has one)"
    return "; ".join(filter(None, (text, _made_by(symbol))))


def default_text(symbol: Symbol) -> str:
    """What new ones have, in which kinds and modes they differ, and RNA's default where it is another."""
    if empty := empty_when_new(symbol):
        return _empty_text(symbol, empty)
    if NONE_ON_SOME in symbol.flags:
        return f"`None` on some kinds of a new {symbol.owner.rpartition('.')[2]}"
    if EMPTY in symbol.flags:
        return f"empty (new {last_name(symbol.owner)})"
    usual = [new for new in symbol.new_values if not new.when]
    modal = _by_setting(new for new in symbol.new_values if new.when)
    value = usual_default(symbol)
    if value is None:
        return ""
    text = f"`{literal(value, symbol.type)}`"
    if is_uncompared(symbol):
        text += " (RNA's; no new one was compared)"
    if usual:
        text += _whose(usual[0], usual[0].made or (symbol.owner.rpartition(".")[2],))
    others = [new for new in usual[1:] if not new.is_startup]
    for rows in (others, modal):
        text += "".join(_other_value(new, symbol) for new in rows[:_SHOWN_OTHERS])
        text += f" and {len(rows) - _SHOWN_OTHERS} more" if len(rows) > _SHOWN_OTHERS else ""
    text += "".join(
        f"; `{literal(new.value, symbol.type)}`{_whose(new, new.made)} ({_at_start(new)})"
        for new in usual[1:]
        if new.is_startup
    )
    if usual and symbol.default not in (None, value) and is_listed(symbol):
        text += f"; RNA says `{literal(symbol.default, symbol.type)}`"
    return text


def _by_setting(values: Iterable[NewValue]) -> list[NewValue]:
    """Values with some settings, one that several choices of a setting give once: with ``mode='A', 'B' or 'C'``."""
    groups: dict[tuple[str, tuple[str, ...], str], list[NewValue]] = {}
    for new in values:
        groups.setdefault((repr(new.value), new.made, new.when.partition("=")[0]), []).append(new)
    merged: list[NewValue] = []
    for (_, _, setting), same in groups.items():
        choices = either(new.when.partition("=")[2] for new in same)
        merged.append(replace(same[0], when=f"{setting}={choices}"))
    return merged


def _other_value(new: NewValue, symbol: Symbol) -> str:
    """A further value: of what it is, or with which setting and, where only some things then have it, of which."""
    value = f"`{literal(new.value, symbol.type)}`"
    if new.when:
        return f"; with `{new.when}`: {value}" + (f" ({_labels(new.made)})" if new.made else "")
    return f", {value}{_whose(new, new.made)}"


def _whose(new: NewValue, made: Sequence[str]) -> str:
    """What has a value: how it was made, or where it is."""
    if new.is_startup:
        return " in the factory preferences" if made[0].startswith(FACTORY) else " in the startup file"
    return f" (made by `{new.by}`)" if new.by else f" (new {_labels(made)})"


def _at_start(new: NewValue) -> str:
    """Which of the things that Blender starts with have a value."""
    return _labels([label.removeprefix(STARTUP).removeprefix(FACTORY) for label in new.made])


def _labels(labels: Sequence[str]) -> str:
    more = len(labels) - _SHOWN_LABELS
    return ", ".join(labels[:_SHOWN_LABELS]) + (f" and {more} more" if more > 0 else "")


def version_meant(text: str) -> str:
    """A version that RNA names, as people write it: where Blender's sources have 510 for 5.1, RNA makes 5.10 of it."""
    major, _, minor = text.partition(".")
    return f"{major}.{minor[0]}" if minor[1:] == "0" else text


def written(symbol: Symbol) -> str:
    """A symbol's path as a script can write it: of a socket that its identifier never gives, by its place."""
    is_never_so = (
        NEVER_BY_IDENTIFIER in symbol.flags and f'{symbol.side}["{symbol.identifier}"]' in symbol.path
    )
    return f"{symbol.owner}.{symbol.subscripts[0]}" if is_never_so and symbol.subscripts else symbol.path


def subscripts_text(socket: Symbol, most: int | None = None) -> str:
    """How a socket is reached on its node: subscripts that were tried, and the identifier where it is another name.

    Not more than ``most`` of those that always work.
    """
    shown = [f"`{text}`" for text in socket.subscripts[:most]]
    if NAME_WHEN_SHOWN in socket.flags:
        shown.append(f'`{socket.side}["{socket.label}"]` while it is shown')  # behind what always works
    identifier = socket.identifier
    if identifier not in ("", socket.label):
        shown.append(f"identifier `{identifier}`")
    return ", ".join(shown)


def is_contrary(condition: SettingCondition, gate: Symbol, value: object) -> bool:
    """Whether a value of the setting that a condition asks, its gate, surely is not what it asks for."""
    test = condition.test
    if isinstance(value, bool) and test in {TEST_ON, TEST_OFF}:
        return value != (test == TEST_ON)
    is_choice = gate.type == "enum" and isinstance(value, str) and "'" in test
    return is_choice and (repr(value) in test) != test.startswith("'")  # else it names what must not be


def switches(conditions: Iterable[SettingCondition]) -> Iterator[list[str]]:
    """Of one property's conditions, by clause, the settings of which one must be on to set it, or for an effect."""
    for _, rows in groupby(conditions, key=attrgetter("clause")):
        clause = [*rows]
        if all(row.test == TEST_ON and row.otherwise != "hidden" for row in clause):
            yield [row.gate for row in clause]


def _head(symbol: Symbol) -> str:
    name = symbol.path[len(symbol.owner) + 1 :] if symbol.owner else symbol.path
    if symbol.kind in {"function", "operator"}:
        call = symbol.signature
        return f"`{name}{call[call.index('(') :] if '(' in call else '()'}`"
    if symbol.kind == "socket" and (text := subscripts_text(symbol, most=1)):
        return text
    return f"`{name}`"


def _values(symbol: Symbol) -> list[str]:
    return [] if is_stand_in(symbol) else [item.identifier for item in symbol.enum_items if item.is_taken]


def leaves_out_values(symbol: Symbol) -> bool:
    """Whether a symbol's line does not tell all values that can be given to it."""
    if symbol.kind == "property":
        return len(_values(symbol)) > _SHOWN_VALUES and not is_locked(symbol)
    return symbol.kind in {"function", "operator"} and bool(symbol.parameters)


def member_line(symbol: Symbol, switch: str = "") -> str:
    """Name, type, default, first values and first sentence of a member, as its owner lists it.

    ``switch`` is the setting of the same owner that must be on before Blender's panels let it be set.
    """
    notes = [type_text(symbol)] if symbol.type else []
    default = usual_default(symbol)
    if default is not None and symbol.kind in {"property", "socket"}:
        notes.append(
            f"= {literal(default, symbol.type)}" + (" (RNA's)" if has_unseen_default(symbol) else "")
        )
        modal = _by_setting(new for new in symbol.new_values if new.when and not new.made)
        notes += [f"({literal(new.value, symbol.type)} with {new.when})" for new in modal[:_SHOWN_LABELS]]
    if (empty := empty_when_new(symbol)) and not empty.made:
        notes += ["= None", *([f"({made})"] if (made := _made_by(symbol)) else [])]
    if EMPTY in symbol.flags:
        notes.append("= []")
    if values := _values(symbol):
        # In brackets: a default stands before them.
        notes.append(f"({'|'.join(values[:_SHOWN_VALUES])}{'|…' if len(values) > _SHOWN_VALUES else ''})")
    if is_locked(symbol):
        notes.append("read-only")
    if setting := freed_by(symbol):
        notes.append(f"(after {setting})")
    if switch:
        notes.append(f"(if {switch})")
    if symbol.deprecation:
        notes.append("deprecated")
    if shown := shown_when(symbol):
        notes.append(f"when {shown}")
    said = first_sentence(symbol.description) or (symbol.label if symbol.label != symbol.name else "")
    # Of a socket the ways to it stand first, the last of which would run into the type.
    head = _head(symbol) + (" ·" if symbol.kind == "socket" and notes else "")
    return " ".join([head, *notes]) + (f" — {said}" if said else "")


def shown_when(symbol: Symbol) -> str:
    """In which modes of its node a socket is shown; empty for always."""
    return " and ".join(symbol.modes) or "".join(symbol.flagged(SHOWN_WHEN))
