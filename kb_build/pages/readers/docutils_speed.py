"""docutils without the work that it repeats for every nested block."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from docutils.statemachine import State

if TYPE_CHECKING:
    from collections.abc import Generator

    Transitions = dict[str, tuple[Any, Any, str]]


@contextmanager
def shared_transitions() -> Generator[None]:
    """Within this context docutils works out each state's table of transitions once per class.

    It does so for all 15 states at every list, definition and directive body otherwise, from constants of the
    class: a quarter of the time that the manual takes to parse. Only the methods have to be bound anew.
    """
    original = State.make_transitions
    tables: dict[tuple[type[State[Any]], int], tuple[Any, list[str], list[tuple[str, Any, str, str]]]] = {}

    def make_transitions(self: State[Any], name_list: Any) -> tuple[list[str], Transitions]:
        # The list is kept in the table, so that its id stays its own.
        key = (type(self), id(name_list))
        table = tables.get(key)
        if table is None:
            names, transitions = original(self, name_list)
            rows = [
                (name, pattern, method.__name__, state)
                for name, (pattern, method, state) in transitions.items()
            ]
            table = tables[key] = (name_list, names, rows)
        return table[1], {
            name: (pattern, getattr(self, method), state) for name, pattern, method, state in table[2]
        }

    State.make_transitions = make_transitions
    try:
        yield
    finally:
        State.make_transitions = original
