"""Evaluates calls of what the script defines: passes on what they give, and reads what is called."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.narrowing import Narrowing
from kb_build.flow.state.core import DEEPEST_RUN
from kb_build.flow.syntax.trees import taken_out_of
from kb_build.flow.values.texts import lessened, passed
from kb_build.flow.values.type_parts import HOLDING, bounded
from kb_build.flow.values.types import UNKNOWN, LocalClass, LocalFunction, LocalInstance, Type, general, join

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.flow.calls.read_calls import Keywords, ReadCall
    from kb_build.flow.state.definitions import FunctionDefinition

_MOST_RUNS = 3


class ScriptCalls(Narrowing):
    """Evaluates calls of the script's functions and classes."""

    def call_local_class(self, callee: LocalClass, call: ReadCall) -> Type:
        """An instance of a class of the script; its ``__init__`` receives what it is given."""
        instance = LocalInstance(callee.number)
        made = self.class_attribute(callee.number, "__init__")
        if made and isinstance(made[0], LocalFunction):
            self.pass_to(made[0].number, [instance, *call.arguments], call.keywords)
            self.run_now(made[0].number)
        elif fields := self.classes[callee.number].fields:
            self._make_with(callee.number, fields, call)
        return instance

    def _make_with(self, number: int, fields: tuple[str, ...], call: ReadCall) -> None:
        """What an instance of a data class is made with is what its fields hold, besides what they have by default."""
        definition = self.classes[number]
        if "" in call.keywords or any(isinstance(given, ast.Starred) for given in call.node.args):
            for name in fields:
                definition.bind(name, general(definition.attributes.get(name, UNKNOWN)))
            return
        for name, kind in {**dict(zip(fields, call.arguments, strict=False)), **call.keywords}.items():
            definition.bind(name, kind)

    def call_local_function(self, callee: LocalFunction, call: ReadCall) -> Type:
        """What a function of the script returns; it receives what it is given."""
        function = self.functions[callee.number]
        has_starred = any(isinstance(argument, ast.Starred) for argument in call.node.args)
        values = [] if has_starred else call.arguments
        if callee.receiver is not None:
            values = [callee.receiver, *values]
        given = self.pass_to(callee.number, values, call.keywords)
        self.run_now(callee.number)
        self._take_out(function, call, bound=callee.receiver is not None)
        if has_starred or "" in given or function.running:
            # What it returns is not known where it was not read with what this call passes.
            is_read = function.running or not function.stale
            return (self.returned(callee.number) if is_read else None) or UNKNOWN
        return self.result_of_call(callee.number, given, call.node)

    def _take_out(self, function: FunctionDefinition, call: ReadCall, *, bound: bool) -> None:
        """A list or a dictionary that a function takes something out of has less behind the call."""
        if function.takes_out is None:
            function.takes_out = taken_out_of(function.node)
        if not function.takes_out:
            return
        parameters = function.node.args
        names = [argument.arg for argument in (*parameters.posonlyargs, *parameters.args)][bound:]
        given = [*zip(names, call.node.args, strict=False)]
        given += [(keyword.arg, keyword.value) for keyword in call.node.keywords if keyword.arg]
        for name, node in given:
            kind = self.here.types.get(node, UNKNOWN)
            if name in function.takes_out and isinstance(kind, HOLDING):
                self.fill(node, lessened(kind))

    def run_now(self, number: int) -> None:
        """Reads a function for what it returns, or for what it binds, unless it is known or too far inside."""
        function = self.functions[number]
        if (
            function.stale
            and not self.here.tries
            and not function.running
            and self.here.depth < DEEPEST_RUN
            and function.runs < _MOST_RUNS
        ):
            self.run(number)

    def pass_to(self, number: int, values: Iterable[Type], keywords: Keywords) -> dict[str, Type]:
        """Adds what a call passes to what a function is known to receive; gives it by parameter."""
        function = self.functions[number]
        parameters = function.node.args
        names = [argument.arg for argument in (*parameters.posonlyargs, *parameters.args)]
        given = {**dict(zip(names, values, strict=False)), **keywords}
        if not self.here.tries:  # where it is read again, what it passes is a part of what it passed before
            for name, kind in given.items():
                if name:
                    self._receive(function, name, passed(kind))
        return given

    @staticmethod
    def _receive(function: FunctionDefinition, name: str, kind: Type) -> None:
        kind = bounded(kind)
        before = function.received.get(name)
        if kind is UNKNOWN and name not in function.unknown:
            function.unknown.add(name)
            function.stale = True
        if before is None or before is UNKNOWN:
            after = kind
        elif kind is UNKNOWN:
            return
        else:
            after = join(before, kind)
        if after != before:
            function.received[name] = after
            if kind is not UNKNOWN:
                function.stale = True
