"""Reads what functions do, each with what it is known to receive, and again for what single calls pass."""

from __future__ import annotations

import ast
from contextlib import nullcontext
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.execution.parameters import Parameters
from kb_build.flow.state.core import DEEPEST_RUN
from kb_build.flow.state.scopes import Scope, State, kept
from kb_build.flow.state.trials import Trials
from kb_build.flow.syntax.shared_names import NONE_SHARED
from kb_build.flow.syntax.trees import default_values
from kb_build.flow.values.texts import for_one_call, has_passed, has_texts, texts_in, without_texts
from kb_build.flow.values.type_parts import HOLDING, by_names, parts
from kb_build.flow.values.types import (
    NONE,
    UNKNOWN,
    Given,
    Instance,
    NoneValue,
    Plain,
    Type,
    Union,
    Unknown,
    join,
)

if TYPE_CHECKING:
    from kb_build.flow.state.definitions import FunctionDefinition
    from kb_build.flow.state.place import Place

# How many different calls a function is read for, and how many more where their texts are left out.
_MOST_CALLS, _MOST_KINDS = 24, 8
_MOST_TURNS = 3  # in which a function is read that asks what it returns itself
_MOST_IN_VAIN = 2  # readings for single calls, one after the other, that bring no more than that for all


class Functions(Parameters, Trials):
    """Runs functions: binds their parameters, and reads their bodies."""

    def run(self, number: int) -> None:
        """See :class:`core.Core`."""
        function = self.functions[number]
        function.runs += 1
        for _ in range(_MOST_TURNS):
            before = function.returned
            self._run_once(function)
            asks_itself = any(asked == number for asked, _ in function.readings)
            if not asks_itself or function.returned == before:
                break

    def _run_once(self, function: FunctionDefinition) -> None:
        function.running, function.stale = True, False
        function.seen = self.stamp(function)
        function.readings = {}
        function.uses = {}
        function.carried = {}
        place = self._place_of(function)
        try:
            with self.charged_to(place.file) if not self.here.tries else nullcontext(), self.at(place):
                self._read_function(function)
        finally:
            function.running = False

    def _place_of(self, function: FunctionDefinition) -> Place:
        file = function.file or self.here.file
        shared = file.shared_names.get(function.node, NONE_SHARED)
        scope = Scope(function.scope, state=State(doubted=function.doubted), shared=shared)
        return self.here.further(file, scope, function)

    def _read_function(self, function: FunctionDefinition) -> None:
        self.bind_parameters(function)
        if isinstance(function.node, ast.Lambda):
            function.returned = self.evaluate(function.node.body)
        elif self.read_body(function.node.body) and function.returned is not None:
            function.returned = join(function.returned, NONE)
        if not isinstance(function.node, ast.Lambda) and function.node.returns is not None:
            self.here.statement = None
            declared = self.annotated(function.node.returns)
            if declared is not UNKNOWN and function.returned in {UNKNOWN, None}:
                function.returned = declared

    def stamp(self, function: FunctionDefinition) -> tuple[int, int]:
        """What changes when a function should be read again: its module's names, its class's attributes."""
        module = function.file.module if function.file else self.here.file.module
        return module.changes, self.classes[function.cls].changes if function.cls is not None else 0

    # For single calls.

    def result_of_call(self, number: int, given: dict[str, Type], node: ast.Call) -> Type:
        """See :class:`core.Core`."""
        function = self.functions[number]
        whole = self._with_defaults(function, given)
        with_texts = any(map(has_texts, whole.values()))
        follows = with_texts and self._comes_surely(whole)
        returned = function.returned
        is_known = not function.stale and self._is_one(returned, with_texts=with_texts)
        if is_known and not follows:
            return self.returned(number) or UNKNOWN
        received = _as_one_call(function, whole)
        if follows:
            self.reader.uses[number, received, node] = None
        is_read_again = function.stale and self.rounds and not (self.settled or self.here.tries)
        if not is_read_again and (
            function.stale
            or (not is_known and function.in_vain < _MOST_IN_VAIN and _tells_more(function, received))
        ):
            is_new = received not in function.calls
            call = self.reading_for(number, received)
            if is_new and not function.stale:
                brought = call is not None and call.returned != returned
                function.in_vain = 0 if brought else function.in_vain + 1
            returned = call.returned if call else UNKNOWN if function.stale else returned
        self.note(number, received, returned)
        return returned or UNKNOWN

    def returns_still(self, number: int, received: Given, kind: Type | None) -> bool:
        """Whether a function is still known to return something to a call that passes this."""
        function = self.functions[number]
        if function.stale and not self.settled:
            return True  # it is read again first
        if function.returned == kind and not function.stale:
            return True
        if kind is UNKNOWN and (self.settled or not _may_help(function.returned)):
            return True  # of what nothing was known, nothing was found missing
        call = self.reading_for(number, received) if self.settled else function.calls.get(received)
        return call is not None and call.returned == kind

    def _with_defaults(self, function: FunctionDefinition, given: dict[str, Type]) -> dict[str, Type]:
        """What each parameter receives from a call, its default where that gives nothing."""
        arguments = function.node.args
        defaults = default_values(arguments)
        types = function.file.types if function.file else self.here.types
        found: dict[str, Type] = {}
        for argument in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs):
            if argument.arg in given:
                found[argument.arg] = kept(given[argument.arg])
            elif (default := defaults.get(argument.arg)) is not None:
                found[argument.arg] = types.get(default, UNKNOWN)
        if arguments.kwarg is not None:
            named = {argument.arg for argument in (*arguments.args, *arguments.kwonlyargs)}
            further = {name: kept(kind) for name, kind in given.items() if name not in named}
            found[arguments.kwarg.arg] = by_names(further)
        return found

    def _comes_surely(self, whole: dict[str, Type]) -> bool:
        """Whether a call surely happens where it is read, with texts that are those of this call."""
        doubted = self.here.scope.state.doubted
        if self.here.caught or doubted.everything or doubted.chosen or any(map(has_passed, whole.values())):
            return False
        texts = (str(text.value) for kind in whole.values() for text in texts_in(kind))
        return not doubted.members or doubted.members.isdisjoint(texts)

    def _is_one(self, kind: Type | None, *, with_texts: bool) -> bool:
        """Whether a type is one thing, or none that has members, and no text may decide more of it: no call is known to
        return more than all do.
        """
        match kind:
            case None:
                return True
            case Unknown():
                return False
            case Instance():
                return not (with_texts and self.api.descendants(kind.cls))
            case _:
                things = list(filter(_has_things, parts(kind)))
                is_choice = isinstance(kind, Union) and len(things) > 1
                return not is_choice and all(self._is_one(one, with_texts=with_texts) for one in things)

    def reading_for(self, number: int, received: Given) -> FunctionDefinition | None:
        """A function as it is for one call; None where that is too deep inside, or too much to read."""
        function = self.functions[number]
        known = function.calls.get(received)
        # While its module is read, what a function returned before is what it returns.
        if known is not None and (not self.rounds or known.seen == self.stamp(function)):
            return known
        call = self._read_call(number, received)
        if call is None:
            function.calls.pop(received, None)
            return None
        function.calls[received] = call
        return call

    def _read_call(self, number: int, received: Given) -> FunctionDefinition | None:
        function = self.functions[number]
        if function.running or self.here.depth >= DEEPEST_RUN:
            return None
        if not self.may_try(function.file or self.here.file):
            return None
        call = replace(
            function,
            received=dict(received),
            unknown={name for name, kind in received if kind is UNKNOWN},
            returned=None,
            readings={},
            uses={},
            carried={},
            calls={},
            exact=True,
            seen=self.stamp(function),
        )
        function.running = True
        try:
            with self.at(replace(self._place_of(function), function=call)):
                is_read = self.try_reading(lambda: self._read_function(call))
        finally:
            function.running = False
        return call if is_read else None


def _as_one_call(function: FunctionDefinition, whole: dict[str, Type]) -> Given:
    """What one call passes; of too many calls, without the texts, or without anything."""
    exact = tuple((name, for_one_call(kind)) for name, kind in whole.items())
    if exact in function.passed or len(function.passed) < _MOST_CALLS:
        function.passed.add(exact)
        return exact
    alike = tuple((name, without_texts(kind)) for name, kind in whole.items())
    if alike in function.passed or len(function.passed) < _MOST_CALLS + _MOST_KINDS:
        function.passed.add(alike)
        return alike
    return tuple((name, UNKNOWN) for name in whole)


def _tells_more(function: FunctionDefinition, received: Given) -> bool:
    """Whether one call passes anything that is more than what is known of all calls."""
    return any(
        kind is not UNKNOWN
        and (
            name in function.unknown
            or has_texts(kind)
            or for_one_call(function.received.get(name, UNKNOWN)) != kind
        )
        for name, kind in received
    )


def _may_help(kind: Type | None) -> bool:
    """Whether it may be worth reading something again where it now knows this, and nothing before."""
    return kind is not None and (isinstance(kind, Plain) or _has_things(kind))


def _has_things(kind: Type) -> bool:
    """Whether a type has more than plain values, and what is not known, in it."""
    if isinstance(kind, HOLDING):
        return any(map(_has_things, parts(kind)))
    return not isinstance(kind, (Unknown, Plain, NoneValue))
