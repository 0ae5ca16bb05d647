"""What a question is not about: what it does without (``delete object without ops``), what must not happen, how its
script runs.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from kb_build.index.analysis import stem
from kb_build.symbols.api_names import OPERATORS
from kb_serve.recognise.message_patterns import is_message

_ANY = r"(?:(?:an?|the|any|using|calling)\s)*"
# Not one operator by its name: who names it wants to know what else there is.
_OPERATORS = rf"{_ANY}(?:bpy\.ops\b(?!\.\w)|ops\b|operators?\b)"
_OVERRIDE = rf"{_ANY}(?:context\s)?overrid(?:e|es|ing)\b"
# "without operator buttons" is about buttons.
_END = r"(?=\W*$|[,.;:!?)]|\s(?:and|at|but|by|for|from|in|nor|on|or|so|that|to|when|while|with)\b)"
# Means that there are others than: what moves, aims and shapes things. "Without a shadow" asks for a setting.
_MEANS = rf"{_ANY}(?P<means>constraint|driver|keyframe|modifier)s?\b"
_THING = rf"(?:{_OPERATORS}|{_OVERRIDE}){_END}"
_LACKING = r"(?:without|w/o|not(?=\s(?:using|calling))|instead\sof|rather\sthan|no(?=\s[\w.]+(?:\s\w+)?\W*$))"
_STATED = r"(?<!\bis)(?<!\bare)(?<!\bhas)(?<!\bhave)"  # "there is no operator" says what is the case
_UNWANTED = re.compile(rf"{_STATED},?\s\(?{_LACKING}\s{_THING}(?:\s(?:or|and|nor)\s{_THING})*\)?", re.I)
_OTHER_MEANS = re.compile(rf"{_STATED}\s(?:without|w/o|not\susing)\s{_MEANS}{_END}", re.I)
_EXPORTED = re.compile(r"\bexport", re.I)  # as it is without its modifiers
# Without one of these, a question says nothing of the kind.
_MAY_SAY_SO = re.compile(r"\b(?:without|w/o|not?|instead|rather|headless(?:ly)?|background|blender)\b", re.I)
_SPARED = re.compile(rf"\swithout\s\w+ing\s(?:it|them){_END}", re.I)
_WHY = re.compile(r"why\b", re.I)  # asks what the case is, not how to do something
_OF_OPERATORS = re.compile(_OPERATORS, re.I)
_CODE = "python"  # who says so writes code


# How a script runs, which decides nothing about what it calls.
_RUN = re.compile(
    r"\s(?:in\s(?:the\s)?background(?:\smode)?|in\sheadless\smode|headless(?:ly)?"
    r"|(?:without|with\sno)\s(?:an?\s|the\s|any\s)?(?:ui|gui|display|screen|window))(?=\W*$|,|\s(?:and|from|in|to|with)\b)",
    re.I,
)
# The version that is asked for, beside other words: the base is that of one.
_VERSION = re.compile(
    r"\s(?:(?:in|for|with|on|using)\s)?blender\s(?:version\s)?v?\d+\.\d+(?:\.\d+)?(?=\W*$)", re.I
)
_BLENDER = re.compile(r"\bblender\b", re.I)  # of whose own start the question may be
_LEAST_WORDS = 3
_ABOUT_VERSIONS = re.compile(
    r"\b(?:changed?|changes|gone|missing|new|news|notes|removed|renamed|replace[ds]?|since)\b", re.I
)


class Wanted(NamedTuple):
    """A question without what it does not want; ``operators``: whether they will do; ``without``: the stem of the means
    that will not, if there is one.
    """

    text: str
    operators: bool = True
    without: str = ""


def without_unwanted(query: str) -> Wanted:
    """A question, its blanks single, as it would be asked by who only knows what is wanted."""
    if is_message(query) or _WHY.match(query) or not _MAY_SAY_SO.search(query):
        return Wanted(query)
    asked = _SPARED.sub("", _without_run(_without_version(query)))
    asked, unwanted = _take_out(_UNWANTED, asked)
    asked, means = _take_out(_OTHER_MEANS, asked) if not _EXPORTED.search(asked) else (asked, None)
    code = f" {_CODE}" if asked != query else ""
    are_unwanted = unwanted is not None and _OF_OPERATORS.search(unwanted[0]) is not None
    return Wanted(
        asked + code,
        operators=not are_unwanted or OPERATORS in asked,
        without=stem(means["means"].lower()) if means else "",
    )


def _take_out(pattern: re.Pattern[str], text: str) -> tuple[str, re.Match[str] | None]:
    """(a text without the first place that a pattern fits, that place)."""
    found = pattern.search(text)
    if found is None:
        return text, None
    return " ".join((text[: found.start()] + text[found.end() :]).split()), found


def _without_version(query: str) -> str:
    """A question without the Blender at its end, unless that is what it is about: "what is new in Blender 5.1"."""
    text = _VERSION.sub("", query)
    return query if _ABOUT_VERSIONS.search(text) or len(text.split()) < _LEAST_WORDS else text


def _without_run(query: str) -> str:
    """A question without how its script runs, if that is not all that it asks for."""
    text = _RUN.sub("", query)
    return query if len(text.split()) < _LEAST_WORDS or _BLENDER.search(text) else text
