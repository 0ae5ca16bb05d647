"""What is wrong with the arguments of a call, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pydantic import BaseModel, ValidationError


def describe_faults(model: type[BaseModel], error: ValidationError, *, at_most: int) -> str:
    """Each wrong argument, in ``at_most`` characters; where one does not exist, the names of those that do."""
    faults: list[str] = []
    is_unknown = False
    for fault in error.errors(include_url=False, include_context=False):
        place = ".".join(str(part) for part in fault["loc"]) or "arguments"
        # Of a value inside an argument, the names below would be the wrong ones.
        own = fault["type"] == "extra_forbidden" and len(fault["loc"]) == 1
        is_unknown |= own
        faults.append(f"{place}: {'there is no such argument' if own else fault['msg']}")
    text = "; ".join(faults)[:at_most]
    return f"{text}. The arguments are: {', '.join(model.model_fields) or 'none'}." if is_unknown else text
