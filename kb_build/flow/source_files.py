"""The files that are analysed together, and the names by which they import each other."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

from kb_build.flow.scopes import Scope
from kb_build.flow.types import Readings

if TYPE_CHECKING:
    from kb_build.flow.types import Resolution, Type


@dataclass(slots=True)
class SourceFile:
    """One file: its module's dotted name, its text as a tree (None with an ``error``), and what was found in it.

    ``keeps_annotations``: Python leaves its annotations unread. ``steps_left`` is what may still be spent on reading
    it, ``complete`` whether that was enough, ``readings`` what its module took from definitions.
    """

    name: str
    is_package: bool
    tree: ast.Module | None
    steps_left: int
    error: SyntaxError | None = None
    keeps_annotations: bool = False
    module: Scope = field(default_factory=Scope)
    types: dict[ast.expr, Type] = field(default_factory=dict["ast.expr", "Type"])
    resolutions: dict[ast.AST, Resolution] = field(default_factory=dict["ast.AST", "Resolution"])
    readings: Readings = field(default_factory=Readings)
    started: bool = False
    complete: bool = True

    def imported(self, level: int, module: str) -> str:
        """The dotted name of what ``from ..module import`` means here, with ``level`` dots; empty for nothing."""
        if not level:
            return module
        parts = self.name.split(".")
        parts = parts[: len(parts) - level + self.is_package]
        return ".".join([*parts, module] if module else parts) if parts else ""


def keeps_annotations(tree: ast.Module) -> bool:
    """Whether a file begins with ``from __future__ import annotations``."""
    return any(
        isinstance(statement, ast.ImportFrom)
        and statement.module == "__future__"
        and any(alias.name == "annotations" for alias in statement.names)
        for statement in tree.body
    )


def module_name(path: str) -> tuple[str, bool]:
    """``addon/ui/__init__.py`` → (``addon.ui``, True): a file's dotted name, and whether it is a package's."""
    parts = PurePosixPath(path.removesuffix(".py")).parts
    is_package = bool(parts) and parts[-1] == "__init__"
    return ".".join(parts[:-1] if is_package else parts), is_package
