"""Pointers that are None on new things, and what fills them before something is set on what they lead to."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbol_lines import empty_when_new, fillers
from kb_serve.answer.steps.variable_names import class_called
from kb_serve.reader import TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.records import Symbol
    from kb_serve.answer.steps.working_object import WorkingObject
    from kb_serve.reader import BaseReader

_FIRST_WORD = re.compile(r"^(?!bpy\b|obj\b|scene\b)[a-z_]+\.(?=\w+(?: = |\())")


class Ready(NamedTuple):
    """An expression, and the steps after which it can be evaluated."""

    steps: list[str]
    expression: str


def stays_empty(pointer: Symbol) -> bool:
    """Whether a pointer is None on new things, and nothing is known to fill it."""
    return empty_when_new(pointer) is not None and not fillers(pointer)


class PointerFills:
    """The pointers that one list of steps fills."""

    def __init__(self, reader: BaseReader, obj: WorkingObject) -> None:
        self._reader = reader
        self._obj = obj
        self._filled: set[str] = set()
        self._chosen: set[str] = set()  # settings by whose value something is made

    def steps(self, pointer: Symbol, above: str) -> list[str]:
        """The step that fills a pointer of ``above``; none if it is there or filled."""
        calls = self._calls(pointer, above)
        # One value of a setting makes one thing, another value the next, in place of the first.
        choices = {call.partition(" = ")[0] for call in calls if " = " in call}
        elsewhere = "on another object: " if choices & self._chosen else ""
        self._chosen |= choices
        return [elsewhere + _step(calls, f"{above}.{pointer.name}")] if calls else []

    def reach(self, expression: str) -> Ready | None:
        """An expression, and what fills pointers on its way that are None on new things; None where one stays so."""
        steps: list[str] = []
        before = set(self._filled), set(self._chosen)
        above, *names = expression.split(".")
        owner = class_called(above)
        for name in names:
            entry = self._reader.member([one.path for one in self._reader.lineage(owner)], name)
            pointer = self._reader.symbol(entry.path) if entry and entry.type == "pointer" else None
            if pointer is None:
                break  # of what a subclass has nothing is known here
            if stays_empty(pointer):
                self._filled, self._chosen = before  # nothing is told
                return None
            if calls := self._calls(pointer, above):
                steps.append(_step(calls, f"{above}.{name}"))
            above, owner = f"{above}.{name}", f"{TYPES}{pointer.target}"
        return Ready(steps, expression)

    def _calls(self, pointer: Symbol, above: str) -> list[str]:
        expression = f"{above}.{pointer.name}"
        calls = fillers(pointer) if empty_when_new(pointer) else []
        if expression in self._filled or not calls:
            return []
        self._filled.add(expression)
        calls = [_FIRST_WORD.sub(f"{above}.", call) for call in calls]
        needs_active = any(call.startswith("bpy.ops.") for call in calls)
        return [*(self._obj.activation() if needs_active else ()), *calls]


def _step(calls: Iterable[str], expression: str) -> str:
    return f"{', then '.join(f'`{call}`' for call in calls)} makes `{expression}`"
