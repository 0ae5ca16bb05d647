"""docutils' parser without the states that a text does not enter."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest import mock

from docutils.parsers.rst.states import RSTStateMachine
from docutils.statemachine import StateWS

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence
    from re import Pattern

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


@contextmanager
def states_when_entered() -> Generator[None]:
    """Within this context docutils makes the states of its parsers when they are entered, which changes no result.

    Else it makes all fifteen for every list, definition and directive: a quarter of the time that parsing takes.
    """
    with (
        mock.patch.object(RSTStateMachine, "add_states", _add_states),
        mock.patch.object(StateWS, "add_initial_transitions", _transitions_known()),
    ):
        yield
