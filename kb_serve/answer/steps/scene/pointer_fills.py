"""Pointers that are None on new things, and what fills them before something is set on what they lead to."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import BLEND_DATA, OBJECT, OPERATORS, TYPES
from kb_build.symbols.flag_names import FILLED_ON, READ_ONLY
from kb_build.symbols.flags import empty_when_new, fillers
from kb_serve.answer.steps.names.variable_names import OBJ, class_called

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kb_build.symbols.records import Symbol
    from kb_serve.answer.steps.names.variable_names import VariableNames
    from kb_serve.answer.steps.scene.working_object import WorkingObject
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

_FIRST_WORD = re.compile(r"^(?!bpy\b|obj\b|scene\b)[a-z_]+\.(?=\w+(?: = |\())")
_PARTS = re.compile(r"\.(?![^\[]*\])")  # between names, and not in a key
_DATA = "data"


class Ready(NamedTuple):
    """An expression, and the steps after which it can be evaluated."""

    steps: list[str]
    expression: str


class _Made(NamedTuple):
    """A new element: its class, what it is called, and the step that makes it."""

    cls: str
    variable: str
    step: str


def stays_empty(pointer: Symbol) -> bool:
    """Whether a pointer is None on new things, and nothing is known to fill it."""
    return empty_when_new(pointer) is not None and not fillers(pointer)


class PointerFills:
    """The pointers that one list of steps fills."""

    def __init__(self, reader: BaseReader, obj: WorkingObject, variables: VariableNames) -> None:
        self._reader = reader
        self._obj = obj
        self._variables = variables
        self._filled: set[str] = set()
        self._chosen: dict[str, str] = {}  # setting by whose value something is made → what it has made last
        self._called: set[str] = set()
        self._whole: set[str] = set()  # what an operator made with all that a new one has

    def steps(self, pointer: Symbol, above: str) -> list[str]:
        """The step that fills a pointer of ``above``; none if it is there or filled."""
        calls = self._calls(pointer, above)
        expression = f"{above}.{pointer.name}"
        self._chosen |= dict.fromkeys(_choices(calls), expression)
        return [_step(calls, expression)] if calls else []

    def is_in_place(self, pointer: Symbol, above: str) -> bool:
        """Whether one value of a setting fills a pointer of ``above``, of which another value has filled one."""
        calls = [_FIRST_WORD.sub(f"{above}.", call) for call in fillers(pointer)]
        return any(
            self._chosen.get(one, "") not in {"", f"{above}.{pointer.name}"} for one in _choices(calls)
        )

    def note(self, call: str) -> None:
        """Notes that a step has made a call, whatever its arguments."""
        self._called.add(call.partition("(")[0])

    def calls(self, calls: Iterable[str]) -> list[str]:
        """The steps that make some calls, of those that no step has made."""
        left = [call for call in calls if self._called.isdisjoint({call, call.partition("(")[0]})]
        self._called.update(left)
        return [f"`{call}`" for call in left]

    def setting(self, expression: str, value: bool | str) -> list[str]:
        """The step that sets something, if none has; where one has set it otherwise, it is done instead of that."""
        is_other = any(call.startswith(f"{expression} = ") for call in self._called)
        return [
            ("instead: " if is_other else "") + step for step in self.calls([f"{expression} = {value!r}"])
        ]

    def reach(self, expression: str, *, adds: bool = True, makes: bool = False) -> Ready | None:
        """An expression, and what fills pointers on its way that are None on new things; None where one stays so.

        ``adds``: whether an operator may add an element that is on its way; ``makes``: whether a function of the object
        may make one, as a modifier.
        """
        before = self._state()
        restore = (self._obj.restoring(), self._variables.restoring())
        ready = self._reach(expression, adds=adds, makes=makes)
        if ready is None:  # nothing is told
            self._filled, self._chosen, self._called, self._whole = before
            for undo in restore:
                undo()
        return ready

    def loading(self, cls: str) -> str:
        """The call that loads a data-block which nothing but a file makes, as a film; empty for none."""
        for entry in self._reader.names.by_name("load"):
            symbol = self._reader.symbol(entry.path)
            holders = self._reader.members(BLEND_DATA).values()
            holder = next((one.name for one in holders if f"{TYPES}{one.collection}" == entry.owner), "")
            if symbol is not None and holder and any(result.type == cls for result in symbol.returns):
                return f"bpy.data.{holder}.load(filepath)"
        return ""

    def _state(self) -> tuple[set[str], dict[str, str], set[str], set[str]]:
        return set(self._filled), dict(self._chosen), set(self._called), set(self._whole)

    def _reach(self, expression: str, *, adds: bool, makes: bool) -> Ready | None:
        steps: list[str] = []
        above, *names = _PARTS.split(expression)
        owner = class_called(above) or self._variables.class_of(above)
        for place, part in enumerate(names):
            name, is_element, _ = part.partition("[")
            if (owner, name) == (OBJECT, _DATA):  # an empty one alone has none, and no step makes that
                above, owner = f"{above}.{name}", self._obj.data_class()
                continue
            entry = self._reader.member([one.path for one in self._reader.lineage(owner)], name)
            if is_element and makes and entry and (made := self._made(entry, above, part)):
                steps.append(made.step)
                above, owner = made.variable, made.cls
                continue
            if is_element:
                added = [] if above in self._whole else self._adding(entry) if entry and adds else None
                if entry is None or added is None:
                    return None
                steps += added
            elif entry is None or entry.type not in {"pointer", "collection"}:
                # Of what a subclass has nothing is known here; what an object's own data lacks it lacks.
                rest = ".".join((above, *names[place:]))
                is_lacking = entry is None and above.endswith(f".{_DATA}")
                return None if is_lacking or "[" in rest or "(" in rest else Ready(steps, rest)
            elif entry.type == "collection":
                above, owner = f"{above}.{part}", f"{TYPES}{entry.collection}"
                continue
            elif pointer := self._reader.symbol(entry.path):
                filled = self._filling(pointer, above)
                if filled is None:
                    return None
                steps += filled.steps
                above, owner = filled.expression, f"{TYPES}{pointer.target}"
                continue
            above, owner = f"{above}.{part}", f"{TYPES}{entry.target}"
        return Ready(steps, above)

    def _filling(self, pointer: Symbol, above: str) -> Ready | None:
        """What a pointer leads to, and what fills it where it is None on new things; None where it stays so."""
        expression = f"{above}.{pointer.name}"
        own = {_FIRST_WORD.sub(f"{above}.", call) for call in fillers(pointer)}
        if any(self._chosen.get(choice, expression) != expression for choice in _choices(own)):
            return None  # another value has been chosen
        if not stays_empty(pointer) or expression in self._filled:
            calls = self._calls(pointer, above)
            self._chosen |= dict.fromkeys(_choices(calls), expression)
            return Ready([_step(calls, expression)] if calls else [], expression)
        if above == OBJ and (calls := self._obj.filling(pointer.flagged(FILLED_ON))):
            self._filled.add(expression)
            self._whole |= {expression} if len(calls) > 1 else set()
            return Ready([_step(calls, expression)], expression)
        target = f"{TYPES}{pointer.target}"
        if there := self._variables.there(target):
            return Ready([], there)
        made = self._reader.makers.creations([target]).get(target)
        call = made.call if made else self.loading(pointer.target)
        if READ_ONLY in pointer.flags or not call.startswith("bpy.data."):
            return None
        variable = self._variables.of(target)
        self._variables.add(target, variable)
        return Ready([f"`{variable} = {call}`; `{expression} = {variable}`"], variable)

    def _made(self, collection: SymbolEntry, above: str, element: str) -> _Made | None:
        """What makes the element of the object's collection that a key names, of a kind that only has that; None if no
        such is known.
        """
        kinds = [kind.path for kind in self._reader.descendants(f"{TYPES}{collection.target}")]
        begins = f"{OBJ}.{collection.name}.new({element.partition('[')[2].rstrip(']')},"
        made = self._reader.makers.creations(kinds).items() if above == OBJ else ()
        cls, call = next(((kind, one.call) for kind, one in made if one.call.startswith(begins)), ("", ""))
        if not cls or call in self._called:
            return None
        self._called.add(call)
        variable = self._variables.of(cls)
        self._variables.add(cls, variable)
        return _Made(cls, variable, f"`{variable} = {call}` → `{cls.removeprefix(TYPES)}`")

    def _adding(self, collection: SymbolEntry) -> list[str] | None:
        """The steps by which an operator adds an element to a collection of the object; None if no such is known."""
        target = f"{TYPES}{collection.target}"
        made = self._reader.makers.creations([target]).get(target)
        if made is None or made.choice or not made.call.startswith(OPERATORS):
            return None
        if made.call in self._called:
            return []
        self._called.add(made.call)
        before = "; ".join(f"`{code}`" for code in self._obj.activation())
        return [*([before] if before else []), f"`{made.call}` → `{collection.target}`"]

    def _calls(self, pointer: Symbol, above: str) -> list[str]:
        expression = f"{above}.{pointer.name}"
        calls = fillers(pointer) if empty_when_new(pointer) else []
        if expression in self._filled or not calls:
            return []
        self._filled.add(expression)
        calls = [_FIRST_WORD.sub(f"{above}.", call) for call in calls]
        if calls[-1].partition("(")[0] in self._called:
            return []
        self._called.update(calls)
        needs_active = any(call.startswith(OPERATORS) for call in calls)
        return [*(self._obj.activation() if needs_active else ()), *calls]


def _choices(calls: Iterable[str]) -> set[str]:
    """The settings that some calls set."""
    return {call.partition(" = ")[0] for call in calls if " = " in call}


def _step(calls: Iterable[str], expression: str) -> str:
    return f"{', then '.join(f'`{call}`' for call in calls)} makes `{expression}`"
