"""Sentences on functions of which Blender says nothing, not even in a docstring: what ``bmesh.ops`` does.

A language model wrote them once, and each was tried; they say so. They are found by the path and the parameters of a
function: one that has taken others since has none. corpora/summaries/README.md says more.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import replace
from importlib.resources import files
from typing import TYPE_CHECKING

from kb_build.schema import BY_MODEL

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.symbols.records import Symbol

FILE = "functions.jsonl"


def function_digest(symbol: Symbol) -> str:
    """What a sentence is known by, besides the path: the names of what the function takes."""
    names = ", ".join(parameter.name for parameter in symbol.parameters)
    return hashlib.sha256(f"{symbol.path}({names})".encode()).hexdigest()[:16]


def load_function_summaries() -> dict[tuple[str, str], str]:
    """(path, digest of the parameters) → the sentence."""
    source = files("corpora").joinpath("summaries", FILE)
    rows = map(json.loads, source.read_text(encoding="utf-8").splitlines() if source.is_file() else ())
    return {(path, digest): text for path, digests, _, text in rows for digest in digests}


def with_function_summaries(symbols: Iterable[Symbol]) -> Iterator[Symbol]:
    """The same symbols, with a sentence where there is one and Blender has none."""
    texts = load_function_summaries()
    for symbol in symbols:
        if symbol.kind == "function" and not symbol.description:
            text = texts.get((symbol.path, function_digest(symbol)), "")
            yield replace(symbol, description=f"{BY_MODEL}{text}") if text else symbol
        else:
            yield symbol
