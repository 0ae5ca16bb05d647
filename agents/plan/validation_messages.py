"""Turns pydantic's validation errors into faults: a path as in the JSON, and a sentence that says what to write."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any, cast

from agents.plan.faults import MOST_FAULTS, Fault

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from pydantic import BaseModel, ValidationError
    from pydantic_core import ErrorDetails

_MOST_SUGGESTIONS = 3
_LONGEST_VALUE = 60
_TYPE_WORDS = {"str": "a name", "float": "a number", "int": "a whole number"}
_COUNTS = {2: "two", 3: "three"}
_WORDS = {
    "valid tuple": "list",
    "Tuple should": "It should",
    " after validation": "",
    "a valid dictionary or instance of": "a JSON object:",
}
_NAME_RULE = "A name has 1 to 60 characters and no slash{part}."
_WITHOUT_PARTS = "; a part of an object (Object/Part) cannot be given here"
_A_PART = "Object/Part"
_WITH_PARTS = "; write a part of an object as Object/Part"


def faults_from(error: ValidationError, data: Any, model: type[BaseModel]) -> list[Fault]:
    """One fault for each error that pydantic found when it validated ``data`` as ``model``, of many the first."""
    schema = model.model_json_schema()
    faults: dict[Fault, None] = {}
    choices: dict[str, list[str]] = {}
    for details in error.errors(include_url=False, include_context=False)[:MOST_FAULTS]:
        path, branch = _locate(details, data)
        if branch is None:
            faults[_fault(path, details, schema)] = None
        else:
            choices.setdefault(format_path(path), []).append(_describe_type(branch))
    for path, types in choices.items():
        faults[Fault(path, f"Write {' or '.join(dict.fromkeys(types))}.")] = None
    return list(faults)


def format_path(parts: Iterable[int | str]) -> str:
    """``relations[3].parents[0]``."""
    text = ""
    for part in parts:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text


def near(name: str, names: Iterable[str]) -> str:
    """``; did you mean 'Table'``, or nothing."""
    from rapidfuzz import process, utils  # noqa: PLC0415 - only plans with faults need it

    close = process.extract(
        name, list(names), limit=_MOST_SUGGESTIONS, score_cutoff=60, processor=utils.default_process
    )
    return f"; did you mean {' or '.join(repr(match) for match, _, _ in close)}" if close else ""


def _locate(details: ErrorDetails, data: Any) -> tuple[list[int | str], str | None]:
    """(path in the data, None); where several types are allowed, (path, pydantic's name of one of them)."""
    path: list[int | str] = []
    at: Any = data
    last = len(details["loc"]) - 1
    for place, part in enumerate(details["loc"]):
        if isinstance(part, int):
            path.append(part)
            items = cast("Sequence[Any]", at) if isinstance(at, (list, tuple)) else ()
            at = items[part] if part < len(items) else None
        elif isinstance(at, dict):
            fields = cast("dict[str, Any]", at)
            if part in fields or (place == last and details["type"] == "missing"):
                path.append(part)
                at = fields.get(part)
        else:
            return path, part
    return path, None


def _describe_type(name: str) -> str:
    if name.startswith("tuple"):
        count = name.count(",") + 1
        return f"a list of {_COUNTS.get(count, count)} numbers"
    return _TYPE_WORDS.get(name.removeprefix("constrained-"), name)


def _fault(path: list[int | str], details: ErrorDetails, schema: dict[str, Any]) -> Fault:  # noqa: PLR0911 - by kind
    message, kind = details["msg"], details["type"]
    match kind:
        case "missing":
            return Fault(format_path(path), "It is missing.")
        case "extra_forbidden":
            fields = list(_fields(schema, details["loc"][:-1]))
            known = f" (fields: {', '.join(fields)})" if fields else ""
            return Fault(
                format_path(path), f"Unknown field {path[-1]!r}{near(str(path[-1]), fields)}{known}."
            )
        case "union_tag_not_found":
            return Fault(format_path([*path, "kind"]), "It is missing; it says which relation this is.")
        case "union_tag_invalid":
            kinds = list(_kinds(schema))
            wanted = str(cast("Mapping[str, Any]", details["input"]).get("kind"))
            text = f"Unknown relation {wanted!r}{near(wanted, kinds)} (relations: {', '.join(kinds)})."
            return Fault(format_path([*path, "kind"]), text)
        case "value_error":
            field, _, reason = message.removeprefix("Value error, ").partition(": ")
            return Fault(format_path([*path, field]), f"{reason[:1].upper()}{reason[1:]}.")
        case "string_pattern_mismatch" | "string_too_short" | "string_too_long" if pattern := _pattern(
            _at(schema, details["loc"])
        ):
            part = _WITH_PARTS if re.search(pattern, _A_PART) else _WITHOUT_PARTS
            return Fault(format_path(path), f"{_NAME_RULE.format(part=part)}{_value(details)}")
        case _:
            words = message
            for theirs, ours in _WORDS.items():
                words = words.replace(theirs, ours)
            return Fault(format_path(path), f"{words}.{_value(details)}")


def _value(details: ErrorDetails) -> str:
    value = details["input"]
    if isinstance(value, (dict, list, tuple)):
        return ""
    text = json.dumps(value, ensure_ascii=False, default=str)
    return f" Given: {text}." if len(text) <= _LONGEST_VALUE else ""


# Reading the schema


def _pattern(field: dict[str, Any]) -> str:
    """The pattern of a name; of one of several types too."""
    return next((at["pattern"] for at in (field, *field.get("anyOf", ())) if "pattern" in at), "")


def _fields(schema: dict[str, Any], path: Sequence[int | str]) -> Iterator[str]:
    yield from _at(schema, path).get("properties", ())


def _kinds(schema: dict[str, Any]) -> Iterator[str]:
    relations = schema["properties"].get("relations", {}).get("items", {})
    yield from relations.get("discriminator", {}).get("mapping", ())


def _at(schema: dict[str, Any], path: Sequence[int | str]) -> dict[str, Any]:
    """The schema at pydantic's path; {} where the path leaves the schema."""
    at = schema
    for part in path:
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
        at = next((branch for branch in at["anyOf"] if branch.get("type") != "null"), {})
    return schema["$defs"].get(at["$ref"].rpartition("/")[2], {}) if "$ref" in at else at
