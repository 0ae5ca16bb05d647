"""The arguments of a tool call as a model wrote them: JSON that is an object, without what JSON cannot hold."""

from __future__ import annotations

import json
import math
from typing import Any, cast

from pydantic_core import from_json

_LONGEST_SHOWN = 80


def read_input(given: str | dict[str, Any]) -> dict[str, Any]:
    """The arguments, of their text or as a server has decoded them. Raises ValueError, in words for the model."""
    try:
        text = given if isinstance(given, str) else json.dumps(given)
    except RecursionError as error:
        raise ValueError("The arguments are no JSON that can be read: they are nested too deeply.") from error
    try:
        value: Any = from_json(text or "{}", allow_inf_nan=False)
    except ValueError as error:
        raise ValueError(
            f"The arguments are not valid JSON: {error}. They begin with {text[:_LONGEST_SHOWN]!r}."
        ) from error
    if not isinstance(value, dict):
        raise ValueError(f"The arguments have to be a JSON object, not {text[:_LONGEST_SHOWN]!r}.")
    if not _is_finite(value):
        raise ValueError("The arguments have a number that is too large for JSON.")
    return cast("dict[str, Any]", value)


def _is_finite(value: Any) -> bool:
    """Whether all numbers are: 1e999 is read as infinity."""
    if isinstance(value, float):
        return math.isfinite(value)
    if isinstance(value, dict):
        return all(map(_is_finite, cast("dict[str, Any]", value).values()))
    return all(map(_is_finite, cast("list[Any]", value))) if isinstance(value, list) else True
