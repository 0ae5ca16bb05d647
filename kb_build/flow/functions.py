"""Reads what functions do, each with what it is known to receive."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.parameters import Parameters
from kb_build.flow.scopes import Scope, State
from kb_build.flow.types import NONE, UNKNOWN, join

if TYPE_CHECKING:
    from kb_build.flow.definitions import FunctionDefinition


class Functions(Parameters):
    """Runs functions: binds their parameters, and reads their bodies."""

    def run(self, number: int) -> None:
        """See :class:`core.Core`."""
        function = self.functions[number]
        function.running, function.stale, function.runs = True, False, function.runs + 1
        function.seen = self.stamp(function)
        function.readings = {}
        try:
            file = function.file or self.file
            shared = file.shared_names.get(function.node, frozenset())
            scope = Scope(function.scope, state=State(doubted=function.doubted), shared=shared)
            with self.inside(file, scope, function):
                self._read_function(function)
        finally:
            function.running = False

    def _read_function(self, function: FunctionDefinition) -> None:
        self.bind_parameters(function)
        if isinstance(function.node, ast.Lambda):
            function.returned = self.evaluate(function.node.body)
        elif self.read_body(function.node.body) and function.returned is not None:
            function.returned = join(function.returned, NONE)
        if not isinstance(function.node, ast.Lambda) and function.node.returns is not None:
            self.statement = None
            declared = self.annotated(function.node.returns)
            if declared is not UNKNOWN and function.returned in {UNKNOWN, None}:
                function.returned = declared

    def stamp(self, function: FunctionDefinition) -> tuple[int, int]:
        """What changes when a function should be read again: its module's names, its class's attributes."""
        module = function.file.module if function.file else self.file.module
        return module.changes, self.classes[function.cls].changes if function.cls is not None else 0
