"""The text of a query as it is looked up, and what kind of text it is."""

from __future__ import annotations

import re

from kb_serve.answer.asked.sides import CODE
from kb_serve.recognise.message_patterns import is_message

_LONGEST_WORD = 100  # no name of Blender's has as many letters
_COMMENT = re.compile(r"(?:^|(?<=\s))#\s[^\n]*\n", re.MULTILINE)  # of code, of which lines are joined
_DOCSTRING = re.compile(r"(:\s*\n\s*)(?:\"{3}.*?\"{3}|'{3}.*?'{3})", re.DOTALL)
_LONG_WORD = re.compile(rf"(\w{{{_LONGEST_WORD}}})\w+")


def in_one_line(query: str) -> str:
    """A query without what no base holds: docstrings and comments of code, lone surrogates, endless words."""
    text = _COMMENT.sub("", _DOCSTRING.sub(r"\1", query)).strip() or query
    text = " ".join(text.encode(errors="ignore").decode().replace("\0", " ").split())
    return _LONG_WORD.sub(r"\1", text)


def is_plain(text: str) -> bool:
    """Whether a query is neither code, which says itself what is whose, nor an error message."""
    return CODE.isdisjoint(text) and not is_message(text)
