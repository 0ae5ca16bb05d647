"""What a question says it wants to do without: ``delete object without ops``, ``apply modifier, no operator``."""

from __future__ import annotations

import re
from typing import NamedTuple

_ANY = r"(?:an?\s+|the\s+|any\s+|using\s+|calling\s+)*"
_OPERATORS = rf"(?P<operators>{_ANY}(?:bpy\.ops(?:\.\w+)*(?:\(\))?|ops|operators?)\b)"
_CONTEXT = rf"{_ANY}(?:context\s+overrid(?:e|es|ing)|overrid(?:e|es|ing)(?:\s+the\s+context)?|context)\b"
_LACKING = r"(?:without|w/o|no|not(?=\s+(?:using|calling))|instead\s+of|rather\s+than)"
_UNWANTED = re.compile(rf"[\s,]+\(?\b{_LACKING}\s+(?:{_OPERATORS}|{_CONTEXT})\)?", re.I)
_CODE = "python"  # who says so writes code


class Wanted(NamedTuple):
    """A question without what it does not want; ``operators``: whether they will do."""

    text: str
    operators: bool


def without_unwanted(query: str) -> Wanted:
    """A question as it would be asked by who only knows what is wanted."""
    found = _UNWANTED.search(query)
    if found is None:
        return Wanted(query, operators=True)
    text = " ".join((query[: found.start()] + query[found.end() :]).split())
    return Wanted(f"{text} {_CODE}", operators=found["operators"] is None)
