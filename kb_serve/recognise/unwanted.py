"""What a question says it wants to do without: ``delete object without ops``, ``apply modifier, no operator``."""

from __future__ import annotations

import re
from typing import NamedTuple

from kb_serve.recognise.message_patterns import is_message

_ANY = r"(?:(?:an?|the|any|using|calling)\s)*"
# Not one operator by its name: who names it wants to know what else there is.
_OPERATORS = rf"{_ANY}(?:bpy\.ops\b(?!\.\w)|ops\b|operators?\b)"
_OVERRIDE = rf"{_ANY}(?:context\s)?overrid(?:e|es|ing)\b"
# "without operator buttons" is about buttons.
_END = r"(?=\W*$|[,.;:!?)]|\s(?:and|at|but|by|for|from|in|nor|on|or|so|that|to|when|while|with)\b)"
_THING = rf"(?:{_OPERATORS}|{_OVERRIDE}){_END}"
_LACKING = r"(?:without|w/o|not(?=\s(?:using|calling))|instead\sof|rather\sthan|no(?=\s[\w.]+(?:\s\w+)?\W*$))"
_STATED = r"(?<!\bis)(?<!\bare)(?<!\bhas)(?<!\bhave)"  # "there is no operator" says what is the case
_UNWANTED = re.compile(rf"{_STATED},?\s\(?{_LACKING}\s{_THING}(?:\s(?:or|and|nor)\s{_THING})*\)?", re.I)
_WHY = re.compile(r"why\b", re.I)  # asks what the case is, not how to do something
_OF_OPERATORS = re.compile(_OPERATORS, re.I)
_NAMED = "bpy.ops."
_CODE = "python"  # who says so writes code


class Wanted(NamedTuple):
    """A question without what it does not want; ``operators``: whether they will do."""

    text: str
    operators: bool = True


def without_unwanted(query: str) -> Wanted:
    """A question, its blanks single, as it would be asked by who only knows what is wanted."""
    found = None if is_message(query) or _WHY.match(query) else _UNWANTED.search(query)
    if found is None:
        return Wanted(query)
    text = " ".join((query[: found.start()] + query[found.end() :]).split())
    are_unwanted = _OF_OPERATORS.search(found[0]) is not None and _NAMED not in text
    return Wanted(f"{text} {_CODE}", operators=not are_unwanted)
