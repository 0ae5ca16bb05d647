"""What a sentence is told of: symbols, pages that explain them, questions with some words."""

from __future__ import annotations

from typing import NamedTuple

from kb_build.index.analysis import stem, words
from kb_build.symbols.api_names import TYPES


def stems(text: str) -> frozenset[str]:
    """The stems of some words; of ``h264`` the number alone, as a letter is a variable of any script."""
    return frozenset(stem(word) for word in words(text) if len(word) > 1)


class Advice(NamedTuple):
    """A sentence, and what it is told of: symbols, those whose paths begin so, pages that explain a symbol or (in
    ``chapters_of``) stand in one folder with those.

    A question that does not name the symbol must have a word of ``about``, if there are any, and every question one of
    ``asked``. It is told of any symbol where the question has a word of each of ``wherever``, and none of ``unless``;
    and only where the base has the symbol that it ``needs``, but not of that, and is of a Blender from ``since`` on
    that comes ``before`` another.
    """

    text: str
    symbols: frozenset[str] = frozenset()
    beginning: tuple[str, ...] = ()
    explained: str = ""
    chapters_of: str = ""
    about: frozenset[str] = frozenset()
    asked: frozenset[str] = frozenset()
    wherever: tuple[frozenset[str], ...] = ()
    unless: frozenset[str] = frozenset()
    needs: str = ""
    since: tuple[int, int] = (0, 0)
    before: tuple[int, int] = (99, 0)


def of(*names: str) -> frozenset[str]:
    """The paths of some of RNA's classes and their members."""
    return frozenset(f"{TYPES}{name}" for name in names)
