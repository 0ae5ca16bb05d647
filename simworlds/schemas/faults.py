"""What is wrong with data that does not fit its model, in words.

The data may be hostile: names and messages are cut, and no value is repeated.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError
    from pydantic_core import ErrorDetails

_DEEPEST = 8
_LONGEST_PART = 60
_LONGEST_MESSAGE = 200


def first_fault(error: ValidationError, *, whole: str = "") -> str:
    """``place: what is wrong`` of the first fault; ``whole`` is the place of one that is not inside the data."""
    return _in_words(_faults(error)[0], whole)


def every_fault(error: ValidationError, *, whole: str = "") -> str:
    """``place: what is wrong`` of all faults of data that is not hostile, as there may be many."""
    return "; ".join(_in_words(fault, whole) for fault in _faults(error))


def describe_faults(model: type[BaseModel], error: ValidationError, *, at_most: int) -> str:
    """Each wrong argument, in ``at_most`` characters; where one does not exist, the names of those that do."""
    faults: list[str] = []
    is_unknown = False
    for fault in _faults(error):
        place = ".".join(str(part) for part in fault["loc"]) or "arguments"
        # Of a value inside an argument, the names below would be the wrong ones.
        own = fault["type"] == "extra_forbidden" and len(fault["loc"]) == 1
        is_unknown |= own
        faults.append(f"{place}: {'there is no such argument' if own else fault['msg']}")
    text = "; ".join(faults)[:at_most]
    return f"{text}. The arguments are: {', '.join(model.model_fields) or 'none'}." if is_unknown else text


def _faults(error: ValidationError) -> list[ErrorDetails]:
    return error.errors(include_url=False, include_context=False, include_input=False)


def _in_words(fault: ErrorDetails, whole: str) -> str:
    place = ".".join(str(part)[:_LONGEST_PART] for part in fault["loc"][:_DEEPEST]) or whole
    message = fault["msg"][:_LONGEST_MESSAGE]
    return f"{place}: {message}" if place else message
