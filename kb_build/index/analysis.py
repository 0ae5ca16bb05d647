"""Text → terms, the same when a base is written and when it is queried. Part of the store's schema."""

from __future__ import annotations

import math
import re
from functools import cache, lru_cache
from typing import TYPE_CHECKING, Any

import snowballstemmer

from kb_build.symbols.api_names import OPERATORS, TYPES

if TYPE_CHECKING:
    from collections.abc import Iterator

_WORD = re.compile(r"[A-Za-z]+|\d+(?:[dD]\b|\.\d+)?|[^\W\d_]+")
_CAMEL = re.compile(r"[A-Z]{2,}s\b|[A-Z]{2,}(?=[A-Z][a-z])|[A-Z]{2}[a-z]+|[A-Z]?[a-z]+|[A-Z]+")
_PREFIXES = (TYPES, OPERATORS, "bpy.")
_NOT_KEY = re.compile(r"[\W_]+")
_KEY_OF = {code: chr(code).lower() if chr(code).isalnum() else None for code in range(128)}

# Words that say nothing about Blender: they join sentences or frame a question.
STOP_WORDS = frozenset(
    """a about after all also am an and any are as at be because been before being but by can cannot could did do does
    doing don done each either else every etc few for from get gets getting go goes going got had has have having he
    her here hers him his how however i if in instead into is isn it its just let letting lets like make makes
    making many may me might more most much must my need needs no nor not now of on one only onto or other our out
    own per please rather s same shall she should so some still such t than that the their them then there these
    they thing things this those to too until up upon us very via want wants was way we were what when where whether
    which while who whole whom whose why will with without would yet you your python blender script bpy api code
    """.split()  # noqa: SIM905 - a hundred words read best as a paragraph
)


@cache
def _stemmer() -> Any:
    return snowballstemmer.stemmer("english")


@lru_cache(maxsize=100_000)
def stem(word: str) -> str:
    """The English stem of a lower-case word."""
    return word if len(word) < 4 else str(_stemmer().stemWord(word))


def words(text: str) -> list[str]:
    """Lower-case words; identifiers are split at ``_``, at dots and at CamelCase humps."""
    return [word for token in tokens(text) for word in _words_in(token)]


def _split(token: str) -> tuple[str, ...]:
    if token.isascii() and token[0].isalpha() and not token.islower():
        return tuple(part.lower() for part in _CAMEL.findall(token))
    return (token.lower(),)


_words_in = lru_cache(maxsize=30_000)(_split)


def distinct_words(text: str) -> set[str]:
    """The words of a long text, each once. Such a text would fill what is kept for others."""
    return {word for token in set(tokens(text)) for word in _split(token)}


def tokens(text: str) -> list[str]:
    """What words are made of: numbers and runs of letters, as they are written."""
    return _WORD.findall(text)


def words_in(token: str) -> list[str]:
    """The words of a token without stop words."""
    return [word for word in _split(token) if word not in STOP_WORDS]


@lru_cache(maxsize=100_000)
def terms_in(token: str) -> tuple[str, ...]:
    """The stems of the words of a token without stop words."""
    return tuple(map(stem, words_in(token)))


@lru_cache(maxsize=1_000)
def stems_of(name: str) -> frozenset[str]:
    """The stems of a name's words."""
    return frozenset(stem(word) for token in tokens(name) for word in _split(token))


def terms(text: str) -> list[str]:
    """The stems of a text's words without stop words, in order and with repetitions."""
    return [term for token in tokens(text) for term in terms_in(token)]


def idf(documents: int, having: int) -> float:
    """Inverse document frequency, ln(1 + (N - df + ½) / (df + ½)), of a stem in ``having`` documents; 0 if none."""
    return math.log(1 + (documents - having + 0.5) / (having + 0.5)) if having else 0.0


def key(text: str) -> str:
    """One key for all spellings of a name: ``quality_steps``, ``qualitySteps`` and ``Quality Steps``."""
    return text.translate(_KEY_OF) if text.isascii() else _NOT_KEY.sub("", text).lower()


def short_path(path: str) -> str:
    """A path without the prefix that people leave out: ``ClothSettings.quality``, ``object.modifier_add``."""
    for prefix in _PREFIXES:
        if path.startswith(prefix):
            return path[len(prefix) :]
    return path


def topic_key(text: str) -> str:
    """One key for a topic in any grammatical number: ``lights``, ``Lighting`` and ``light``."""
    return "~" + "".join(terms(text))


_LAMBDA = re.compile(r"\blambda\b")


def split_arguments(text: str) -> Iterator[str]:
    """The text of each argument as it stands, blanks and all; commas in brackets and in quotes are theirs, and those
    between the names that a ``lambda`` takes.
    """
    lambdas = {match.start() for match in _LAMBDA.finditer(text)}
    depth, quote, start, named = 0, "", 0, False
    for position, char in enumerate(text):
        if quote:
            quote = "" if char == quote else quote
        elif char in "\"'":
            quote = char
        elif char in "([{":
            depth += 1
        elif char in ")]}":
            depth -= 1
        elif char == "," and depth == 0 and not named:
            yield text[start:position]
            start = position + 1
        elif depth == 0:
            named = (named and char != ":") or position in lambdas
    if text[start:].strip():
        yield text[start:]
