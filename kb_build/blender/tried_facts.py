"""What was tried in Blender beyond RNA, as additions to the rows of symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kb_build.blender.call_texts import LEFT_OUT
from kb_build.blender.enum_contexts import items_in_contexts
from kb_build.blender.refused_calls import refusals
from kb_build.symbols.accepted import OUTCOMES, TAKES
from kb_build.symbols.flag_names import (
    ACCEPTS,
    ALSO,
    ANY,
    AREAS,
    BARE_DATA,
    CALLS,
    COMPARED,
    EMPTY,
    EMPTY_AT_START,
    ENDS_BEFORE,
    ENDS_EVERY_TIME,
    ENDS_IN_MODULE,
    ENDS_LEFT_OUT,
    ENDS_ON_NONE,
    ENDS_WINDOWLESS,
    ENDS_WITHOUT,
    EVALUATED,
    FILLED_AT_START,
    FILLED_BY,
    FILLED_ON,
    FREE_ON,
    FREED_BY,
    GIVEN,
    GIVES_NONE,
    INVERTED,
    ITERATED,
    KEEPS_ITEMS,
    LOCKED_ON,
    LOCKED_WITH,
    MUST_HAVE,
    NAMES_PART,
    NONE_ON_SOME,
    NOT_KNOWN,
    REFUSED_ALL,
    RETURNS_NONE,
    SETS_ALSO,
    STOPS,
    UNBOUNDED,
    UNSET_BY,
    WINDOWLESS,
)
from kb_build.symbols.taken import AT_TIMES, NEVER

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

_Row = dict[str, Any]
_TREE = "NodeTree"  # any kind of it


def add_fact(record: str, row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds to the row of a symbol what a record of one of the kinds RECORDS found of it."""
    if add := _ADDED.get(record):
        add(row, seen)
    else:
        _flag(row, _FLAGS[record](seen))


def add_items(row: _Row, asked: Mapping[str, Any], neighbours: Mapping[str, Any] | None) -> None:
    """Adds the items that instances listed, with where each is taken."""
    listed, texts = row.get("enum_items", ()), asked.get("texts", {})
    row["enum_items"] = items_in_contexts(listed, asked["contexts"], texts, neighbours)


def _add_source_items(row: _Row, found: Mapping[str, Any]) -> None:
    """Adds the items that others have to those that were taken here: there are no more."""
    taken = [item for item in row.get("enum_items", ()) if item.get("where") != NEVER]
    known = {item["identifier"] for item in taken}
    others = ({**item, "where": AT_TIMES} for item in found["items"] if item["identifier"] not in known)
    row["enum_items"] = [*taken, *others]
    row["enum_computed"] = False


def _add_never_reached(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds which values nothing that was tried came to have."""
    for item in row.get("enum_items", ()):
        if item["identifier"] in seen["items"]:
            item["where"] = NEVER


def _add_values(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what new instances have where it is not RNA's default, and that they were compared.

    What whoever makes a thing chooses, or Blender computes, has no default.
    """
    if seen.get("chosen"):
        row.pop("default", None)
    else:
        _flag(row, (COMPARED,))
        row["new_values"] = [*seen.get("values", ()), *seen.get("modes", ())]


def _add_choices(row: _Row, asked: Mapping[str, Any]) -> None:
    """Adds the choices of a parameter for which RNA has a stand-in."""
    for parameter in _parameters(row, asked["parameter"]):
        if asked["items"]:
            parameter["enum_items"] = asked["items"]


def _add_refused_default(row: _Row, asked: Mapping[str, Any]) -> None:
    """Adds that an operator's argument never takes what RNA has for it.

    Where RNA lists nothing else, it stands for values that Blender puts together later: those that it named are kept.
    """
    for parameter in _parameters(row, asked["argument"]):
        items, values = parameter.get("enum_items", ()), asked.get("values")
        others = [item for item in items if item["identifier"] != parameter["default"]]
        if others and not values:
            continue  # it may be taken where there are any
        del parameter["default"]
        if others:
            parameter["enum_items"] = others
            continue
        for item in items:
            item["where"] = NEVER
        if values:
            parameter["values_asked"] = values


def _add_pointer(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds whether a pointer of new instances is None, and what fills it."""
    flags = [COMPARED]
    if seen.get("is_empty"):
        row["new_values"] = [{"value": None, "made": seen.get("empty", [])}]
        flags += [f"{FILLED_ON}{label}" for label in seen.get("filled", ())]
        if seen.get("filler"):
            flags.append(FILLED_BY + seen["filler"])
    elif seen.get("partly"):
        flags.append(NONE_ON_SOME)
    _flag(row, flags)


def _add_needs(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what an operator's poll wants."""
    row["needs"] = seen.get("needs", {})


def _add_areas(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds in which areas an operator runs, what it wants there, and what it takes of the context instead."""
    _flag(row, (AREAS + area for area in seen.get("areas", ())))
    _flag(row, (GIVEN + seen["given"],) if seen.get("given") else ())
    _flag(row, (ALSO + statement for statement in seen.get("also", ())))
    if needs := seen.get("needs"):  # nothing beside the area is not nothing at all
        row["needs"] = needs


def _add_argument_items(row: _Row, asked: Mapping[str, Any]) -> None:
    """Adds the items that a function's argument takes; a default that is none of them is no value to give."""
    for parameter in _parameters(row, asked["argument"]):
        items = items_in_contexts(parameter.get("enum_items", ()), asked["contexts"], {})
        parameter["enum_items"] = items
        if parameter.get("default") not in {item["identifier"] for item in items}:
            parameter.pop("default", None)


def _add_refusals(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what a function refused."""
    row["refusals"] = refusals(seen["outcomes"])


def _add_accepted(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what becomes of the things that a pointer was given, by their kind. What takes one kind of tree has that."""
    _flag(row, (f"{ACCEPTS}{outcome}:{kind}" for outcome in OUTCOMES for kind in seen.get(outcome, ())))
    taken = seen.get(TAKES, ())
    if row.get("target") == _TREE and len(taken) == 1:
        row["target"] = taken[0]


def _add_left_out(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what an argument is where it is left out, in place of RNA's default. A factor has no unit."""
    for parameter in _parameters(row, seen["argument"]):
        for wrong in ("default", *(("unit",) if seen["argument"] == "scale" else ())):
            parameter.pop(wrong, None)
        _append_sentence(parameter, f"{LEFT_OUT}{seen['value']}")


def _add_limits(row: _Row, seen: Mapping[str, Any]) -> None:
    """Adds what Blender keeps otherwise than RNA tells: ends of ranges, items taken as others or not at all, lengths
    that vary, names of nothing else than a part of the object.
    """
    if seen.get("varies"):
        row["array"] = [0]
        row.pop("default", None)
    _flag(row, (UNBOUNDED + end for end in seen.get("ends", ())))
    _flag(row, (NAMES_PART + seen["names"],) if seen.get("names") else ())
    _flag(row, (f"{STOPS}{side}={value}" for side, value in seen.get("stops", {}).items()))
    for item in row.get("enum_items", ()):
        if kept := seen.get("read_as", {}).get(item["identifier"]):
            _append_sentence(item, f"Reads back as {kept!r}")
        elif item["identifier"] in seen.get("left_out", ()):
            _append_sentence(item, "Assigned, it changes nothing")


def _add_texts(row: _Row, asked: Mapping[str, Any]) -> None:
    """Adds the texts that an argument takes: what the documentation says of it is added later."""
    items = [{"identifier": item} for item in asked["items"]]
    row.setdefault("parameters", []).append({"name": asked["argument"], "enum_items": items})


def _flag(row: _Row, flags: Iterable[str]) -> None:
    row["flags"] = [*row.get("flags", ()), *flags]


def _parameters(row: _Row, name: str) -> Iterator[dict[str, Any]]:
    return (parameter for parameter in row.get("parameters", ()) if parameter["name"] == name)


def _append_sentence(described: dict[str, Any], sentence: str) -> None:
    said = described.get("description", "").rstrip(".")
    described["description"] = f"{said}. {sentence}".removeprefix(". ")


def _crashes(seen: Mapping[str, Any]) -> Iterator[str]:
    """With what a function or an assignment ends Blender."""
    if seen.get("without"):
        yield ENDS_WITHOUT + seen["without"]
    yield from (ENDS_ON_NONE + name for name in seen.get("none", ()))
    yield from (ENDS_LEFT_OUT + name for name in seen.get("left_out", ()))
    if seen.get("always"):
        yield ENDS_WINDOWLESS
    if seen.get("every"):
        yield ENDS_EVERY_TIME
    if seen.get("in_module"):
        yield ENDS_IN_MODULE
    if seen.get("instead"):
        yield UNSET_BY + seen["instead"]


def _locked(seen: Mapping[str, Any]) -> Iterator[str]:
    """Where Blender does not let a property be assigned: on what, or in which modes, and what frees it."""
    if seen.get("is_always"):
        yield LOCKED_ON + ANY
    yield from (LOCKED_ON + label for label in seen.get("on", ()))
    yield from (FREE_ON + label for label in seen.get("free_on", ()))
    yield from (LOCKED_WITH + mode for mode in seen.get("modes", ()))
    if seen.get("freed_by"):
        yield FREED_BY + seen["freed_by"]


def _written_through(seen: Mapping[str, Any]) -> Iterator[str]:
    """What else a set of items changes, and whether it takes none."""
    yield from (SETS_ALSO + name for name in seen.get("names", ()))
    if seen.get("keeps"):
        yield KEEPS_ITEMS


# Kind of record → what adds it to the row of its symbol.
_ADDED: dict[str, Callable[[_Row, Mapping[str, Any]], None]] = {
    "accepted": _add_accepted,
    "argument_items": _add_argument_items,
    "choices": _add_choices,
    "left_out": _add_left_out,
    "limits": _add_limits,
    "never_reached": _add_never_reached,
    "new_pointer": _add_pointer,
    "new_values": _add_values,
    "operator_areas": _add_areas,
    "operator_needs": _add_needs,
    "refusals": _add_refusals,
    "refused_default": _add_refused_default,
    "source_items": _add_source_items,
    "texts_taken": _add_texts,
}
# Kind of record → the flags that it is worth.
_FLAGS: dict[str, Callable[[Mapping[str, Any]], Iterable[str]]] = {
    "bare_data": lambda _: (BARE_DATA,),
    "crashes": _crashes,
    "empty_collection": lambda _: (EMPTY,),
    "evaluated": lambda _: (EVALUATED,),
    "gives_none": lambda _: (GIVES_NONE,),
    "inverted": lambda _: (INVERTED,),
    "locked": _locked,
    "operator_calls": lambda seen: (CALLS + path for path in seen["calls"]),
    "operator_refused": lambda seen: (NOT_KNOWN if seen.get("is_unknown") else REFUSED_ALL,),
    "own_class": lambda seen: (MUST_HAVE + name for name in seen["names"]),
    "returns_none": lambda _: (RETURNS_NONE,),
    "start_empty": lambda _: (EMPTY_AT_START,),
    "iterated": lambda _: (ITERATED,),
    "start_filled": lambda _: (FILLED_AT_START,),
    "undo_step": lambda seen: (ENDS_BEFORE + seen["before"],),
    "windowless": lambda seen: (WINDOWLESS + seen["said"],),
    "written_through": _written_through,
}
RECORDS = _ADDED.keys() | _FLAGS.keys()
