"""Reads what functions do, each with what it is known to receive, and again for what single calls pass."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.core import DEEPEST_RUN
from kb_build.flow.parameters import Parameters
from kb_build.flow.scopes import CHOSEN, Scope, State, kept, name_doubt
from kb_build.flow.texts import for_one_call, has_passed, texts_in, without_texts
from kb_build.flow.trees import default_values
from kb_build.flow.trials import Trials
from kb_build.flow.types import NONE, UNKNOWN, Given, Type, join

if TYPE_CHECKING:
    from kb_build.flow.definitions import FunctionDefinition

# How many different calls a function is read for, and how many more where their texts are left out.
_MOST_CALLS, _MOST_KINDS = 24, 8


class Functions(Parameters, Trials):
    """Runs functions: binds their parameters, and reads their bodies."""

    def run(self, number: int) -> None:
        """See :class:`core.Core`."""
        function = self.functions[number]
        function.running, function.stale, function.runs = True, False, function.runs + 1
        function.seen = self.stamp(function)
        function.readings = {}
        function.uses = set()
        function.carried = {}
        try:
            with self.inside(function.file or self.file, self._scope_of(function), function):
                self._read_function(function)
        finally:
            function.running = False

    def _scope_of(self, function: FunctionDefinition) -> Scope:
        file = function.file or self.file
        shared = file.shared_names.get(function.node, frozenset())
        return Scope(function.scope, state=State(doubted=function.doubted), shared=shared)

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

    # For single calls.

    def result_of_call(self, number: int, given: dict[str, Type], node: ast.Call) -> Type:
        """See :class:`core.Core`."""
        function = self.functions[number]
        whole = self._with_defaults(function, given)
        call = self._reading_for(number, whole)
        if call is None:
            return (UNKNOWN if function.stale else self.returned(number)) or UNKNOWN
        received, reading = call
        self.note(number, received, reading.returned)
        texts = [text for kind in whole.values() for text in texts_in(kind)]
        state = self.scope.state
        is_open = self.tolerant or state.doubts() or CHOSEN in state.doubted
        if not is_open and not any(has_passed(kind) for kind in whole.values()):
            asked_for = (name_doubt(str(text.value)) for text in texts)
            if state.doubted.isdisjoint(asked_for):
                self.reader.uses.add((number, received, node))
        return reading.returned or UNKNOWN

    def _with_defaults(self, function: FunctionDefinition, given: dict[str, Type]) -> dict[str, Type]:
        """What each parameter receives from a call, its default where that gives nothing."""
        arguments = function.node.args
        defaults = default_values(arguments)
        types = function.file.types if function.file else self.types
        found: dict[str, Type] = {}
        for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
            if argument.arg in given:
                found[argument.arg] = kept(given[argument.arg])
            elif (default := defaults.get(argument.arg)) is not None:
                found[argument.arg] = types.get(default, UNKNOWN)
        return found

    def _reading_for(self, number: int, whole: dict[str, Type]) -> tuple[Given, FunctionDefinition] | None:
        """A reading of a function for what one call passes, or for calls like it where there are too many."""
        function = self.functions[number]
        exact = tuple((name, for_one_call(kind)) for name, kind in whole.items())
        alike = tuple((name, without_texts(kind)) for name, kind in whole.items())
        unknown = tuple((name, UNKNOWN) for name in whole)
        for received, most in ((exact, _MOST_CALLS), (alike, _MOST_CALLS + _MOST_KINDS), (unknown, 0)):
            known = function.calls.get(received)
            if known is not None:
                return received, known
            if len(function.calls) < most or received is unknown:
                call = self._read_call(number, received)
                if call is None:
                    return None
                function.calls[received] = call
                return received, call
        return None

    def read_calls_again(self, number: int) -> None:
        """Reads a function, which was read again for all its calls, again for each of them."""
        function = self.functions[number]
        for received in function.calls:
            again = self._read_call(number, received)
            if again is None:  # too much to read: it may return anything that it returns to any call
                again = replace(function.calls[received], returned=function.returned, uses=set(), carried={})
            function.calls[received] = again

    def _read_call(self, number: int, received: Given) -> FunctionDefinition | None:
        """A function as it is for one call; None where that is too deep inside, or too much."""
        function = self.functions[number]
        file = function.file or self.file
        if self._is_alone(function, received):
            return replace(function, uses=set(), carried={}, calls={}, exact=True)
        if function.running or self.depth >= DEEPEST_RUN:
            return None
        call = replace(
            function,
            received=dict(received),
            unknown={name for name, kind in received if kind is UNKNOWN},
            returned=None,
            readings={},
            uses=set(),
            carried={},
            calls={},
            exact=True,
        )
        function.running = True
        try:
            with self.inside(file, self._scope_of(function), call):
                is_read = self.try_reading(lambda: self._read_function(call))
        finally:
            function.running = False
        return call if is_read else None

    @staticmethod
    def _is_alone(function: FunctionDefinition, received: Given) -> bool:
        """Whether a function was read for all its calls, and they are all like this one, without any text."""
        if function.stale or any(True for _, kind in received for _ in texts_in(kind)):
            return False
        given = dict(received)
        return all(
            name in given and for_one_call(kind) == given[name] for name, kind in function.received.items()
        ) and all(given.get(name) is UNKNOWN for name in function.unknown)
