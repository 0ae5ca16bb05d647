"""Where the analysis reads: what another place has otherwise, and what is as it was once it comes back."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from kb_build.flow.state.layers import TypesAbove

if TYPE_CHECKING:
    import ast

    from kb_build.flow.state.definitions import FunctionDefinition
    from kb_build.flow.state.scopes import Loop, Scope
    from kb_build.flow.state.source_files import SourceFile
    from kb_build.flow.values.types import Resolution, Type


@dataclass(slots=True)
class Place:
    """A scope of a file, and how it is read.

    ``types`` and ``resolutions`` take what is found. Around what is being read are ``statement``, the innermost one,
    ``function``, where one is run, its ``loops``, and so many ``dictionaries``. ``caught`` are the errors that it may
    raise with no harm. It is ``guessing`` where not all is sure that the function's parameters hold.

    A place further inside has this from the one that it is read from: ``depth``, the number of expressions and calls
    within each other; ``tries``, for what is read again, for one call or one turn of a loop alone; ``turning``, in such
    a turn.
    """

    file: SourceFile
    scope: Scope
    types: dict[ast.expr, Type]
    resolutions: dict[ast.AST, Resolution]
    function: FunctionDefinition | None = None
    loops: list[Loop] = field(default_factory=list["Loop"])
    caught: frozenset[str] = frozenset()
    statement: ast.stmt | None = None
    guessing: bool = False
    dictionaries: int = 0
    depth: int = 0
    tries: bool = False
    turning: bool = False

    @classmethod
    def module(cls, file: SourceFile) -> Place:
        """A file's module, where nothing is around it."""
        return cls(file, file.module, file.types, file.resolutions)

    def further(self, file: SourceFile, scope: Scope, function: FunctionDefinition | None) -> Place:
        """Another place, which is read from this one."""
        return Place(
            file, scope, file.types, file.resolutions, function,
            depth=self.depth, tries=self.tries, turning=self.turning,
        )  # fmt: skip

    def trial(self) -> Place:
        """The same place, to be read again: what is found then is kept apart."""
        return replace(self, types=TypesAbove(self.types), resolutions={}, tries=True)
