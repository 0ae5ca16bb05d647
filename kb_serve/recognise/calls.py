"""Finds wrong arguments in calls of operators and functions."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_serve.recognise.corrections import nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from kb_build.records import Symbol
    from kb_serve.recognise.chains import Chain

OVERRIDE = "bpy.types.Context.temp_override"
NO_OVERRIDE = (
    "Operators take keyword arguments only, after an optional execution context. A context is not an argument: "
    f"set it with `{OVERRIDE}`."
)
_FEW = 3
_NESTED = re.compile(r"""\([^()]*\)|\[[^\[\]]*\]|\{[^{}]*\}|'[^']*'|"[^"]*\"""")
_KEYWORD = re.compile(r"(?:^|,)\s*(\w+)\s*=(?!=)")
_DEPTH = 5


def unknown_keywords(symbol: Symbol, names: Iterable[str]) -> Iterator[str]:
    """A sentence for each of ``names`` that is not a parameter of ``symbol``, with the most similar parameters."""
    known = [parameter.name for parameter in symbol.parameters]
    for name in names:
        if not known or name in known or any(other.startswith("*") for other in known):
            continue
        similar = [other for other, _ in nearest(name, known)]
        similar = similar or [other for other in known if other.startswith(name[:3])]
        closest = f"; closest: {', '.join(f'`{other}`' for other in similar[:_FEW])}" if similar else ""
        yield f"`{symbol.path}` takes no `{name}`{closest}."


def wrong_arguments(chain: Chain, symbol: Symbol) -> Iterator[str]:
    """Sentences on the wrong arguments of a call, as far as its text shows."""
    last = chain.steps[-1] if chain.steps else None
    if last is None or last.kind != "call" or symbol.kind not in {"operator", "function"}:
        return
    text = last.text
    if symbol.kind == "operator" and _gives_context(text):
        yield NO_OVERRIDE
    for _ in range(_DEPTH):
        text = _NESTED.sub("0", text)
    if symbol.kind == "operator" or symbol.path.startswith("bmesh.ops."):
        yield from unknown_keywords(symbol, _KEYWORD.findall(text))


def _gives_context(arguments: str) -> bool:
    """Whether the first argument is a dictionary, or a variable named like a context override."""
    first = arguments.strip()
    return bool(re.match(r"\{|dict\(|\w*(?:override|context|ctx)\w*(?:\.copy\(\))?\s*(?:,|$)", first))
