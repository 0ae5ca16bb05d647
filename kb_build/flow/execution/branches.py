"""Reads statements of which one way is taken: ``if`` and ``match``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.expressions import is_decided
from kb_build.flow.evaluation.guards import Guards, assigned_names
from kb_build.flow.execution.ways import Ways
from kb_build.flow.state.doubts import CHOSEN, EVERYTHING, as_source
from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import UNKNOWN, Type, literal

if TYPE_CHECKING:
    from kb_build.flow.state.scopes import State


class Branches(Guards, Ways):
    """Reads ``if`` and ``match``; each reader tells whether the next statement can be reached."""

    def read_if(self, node: ast.If) -> bool:
        """Reads ``if``: both ways, unless this Blender decides for one."""
        test = self.evaluate(node.test)
        # Only another version's code is left out: a switch may be set by whoever reads the script.
        truth = literal(test) if is_decided(test) else None
        asked = self.asked(node.test, chooses=True) if truth is None else EVERYTHING
        before = self.here.scope.state
        ways: list[State | None] = []
        for holds, body in ((True, node.body), (False, node.orelse)):
            if isinstance(truth, bool) and truth is not holds:
                self.here.file.left_out.update(body)
                continue
            self.here.scope.state = self.copied(before)
            self.narrow(node.test, holds=holds, asked=asked)
            ways.append(self.way(self.here.scope.state, body))
        reached = self.meet(ways, before)
        if None not in ways:
            self.here.scope.state.doubted = before.doubted
        if flags := assigned_names([*node.body, *node.orelse]):
            self.tell(flags, as_source(asked), decided=truth is not None)
        return reached

    def read_match(self, node: ast.Match) -> bool:
        """Reads ``match``: each case with what it tells of the subject."""
        subject = self.evaluate(node.subject)
        # A case notes what it tells at the subject's own parts, which all cases share.
        types = self.here.types
        parts = {
            part: types[part] for part in walk(node.subject) if isinstance(part, ast.expr) and part in types
        }
        before = self.here.scope.state
        otherwise = self.copied(before)
        otherwise.doubted |= self.asked(node.subject) | CHOSEN
        ways: list[State | None] = []
        whole = False
        for case in node.cases:
            self.here.scope.state = self.copied(otherwise)
            types.update(parts)
            self._bind_pattern(case.pattern, subject, node.subject)
            if case.guard is not None:
                self.evaluate(case.guard)
                self.narrow(case.guard, holds=True)
            whole = whole or (
                isinstance(case.pattern, ast.MatchAs) and case.pattern.pattern is None and not case.guard
            )
            ways.append(self.way(self.here.scope.state, case.body))
        if not whole:
            ways.append(otherwise)
        reached = self.meet(ways, before)
        if None not in ways:
            self.here.scope.state.doubted = before.doubted
        flags = assigned_names(part for case in node.cases for part in case.body)
        self.tell(flags, as_source(self.asked(node.subject)))
        return reached

    def _bind_pattern(self, pattern: ast.pattern, subject: Type, node: ast.expr) -> None:
        if isinstance(pattern, ast.MatchValue):
            self.evaluate(pattern.value)
            self.check_value(subject, pattern.value, "compared")
            compared = ast.Compare(node, [ast.Eq()], [pattern.value])
            self.narrow(compared, holds=True)
            return
        for part in walk(pattern):
            match part:
                case ast.MatchValue(value=value) | ast.MatchClass(cls=value):
                    self.evaluate(value)
                case ast.MatchMapping(keys=keys):
                    for key in keys:
                        self.evaluate(key)
                case _:
                    pass
            name = getattr(part, "name", None) or getattr(part, "rest", None)
            if isinstance(name, str):
                self.bind(name, UNKNOWN)
