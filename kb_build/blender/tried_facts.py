"""What was tried in Blender beyond RNA, as additions to the rows of symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kb_build.blender.call_texts import LEFT_OUT
from kb_build.blender.enum_contexts import items_in_contexts
from kb_build.blender.refused_calls import refusals
from kb_build.symbols.records import (
    ALSO,
    ANY,
    AREAS,
    BARE_DATA,
    CALLS,
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
    KEEPS_ITEMS,
    LOCKED_ON,
    LOCKED_WITH,
    MUST_HAVE,
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
    from collections.abc import Mapping


def add_items(
    row: dict[str, Any] | None, asked: dict[str, Any], neighbours: Mapping[str, Any] | None
) -> None:
    """Adds the items that instances listed, with where each is taken."""
    if row is not None:
        listed, texts = row.get("enum_items", ()), asked.get("texts", {})
        row["enum_items"] = items_in_contexts(listed, asked["contexts"], texts, neighbours)


def _add_source_items(row: dict[str, Any] | None, found: dict[str, Any]) -> None:
    """Adds the items that others have to those that were taken here: there are no more."""
    if row is not None:
        taken = [item for item in row.get("enum_items", ()) if item.get("where") != NEVER]
        known = {item["identifier"] for item in taken}
        others = ({**item, "where": AT_TIMES} for item in found["items"] if item["identifier"] not in known)
        row["enum_items"] = [*taken, *others]
        row["enum_computed"] = False


def _add_never_reached(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds which values nothing that was tried came to have."""
    for item in (row or {}).get("enum_items", ()):
        if item["identifier"] in seen["items"]:
            item["where"] = NEVER


def _add_values(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what new instances have where it is not RNA's default, and that they were compared.

    What whoever makes a thing chooses, or Blender computes, has no default.
    """
    if row is not None and seen.get("chosen"):
        row.pop("default", None)
    elif row is not None:
        row["flags"] = [*row.get("flags", ()), "compared"]
        row["new_values"] = [*seen.get("values", ()), *seen.get("modes", ())]


def _add_choices(row: dict[str, Any] | None, asked: dict[str, Any]) -> None:
    """Adds the choices of a parameter for which RNA has a stand-in."""
    for parameter in row.get("parameters", ()) if row is not None and asked["items"] else ():
        if parameter["name"] == asked["parameter"]:
            parameter["enum_items"] = asked["items"]


def _add_refused_default(row: dict[str, Any] | None, asked: dict[str, Any]) -> None:
    """Adds that an operator's argument never takes what RNA has for it.

    Where RNA lists nothing else, it stands for values that Blender puts together later: those that it named are kept.
    """
    for parameter in (row or {}).get("parameters", ()):
        if parameter["name"] != asked["argument"]:
            continue
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


def _add_pointer(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds whether a pointer of new instances is None, and what fills it."""
    if row is None:
        return
    flags = ["compared"]
    if seen.get("is_empty"):
        row["new_values"] = [{"value": None, "made": seen.get("empty", [])}]
        flags += [f"{FILLED_ON}{label}" for label in seen.get("filled", ())]
        if seen.get("filler"):
            flags.append(FILLED_BY + seen["filler"])
    elif seen.get("partly"):
        flags.append(NONE_ON_SOME)
    row["flags"] = [*row.get("flags", ()), *flags]


def _add_needs(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what an operator's poll wants."""
    if row is not None:
        row["needs"] = seen.get("needs", {})


def _add_areas(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds in which areas an operator runs, what it wants there, and what it takes of the context instead."""
    if row is not None:
        row["flags"] = [
            *row.get("flags", ()),
            *(AREAS + area for area in seen.get("areas", ())),
            *([GIVEN + seen["given"]] if seen.get("given") else ()),
            *(ALSO + statement for statement in seen.get("also", ())),
        ]
        if needs := seen.get("needs"):  # nothing beside the area is not nothing at all
            row["needs"] = needs


def _add_refused(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds that an operator's poll took nothing, or that it is not known what it takes."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), NOT_KNOWN if seen.get("is_unknown") else REFUSED_ALL]


def _add_argument_items(row: dict[str, Any] | None, asked: dict[str, Any]) -> None:
    """Adds the items that a function's argument takes; a default that is none of them is no value to give."""
    for parameter in (row or {}).get("parameters", ()):
        if parameter["name"] == asked["argument"]:
            items = items_in_contexts(parameter.get("enum_items", ()), asked["contexts"], {})
            parameter["enum_items"] = items
            if parameter.get("default") not in {item["identifier"] for item in items}:
                parameter.pop("default", None)


def _add_refusals(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what a function refused."""
    if row is not None:
        row["refusals"] = refusals(seen["outcomes"])


def _add_crashes(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds with what a function or an assignment ends Blender."""
    if row is not None:
        row["flags"] = [
            *row.get("flags", ()),
            *([ENDS_WITHOUT + seen["without"]] if seen.get("without") else ()),
            *(ENDS_ON_NONE + name for name in seen.get("none", ())),
            *(ENDS_LEFT_OUT + name for name in seen.get("left_out", ())),
            *([ENDS_WINDOWLESS] if seen.get("always") else ()),
            *([ENDS_EVERY_TIME] if seen.get("every") else ()),
            *([ENDS_IN_MODULE] if seen.get("in_module") else ()),
            *([UNSET_BY + seen["instead"]] if seen.get("instead") else ()),
        ]


def _add_undo_step(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what must be called before the mode of an operator that ends Blender without an undo step."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), ENDS_BEFORE + seen["before"]]


def _add_left_out(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what an argument is where it is left out, in place of RNA's default. A factor has no unit."""
    for parameter in (row or {}).get("parameters", ()):
        if parameter["name"] == seen["argument"]:
            for wrong in ("default", *(("unit",) if seen["argument"] == "scale" else ())):
                parameter.pop(wrong, None)
            said = parameter.get("description", "").rstrip(".")
            parameter["description"] = f"{said}. {LEFT_OUT}{seen['value']}".removeprefix(". ")


def _add_bare_data(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that RNA has no class for the data of the object that an operator adds."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), BARE_DATA]


def _add_limits(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what Blender keeps otherwise than RNA tells: ends of ranges, items taken as others, lengths that vary."""
    if row is not None:
        if seen.get("varies"):
            row["array"] = [0]
            row.pop("default", None)
        row["flags"] = [
            *row.get("flags", ()),
            *(UNBOUNDED + end for end in seen.get("ends", ())),
            *(f"{STOPS}{side}={value}" for side, value in seen.get("stops", {}).items()),
        ]
        for item in row.get("enum_items", ()):
            if kept := seen.get("read_as", {}).get(item["identifier"]):
                said = item.get("description", "").rstrip(".")
                item["description"] = f"{said}. Reads back as {kept!r}".removeprefix(". ")


def _add_locked(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds where Blender does not let it be assigned: on what, or in which modes, and what frees it."""
    if row is not None:
        row["flags"] = [
            *row.get("flags", ()),
            *([LOCKED_ON + ANY] if seen.get("is_always") else ()),
            *(LOCKED_ON + label for label in seen.get("on", ())),
            *(FREE_ON + label for label in seen.get("free_on", ())),
            *(LOCKED_WITH + mode for mode in seen.get("modes", ())),
            *([FREED_BY + seen["freed_by"]] if seen.get("freed_by") else ()),
        ]


def _add_empty(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that a collection of new instances has no elements."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), EMPTY]


def _add_start_empty(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that Blender starts with nothing in a collection."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), EMPTY_AT_START]


def _add_start_filled(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that a pointer of what Blender starts with leads to something."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), FILLED_AT_START]


def _add_gives_none(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that a function gave None for every index."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), GIVES_NONE]


def _add_returns_none(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that a method returns None."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), RETURNS_NONE]


def _add_windowless(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what Blender said of a call where it had no window."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), WINDOWLESS + seen["said"]]


def _add_written_through(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds what else a set of items changes, and whether it takes none."""
    if row is not None:
        row["flags"] = [
            *row.get("flags", ()),
            *(SETS_ALSO + name for name in seen.get("names", ())),
            *([KEEPS_ITEMS] if seen.get("keeps") else ()),
        ]


def _add_inverted(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that some panel shows a switch the other way round."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), INVERTED]


def _add_evaluated(row: dict[str, Any] | None, _seen: dict[str, Any]) -> None:
    """Adds that only evaluated objects have it filled."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), EVALUATED]


def _add_calls(row: dict[str, Any] | None, seen: dict[str, Any]) -> None:
    """Adds which other operators an operator's own script calls."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), *(f"{CALLS}{path}" for path in seen["calls"])]


def _add_own_class(row: dict[str, Any] | None, tried: dict[str, Any]) -> None:
    """Adds what a class of a script's own must have, as Blender asked for one thing after the other."""
    if row is not None:
        row["flags"] = [*row.get("flags", ()), *(f"{MUST_HAVE}{name}" for name in tried["names"])]


# Kind of record → what adds it to the row of its symbol, which may be missing.
ADDED = {
    "argument_items": _add_argument_items,
    "bare_data": _add_bare_data,
    "choices": _add_choices,
    "never_reached": _add_never_reached,
    "new_values": _add_values,
    "new_pointer": _add_pointer,
    "operator_needs": _add_needs,
    "operator_areas": _add_areas,
    "operator_calls": _add_calls,
    "operator_refused": _add_refused,
    "refusals": _add_refusals,
    "crashes": _add_crashes,
    "refused_default": _add_refused_default,
    "source_items": _add_source_items,
    "empty_collection": _add_empty,
    "evaluated": _add_evaluated,
    "gives_none": _add_gives_none,
    "inverted": _add_inverted,
    "left_out": _add_left_out,
    "limits": _add_limits,
    "locked": _add_locked,
    "own_class": _add_own_class,
    "returns_none": _add_returns_none,
    "start_empty": _add_start_empty,
    "start_filled": _add_start_filled,
    "undo_step": _add_undo_step,
    "windowless": _add_windowless,
    "written_through": _add_written_through,
}
