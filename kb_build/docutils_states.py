"""docutils' parser without the states that a text does not enter, and without searches that find nothing."""

from __future__ import annotations

from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any
from unittest import mock

from docutils.parsers.rst.states import Inliner, RSTStateMachine
from docutils.statemachine import StateWS

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from re import Match, Pattern

    from docutils.statemachine import State


class _States(dict[str, "State[Any]"]):
    """The states of a state machine by name, each made when it is entered first.

    A nested block enters one or two of the fifteen, and making a state takes longer than parsing most blocks.
    """

    def __init__(self, machine: RSTStateMachine, classes: Sequence[type[State[Any]]]) -> None:
        super().__init__()
        self._machine = machine
        self._classes = classes

    def __missing__(self, name: str) -> State[Any]:
        made = next((each for each in self._classes if each.__name__ == name), None)
        if made is None:
            raise KeyError(name)
        state = self[name] = made(self._machine, self._machine.debug)
        if getattr(self._machine, "memo", None) is not None:  # it is running: the others are ready
            state.runtime_init()
        return state


def _add_states(machine: RSTStateMachine, classes: Sequence[type[State[Any]]]) -> None:
    machine.states = _States(machine, classes)


@cache
def _transitions_known() -> Callable[[Any], None]:
    """What gives a new state its transitions: name → (pattern, the state's method of that name, next state).

    docutils puts them together for every state; they are the same for all states of a class.
    """
    make: Callable[[Any], None] = StateWS.add_initial_transitions
    known: dict[type, list[tuple[str, Pattern[str], str]]] = {}

    def add_initial_transitions(state: Any) -> None:
        rows = known.get(type(state))
        if rows is None:
            make(state)
            made = state.transitions
            known[type(state)] = [(name, made[name][0], made[name][2]) for name in state.transition_order]
        else:
            state.transition_order = [name for name, _, _ in rows]
            state.transitions = {
                name: (pattern, getattr(state, name), after) for name, pattern, after in rows
            }

    return add_initial_transitions


class _Sought:
    """A pattern that is looked for only in texts with one of the ``signs`` that every match has in it.

    Nine texts in ten have none, and the pattern would be tried at each of their characters.
    """

    def __init__(self, pattern: Pattern[str], signs: str) -> None:
        self.match = pattern.match
        self._search = pattern.search
        self._signs = signs

    def search(self, text: str) -> Match[str] | None:
        for sign in self._signs:
            if sign in text:
                return self._search(text)
        return None


@cache
def _patterns_known() -> Callable[[Any, Any], None]:
    """What gives a new parser of inline markup its patterns, which docutils puts together for every text."""
    make: Callable[[Any, Any], None] = Inliner.init_customizations
    known: dict[tuple[Any, ...], tuple[dict[str, Any], list[tuple[Any, str]]]] = {}

    def init_customizations(inliner: Any, settings: Any) -> None:
        names = ("character_level_inline_markup", "pep_references", "rfc_references")
        key = type(inliner), *(getattr(settings, name, None) for name in names)
        if key not in known:
            make(inliner, settings)
            made = vars(inliner).copy()
            dispatch = [(pattern, method.__name__) for pattern, method in made.pop("implicit_dispatch")]
            patterns = made["patterns"]
            # What begins inline markup or ends a reference; an address has a scheme, or a place.
            patterns.initial, uri = _Sought(patterns.initial, "*`_|"), _Sought(patterns.uri, ":@")
            known[key] = (
                made,
                [(uri if pattern is patterns.uri else pattern, name) for pattern, name in dispatch],
            )
        made, dispatch = known[key]
        vars(inliner).update(made)
        inliner.implicit_dispatch = [(pattern, getattr(inliner, name)) for pattern, name in dispatch]

    return init_customizations


@contextmanager
def states_when_entered() -> Generator[None]:
    """Within this context docutils makes the states of its parsers when they are entered, and looks for inline markup
    where there can be some, which changes no result.

    Else it makes all fifteen states for every list, definition and directive: a quarter of the time that parsing takes.
    """
    with (
        mock.patch.object(RSTStateMachine, "add_states", _add_states),
        mock.patch.object(StateWS, "add_initial_transitions", _transitions_known()),
        mock.patch.object(Inliner, "init_customizations", _patterns_known()),
    ):
        yield
