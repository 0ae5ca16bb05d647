"""Python's parser, which gives up on some scripts in other ways than by a SyntaxError."""

from __future__ import annotations

import ast
import re
import warnings

MOST_CHARACTERS = 2_000_000
_LINE_END = re.compile("\r\n|\r|\n")


def too_long(code: str) -> str:
    """Why a script is not read at all: its length; "" if it is read."""
    if len(code) <= MOST_CHARACTERS:
        return ""
    return f"it has {len(code):,} characters, and no more than {MOST_CHARACTERS:,} are read"


def parsed(code: str) -> ast.Module | SyntaxError:
    """The syntax tree of a script, or why there is none."""
    if (place := code.find("\0")) >= 0:  # Python does not say where
        lines = _LINE_END.split(code[:place])
        return SyntaxError("null bytes are not allowed", (None, len(lines), len(lines[-1]) + 1, None))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(code)
    except SyntaxError as error:
        return error
    except (ValueError, RecursionError, MemoryError) as error:
        return SyntaxError(f"the script cannot be parsed: {error or type(error).__name__}")
