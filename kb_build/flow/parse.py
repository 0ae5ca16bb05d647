"""Python's parser, which gives up on some scripts in other ways than by a SyntaxError."""

from __future__ import annotations

import ast
import warnings


def parsed(code: str) -> ast.Module | SyntaxError:
    """The syntax tree of a script, or why there is none."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(code)
    except SyntaxError as error:
        return error
    except (ValueError, RecursionError, MemoryError) as error:
        return SyntaxError(f"the script cannot be parsed: {error or type(error).__name__}")
