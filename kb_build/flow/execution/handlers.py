"""Reads what is ready for errors: ``try``, and ``with``, whose managers may suppress them."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.guards import Guards, assigned_names
from kb_build.flow.execution.ways import Ways
from kb_build.flow.state.core import EVERY_ERROR
from kb_build.flow.state.doubts import EVERYTHING
from kb_build.flow.state.scopes import joined
from kb_build.flow.syntax.trees import run_with
from kb_build.flow.values.type_parts import entered
from kb_build.flow.values.types import UNKNOWN, Builtin, Tuple, catches, members

if TYPE_CHECKING:
    from collections.abc import Sequence as Rows

_LACKS = ("AttributeError",)
_FORGIVING = frozenset(
    {
        "AttributeError",
        "Exception",
        "BaseException",
        "ImportError",
        "KeyError",
        "LookupError",
        "ModuleNotFoundError",
        "TypeError",
        "RuntimeError",
        "ValueError",
    }
)


class Handlers(Guards, Ways):
    """Reads ``try`` and ``with``; each reader tells whether the next statement can be reached."""

    def read_try(self, node: ast.Try) -> bool:
        """Reads ``try``: a handler begins anywhere within what it handles."""
        caught = [self._caught(handler) for handler in node.handlers]
        before = self.here.scope.state
        with self.ready_for(self._let_pass(node.handlers, caught)):
            after = self.way(self.copied(before), node.body)
        within = joined([before, after or self.here.scope.state])
        if after is not None and node.orelse:
            after = self.way(after, node.orelse)
        ways = [after]
        for handler, errors in zip(node.handlers, caught, strict=True):
            self.here.scope.state = self.copied(within)
            if handler.name:
                self.bind(handler.name, UNKNOWN)
            # What is done where a name is lacking may be for another Blender.
            with self.ready_for((EVERY_ERROR,) if errors else ()):
                ways.append(self.way(self.here.scope.state, handler.body))
        reached = self.meet(ways, self.copied(within))
        if (
            after is None
            and _only_reads([*node.body, *node.orelse])
            and any(catches(errors, _LACKS) for errors in caught)
        ):
            self.doubt_here(EVERYTHING)  # what follows is come to where a member is lacking that was read
        if any(caught):
            handled = [statement for handler in node.handlers for statement in handler.body]
            self.tell(assigned_names([*node.body, *node.orelse, *handled]), self.lacked(node.body))
        return self.read_body(node.finalbody) and reached

    def read_with(self, node: ast.With | ast.AsyncWith) -> bool:
        """Reads ``with``: what follows is reached also where the manager suppresses an error."""
        for item in node.items:
            kind = self.evaluate(item.context_expr)
            if item.optional_vars is not None:
                self.bind_target(item.optional_vars, entered(kind))
        suppressed = frozenset(name for item in node.items for name in self._suppressed(item.context_expr))
        with self.ready_for(suppressed):
            reached = self.read_body(node.body)
        return reached or bool(suppressed)

    def _caught(self, handler: ast.ExceptHandler) -> frozenset[str]:
        """The errors of what a Blender lacks, or their classes, that a handler catches."""
        return frozenset({EVERY_ERROR}) if handler.type is None else self._errors(handler.type)

    def _let_pass(self, handlers: list[ast.ExceptHandler], caught: list[frozenset[str]]) -> frozenset[str]:
        """The errors that do not get out of a ``try``: what catches them does not end by raising one.

        What is raised in their place may be any, for what is around.
        """
        found: frozenset[str] = frozenset()
        for handler, errors in zip(handlers, caught, strict=True):
            if not isinstance(last := handler.body[-1], ast.Raise):
                found |= errors
            elif self.here.caught and last.exc is not None:
                found |= {EVERY_ERROR}
        return found

    def _suppressed(self, manager: ast.expr) -> frozenset[str]:
        """The errors of what a Blender lacks that a context manager, which was read, keeps from getting out.

        ``contextlib.suppress(AttributeError)`` does, and so does what else is given such an error: ``assertRaises``.
        """
        given = manager.args if isinstance(manager, ast.Call) else ()
        return frozenset(name for argument in given for name in self._errors(argument))

    def _errors(self, errors: ast.expr) -> frozenset[str]:
        """The names of the classes that an expression stands for which are those of such errors."""
        kinds = [*members(self.evaluate(errors))]
        for kind in kinds:  # it grows
            if isinstance(kind, Tuple):
                kinds += kind.items
        return frozenset(kind.name for kind in kinds if isinstance(kind, Builtin) and kind.name in _FORGIVING)


def _only_reads(statements: Rows[ast.stmt]) -> bool:
    """Whether statements read members, and do nothing else that may fail."""
    parts = [*run_with(statements)]
    is_reading = any(isinstance(part, ast.Attribute) for part in parts)
    return is_reading and not any(isinstance(part, (ast.Call, ast.Subscript, ast.Raise)) for part in parts)
