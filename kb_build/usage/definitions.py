"""Shows the definitions of a script that use what is Blender's: classes derived from its own, decorated functions."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_MOST_SETTINGS = 6
_MOST_METHODS = 2
_MOST_DECORATORS = 2
_LONGEST_LINE = 110


def derived_class(definition: ast.ClassDef, lines: Sequence[str]) -> str | None:
    """The head of a class, its settings (``bl_label = …``) and its first methods, as code that can be run alone.

    ``lines`` are those of the script. None for a class that sets nothing and defines nothing, or whose head is long.
    """
    head = f"class {definition.name}({', '.join(map(ast.unparse, definition.bases))}):"
    settings = list(_settings(definition, lines))
    methods = list(_methods(definition))
    if len(head) > _LONGEST_LINE or not (settings or methods):
        return None
    body = [*settings[:_MOST_SETTINGS], *([""] if settings and methods else []), *methods[:_MOST_METHODS]]
    return "\n".join((head, *(f"    {line}" if line else "" for line in body)))


def decorated_function(definition: ast.FunctionDef | ast.AsyncFunctionDef) -> str | None:
    """The head of a function below its decorators; None where there are none, many, or long ones."""
    lines = [f"@{ast.unparse(decorator)}" for decorator in definition.decorator_list]
    head = f"def {definition.name}({ast.unparse(definition.args)}): ..."
    lines.append(f"async {head}" if isinstance(definition, ast.AsyncFunctionDef) else head)
    is_short = 1 < len(lines) <= _MOST_DECORATORS + 1 and all(len(line) <= _LONGEST_LINE for line in lines)
    return "\n".join(lines) if is_short else None


def without_comment(line: str) -> str:
    """A line of a script alone, without the comment behind it."""
    return line.split("  #", maxsplit=1)[0].strip()


def _settings(definition: ast.ClassDef, lines: Sequence[str]) -> Iterator[str]:
    """The settings of one line each."""
    for statement in definition.body:
        if isinstance(statement, (ast.Assign, ast.AnnAssign)) and statement.lineno == statement.end_lineno:
            text = without_comment(lines[statement.lineno - 1])
            if len(text) <= _LONGEST_LINE:
                yield text


def _methods(definition: ast.ClassDef) -> Iterator[str]:
    """The heads of the methods that are called on an instance, those with a name of Python's own left out."""
    for statement in definition.body:
        if not isinstance(statement, ast.FunctionDef) or statement.decorator_list:
            continue
        if not statement.name.startswith("_"):
            yield f"def {statement.name}({ast.unparse(statement.args)}): ..."
