"""What pydantic finds wrong, in the words of plans: paths without its own labels, sentences that say what to write."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, cast

from agents.plan.faults import Fault

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from pydantic import BaseModel, ValidationError
    from pydantic_core import ErrorDetails

_NEAREST = 3
_LONGEST_VALUE = 60
_BRANCHES = {"str": "a name", "float": "a number", "int": "a whole number"}
_COUNTS = {2: "two", 3: "three"}
_WORDS = {
    "valid tuple": "list",
    "Tuple should": "It should",
    " after validation": "",
    "a valid dictionary or instance of": "a JSON object:",
}
_NAMES = "A name is 1 to 60 characters without a slash; a part of an object is named as Object/Part."


def faults_from(error: ValidationError, given: Any, model: type[BaseModel]) -> list[Fault]:
    """One fault for each thing that is wrong with ``given``, which is no ``model``."""
    schema = model.model_json_schema()
    found: dict[Fault, None] = {}
    choices: dict[str, list[str]] = {}
    for one in error.errors(include_url=False, include_context=False):
        path, branch = _place(one, given)
        if branch is None:
            found[_fault(path, one, schema)] = None
        else:
            choices.setdefault(path_of(path), []).append(_branch(branch))
    for path, words in choices.items():
        found[Fault(path, f"Give {' or '.join(dict.fromkeys(words))}.")] = None
    return list(found)


def path_of(parts: Iterable[int | str]) -> str:
    """``relations[3].parents[0]``."""
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def near(name: str, names: Iterable[str]) -> str:
    """``; did you mean 'Table'``, or nothing."""
    from rapidfuzz import process, utils  # noqa: PLC0415 - only plans with faults need it

    close = process.extract(
        name, list(names), limit=_NEAREST, score_cutoff=60, processor=utils.default_process
    )
    return f"; did you mean {' or '.join(repr(found) for found, _, _ in close)}" if close else ""


def _place(one: ErrorDetails, given: Any) -> tuple[list[int | str], str | None]:
    """(the way through the data, None); where several types are possible, (the way there, pydantic's name of one)."""
    path: list[int | str] = []
    at: Any = given
    last = len(one["loc"]) - 1
    for place, part in enumerate(one["loc"]):
        if isinstance(part, int):
            path.append(part)
            items = cast("Sequence[Any]", at) if isinstance(at, (list, tuple)) else ()
            at = items[part] if part < len(items) else None
        elif isinstance(at, dict):
            fields = cast("dict[str, Any]", at)
            if part in fields or (place == last and one["type"] == "missing"):
                path.append(part)
                at = fields.get(part)
        else:
            return path, part
    return path, None


def _branch(name: str) -> str:
    if name.startswith("tuple"):
        count = name.count(",") + 1
        return f"a list of {_COUNTS.get(count, count)} numbers"
    return _BRANCHES.get(name.removeprefix("constrained-"), name)


def _fault(path: list[int | str], one: ErrorDetails, schema: dict[str, Any]) -> Fault:  # noqa: PLR0911 - by kind
    message, kind = one["msg"], one["type"]
    match kind:
        case "missing":
            return Fault(path_of(path), "It is missing.")
        case "extra_forbidden":
            fields = list(_fields(schema, one["loc"][:-1]))
            known = f" (fields: {', '.join(fields)})" if fields else ""
            return Fault(
                path_of(path), f"There is no field {path[-1]!r} here{near(str(path[-1]), fields)}{known}."
            )
        case "union_tag_not_found":
            return Fault(path_of([*path, "kind"]), "It is missing; it says which relation this is.")
        case "union_tag_invalid":
            kinds = list(_kinds(schema))
            wanted = str(cast("Mapping[str, Any]", one["input"]).get("kind"))
            told = f"There is no relation {wanted!r}{near(wanted, kinds)} (relations: {', '.join(kinds)})."
            return Fault(path_of([*path, "kind"]), told)
        case "value_error":
            field, _, reason = message.removeprefix("Value error, ").partition(": ")
            return Fault(path_of([*path, field]), f"{reason[:1].upper()}{reason[1:]}.")
        case "string_pattern_mismatch" | "string_too_short" | "string_too_long" if "pattern" in str(
            _at(schema, one["loc"])
        ):
            return Fault(path_of(path), f"{_NAMES}{_given(one)}")
        case _:
            words = message
            for theirs, ours in _WORDS.items():
                words = words.replace(theirs, ours)
            return Fault(path_of(path), f"{words}.{_given(one)}")


def _given(one: ErrorDetails) -> str:
    value = one["input"]
    if isinstance(value, (dict, list, tuple)):
        return ""
    told = json.dumps(value, ensure_ascii=False, default=str)
    return f" Given: {told}." if len(told) <= _LONGEST_VALUE else ""


# The schema at a place


def _fields(schema: dict[str, Any], way: Sequence[int | str]) -> Iterator[str]:
    yield from _at(schema, way).get("properties", ())


def _kinds(schema: dict[str, Any]) -> Iterator[str]:
    relations = schema["properties"].get("relations", {}).get("items", {})
    yield from relations.get("discriminator", {}).get("mapping", ())


def _at(schema: dict[str, Any], way: Sequence[int | str]) -> dict[str, Any]:
    """The schema of what pydantic's way leads to; {} where it leads out of what is told."""
    at = schema
    for part in way:
        at = _resolved(schema, at)
        if isinstance(part, int):
            items = at.get("prefixItems", ())
            at = items[part] if part < len(items) else at.get("items", {})
        elif part in at.get("properties", {}):
            at = at["properties"][part]
        else:
            reference = at.get("discriminator", {}).get("mapping", {}).get(part)
            at = {"$ref": reference} if reference else {}
    return _resolved(schema, at)


def _resolved(schema: dict[str, Any], at: dict[str, Any]) -> dict[str, Any]:
    if "anyOf" in at:  # a field that may be null
        at = next((one for one in at["anyOf"] if one.get("type") != "null"), {})
    return schema["$defs"].get(at["$ref"].rpartition("/")[2], {}) if "$ref" in at else at
