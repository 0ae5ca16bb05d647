"""Signatures as references write them: ``bmesh.new(use_operators=True)``."""

from __future__ import annotations

import ast
from functools import lru_cache

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
