"""Reads statements in the order in which they run."""

from __future__ import annotations

import ast
import sys
from functools import partial
from typing import TYPE_CHECKING, ClassVar

from kb_build.flow.evaluation.expressions import is_decided
from kb_build.flow.execution.assignments import Assignments
from kb_build.flow.execution.branches import Branches
from kb_build.flow.execution.defining import Defining
from kb_build.flow.execution.handlers import Handlers
from kb_build.flow.execution.imports import Imports
from kb_build.flow.execution.loops import Loops
from kb_build.flow.values.texts import lessened
from kb_build.flow.values.type_parts import HOLDING, bounded, with_parts, without_parts
from kb_build.flow.values.types import NONE, UNKNOWN, ClassObject, join, literal, members, union

if TYPE_CHECKING:
    from collections.abc import Callable
    from collections.abc import Sequence as Rows

    from kb_build.flow.state.definitions import FunctionDefinition
    from kb_build.flow.values.types import Type

_LEAVING = (ast.Return, ast.Raise, ast.Break, ast.Continue)


class Statements(Assignments, Branches, Loops, Handlers, Imports, Defining):
    """Reads statements; each reader tells whether the next statement can be reached."""

    def read_body(self, body: Rows[ast.stmt]) -> bool:
        """Reads statements one after the other; whether what follows them can be reached."""
        for place, statement in enumerate(body):
            self.here.statement = statement
            if self.here.scope.state.doubted.everything:
                self.here.file.doubted.add(statement)
            reader = self._statement_readers.get(type(statement))
            if reader is not None and not reader(self, statement):
                if not isinstance(statement, _LEAVING):  # what is left behind a condition
                    self.here.file.left_out.update(body[place + 1 :])
                return False
        return True

    def _expression(self, node: ast.Expr) -> bool:
        self.evaluate(node.value)
        return True

    def _return(self, node: ast.Return) -> bool:
        kind = self.told(self.evaluate(node.value), node.value) if node.value is not None else NONE
        function = self.here.function
        if function is not None:
            kind = self._ended(function, bounded(kind))
            function.returned = kind if function.returned is None else join(function.returned, kind)
        return False

    def _ended(self, function: FunctionDefinition, kind: Type) -> Type:
        """What a function returns, without what it is known to return inside: a tree of lists has no end."""
        number = self.numbers.get(function.node)
        if number is None or all(asked != number for asked, _ in function.readings):
            return kind
        known = [
            part for part in members(self.functions[number].returned or UNKNOWN) if isinstance(part, HOLDING)
        ]
        return union(with_parts(one, partial(without_parts, known=known)) for one in members(kind))

    def _raise(self, node: ast.Raise) -> bool:
        for part in (node.exc, node.cause):
            if part is not None:
                self.evaluate(part)
        return False

    def _assert(self, node: ast.Assert) -> bool:
        holds = self.evaluate(node.test)
        self.narrow(node.test, holds=True)
        if node.msg is not None:
            self.evaluate(node.msg)
        return not is_decided(holds) or literal(holds) is True

    def _delete(self, node: ast.Delete) -> bool:
        for target in node.targets:
            if isinstance(target, (ast.Attribute, ast.Subscript)):
                owner = self.evaluate(target.value)
                if isinstance(target, ast.Attribute) and isinstance(owner, ClassObject):
                    continue
                self.evaluate(target)
                if isinstance(target, ast.Subscript) and isinstance(owner, HOLDING):
                    self.fill(target.value, lessened(owner))
        return True

    def _global(self, node: ast.Global | ast.Nonlocal) -> bool:
        if self.here.scope is not self.here.file.module:
            self.here.scope.elsewhere.update(node.names)
        return True

    _statement_readers: ClassVar[dict[type, Callable[..., bool]]] = {
        ast.Assign: Assignments.read_assignment,
        ast.AnnAssign: Assignments.read_annotated_assignment,
        ast.AugAssign: Assignments.read_augmented_assignment,
        ast.If: Branches.read_if,
        ast.For: Loops.read_for,
        ast.AsyncFor: Loops.read_for,
        ast.While: Loops.read_while,
        ast.Break: Loops.read_break,
        ast.Continue: Loops.read_continue,
        ast.With: Handlers.read_with,
        ast.AsyncWith: Handlers.read_with,
        ast.Try: Handlers.read_try,
        ast.TryStar: Handlers.read_try,
        ast.Match: Branches.read_match,
        ast.Expr: _expression,
        ast.Return: _return,
        ast.Raise: _raise,
        ast.Assert: _assert,
        ast.Delete: _delete,
        ast.Global: _global,
        ast.Nonlocal: _global,
        ast.Import: Imports.read_import,
        ast.ImportFrom: Imports.read_import_from,
        ast.FunctionDef: Defining.read_function_definition,
        ast.AsyncFunctionDef: Defining.read_function_definition,
        ast.ClassDef: Defining.read_class_definition,
        **({ast.TypeAlias: Defining.read_type_alias} if sys.version_info >= (3, 12) else {}),
    }
