"""Signatures as references write them: ``bmesh.new(use_operators=True)``."""

from __future__ import annotations

import ast
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_build.symbols.records import Symbol

_MOST_KEPT = 1_024  # signatures; a base has about ten thousand


@lru_cache(maxsize=_MOST_KEPT)
def signature_arguments(signature: str) -> ast.arguments | None:
    """The arguments that a signature lists; None where it is not written as Python."""
    head, bracket, rest = signature.partition("(")
    if not head or not bracket:
        return None
    try:
        definition = ast.parse(f"def _({rest}: ...").body[0]
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    return definition.args if isinstance(definition, ast.FunctionDef) else None


def places_of(symbol: Symbol) -> tuple[list[str], list[str]] | None:
    """The arguments that a function takes by place, and those that it takes by name only; None where that is open."""
    listed = signature_arguments(symbol.signature)
    if listed is None or listed.vararg or listed.kwarg:
        return None
    own = {"self", "cls"} - {parameter.name for parameter in symbol.parameters}
    names = [argument.arg for argument in (*listed.posonlyargs, *listed.args) if argument.arg not in own]
    return names, [argument.arg for argument in listed.kwonlyargs]
