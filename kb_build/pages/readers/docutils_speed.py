"""docutils and Sphinx without the work that they repeat for every page and every nested block."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any
from unittest import mock

import sphinx.util.docutils
from docutils.frontend import Values
from docutils.parsers.rst.states import RSTStateMachine

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

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


@contextmanager
def less_repeated() -> Generator[None]:
    """Within this context states are made when needed, and the settings of pages are worked out once.

    Else docutils makes all states for every list, definition and directive, and Sphinx a parser of command-line
    options for every page: together a third of the time that the manual takes to parse.
    """
    original = sphinx.util.docutils._get_settings
    known: dict[str, Any] = {}

    def get_settings(*components: Any, defaults: Any, read_config_files: bool = False) -> Values:
        # Of one application: its parser and its settings are always the same.
        if not known:
            made = original(*components, defaults=defaults, read_config_files=read_config_files)
            known.update(made.__dict__)
        return Values({**known, "record_dependencies": None})

    with (
        mock.patch.object(RSTStateMachine, "add_states", _add_states),
        mock.patch.object(sphinx.util.docutils, "_get_settings", get_settings),
    ):
        yield
