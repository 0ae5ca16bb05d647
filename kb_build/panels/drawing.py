"""Reads a function that draws: where it shows a property, and under which conditions it does so and can be set.
Buttons of operators are read as properties are: where they are shown, and can be pressed.

A layout's ``active`` and ``enabled`` count for all that is drawn in it, whenever they are set: Blender looks at the
last value once the function is through, and hands it down to the layouts within.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import UNKNOWN, Instance, literal_texts
from kb_build.panels.expressions import Conditions, Held, is_unknown
from kb_build.panels.formulas import FALSE, TRUE, Formula, all_of, chosen, either_of, is_large, negated
from kb_build.panels.layout_calls import MAKES_LAYOUT, OFFERS, SHOWS, shown_property
from kb_build.symbols.api_names import OPERATORS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from kb_build.panels.expressions import Script

_LAYOUT = "bpy.types.UILayout"
_STATES = ("active", "enabled")
_DEEPEST_CALL = 3
_LONGEST_TEXT = 300


@dataclass(frozen=True, slots=True)
class Place:
    """Where a property is shown: the ones that it can be, what they are read from, and two conditions.

    ``shown`` holds where it is there at all, ``active`` where it can be set as well. ``name`` is the property's last
    part; ``symbols`` is empty where nobody knows whose property it is. Of an operator, ``owner`` is empty.
    """

    name: str
    symbols: tuple[str, ...]
    owner: str
    shown: Formula
    active: Formula


@dataclass(slots=True)
class _State:
    """What holds at one place of a function: the condition to be there, names, and what layouts were set to."""

    path: Formula
    names: dict[str, Held]
    set_to: dict[tuple[int, str], Formula]

    def copy(self) -> _State:
        return _State(self.path, self.names.copy(), self.set_to.copy())


@dataclass(slots=True)
class _Exit:
    """A place where a function ends, and how many properties it had shown before."""

    state: _State
    value: Formula
    shown: int


@dataclass(slots=True)
class _Shown:
    name: str
    symbols: tuple[str, ...]
    owner: str
    layout: int | None
    path: Formula


class Drawing(Conditions):
    """One reading of a function."""

    def __init__(self, script: Script, cls: str = "", depth: int = 0) -> None:
        super().__init__(script, cls)
        self._depth = depth
        self._state = _State(TRUE, self.names, {})
        self._parents: list[int | None] = []  # of each layout
        self._stand_ins: dict[int, tuple[int, int]] = {}  # layout → those that it may be another name of
        self._made: dict[ast.Call, int] = {}
        self._roots: dict[str, int] = {}
        self._shown: list[_Shown] = []
        self._exits: list[_Exit] = []
        self._jumps: list[list[_State]] = []  # out of the rounds of the loops around

    def read(self, function: ast.FunctionDef, path: Formula) -> list[Place]:
        """The places where a function shows properties; ``path`` holds when it is called."""
        self._state.path = path
        self._finish(function.body)
        return [self._place(number, shown) for number, shown in enumerate(self._shown)]

    def returned(self, function: ast.FunctionDef, given: Mapping[str, Held]) -> Formula:
        """When a function returns something true; ``given`` are its arguments."""
        self.names.update(given)
        self._finish(function.body)
        return self._bounded(either_of(*(all_of(end.state.path, end.value) for end in self._exits)))

    def called(self, function: ast.FunctionDef, arguments: list[ast.expr], *, is_bound: bool) -> Formula:
        """See :class:`Conditions`."""
        if self._depth >= _DEEPEST_CALL:
            return self.script.unknown()
        names = _arguments(function)
        names = names[is_bound:]
        given = {
            name: Held(self.text(node), self.truth(node))
            for name, node in zip(names, arguments, strict=False)
        }
        given |= {
            name: Held(self.script.unknown_text(), self.script.unknown()) for name in names[len(arguments) :]
        }
        return Drawing(self.script, self.cls, self._depth + 1).returned(function, given)

    def _bounded(self, formula: Formula) -> Formula:
        return self.script.unknown() if is_large(formula) else formula

    def _finish(self, body: list[ast.stmt]) -> None:
        if self._body(body):
            self._leave(FALSE)

    def _leave(self, value: Formula) -> None:
        self._exits.append(_Exit(self._state.copy(), value, len(self._shown)))

    # Layouts.

    def _new_layout(self, parent: int | None) -> int:
        self._parents.append(parent)
        return len(self._parents) - 1

    def _root(self, node: ast.expr) -> int | None:
        """The layout that a function was given, by what it is called."""
        text = self.text(node)
        if not self._is_layout(node) or is_unknown(text):
            return None
        if text not in self._roots:
            self._roots[text] = self._new_layout(None)
        return self._roots[text]

    def _is_layout(self, node: ast.expr) -> bool:
        kind = self.type_of(node)
        if kind is None or kind is UNKNOWN:
            # A function that panels of other scripts call with themselves, or with their layout.
            return self.text(node).rpartition(".")[2] == "layout"
        return isinstance(kind, Instance) and kind.cls == _LAYOUT

    def _layout(self, node: ast.expr) -> int | None:
        """The number of the layout that an expression is; None for what is none, or for one that is not known."""
        match node:
            case ast.Name():
                held = self.names.get(node.id)
                return held.layout if held and held.layout is not None else self._root(node)
            case ast.Attribute():
                return self._root(node)
            case ast.Call(func=ast.Attribute(value=receiver, attr=name)):
                if node not in self._made:
                    parent = self._layout(receiver)
                    if parent is None or name not in MAKES_LAYOUT:
                        return None
                    self._made[node] = self._new_layout(parent)
                return self._made[node]
            case ast.NamedExpr():
                return self._layout(node.value)
            case _:
                return None

    def _set(self, target: ast.Attribute, value: Formula | None) -> None:
        """Sets ``active`` or ``enabled``; None is for a value that is not known."""
        layout = self._layout(target.value)
        if layout is not None:
            self._state.set_to[layout, target.attr] = (
                self.script.unknown() if value is None else self._bounded(value)
            )
            self._forget(self._others(layout), target.attr)
        elif self._is_layout(target.value) or self.type_of(target.value) in {None, UNKNOWN}:
            self._forget(range(len(self._parents)), target.attr)  # it may be any of them

    def _others(self, layout: int) -> set[int]:
        """The layouts that may be the same one by another name."""
        found = {layout}
        while True:
            more = {
                n
                for pair in self._stand_ins.items()
                for n in (pair[0], *pair[1])
                if found & {pair[0], *pair[1]}
            }
            if more <= found:
                return found - {layout}
            found |= more

    def _forget(self, layouts: Iterable[int], state: str) -> None:
        for layout in layouts:
            self._state.set_to[layout, state] = self.script.unknown()

    def _stand_in(self, first: int, second: int) -> int:
        """A layout that is one of two."""
        parent = self._parents[first] if self._parents[first] == self._parents[second] else None
        layout = self._new_layout(parent)
        self._stand_ins[layout] = (first, second)
        return layout

    # Places.

    def _place(self, number: int, shown: _Shown) -> Place:
        ends = [end.state for end in self._exits if end.shown > number]
        parts = [shown.path]
        layout = shown.layout
        while layout is not None:
            for key in ((layout, state) for state in _STATES):
                values = {end.set_to.get(key, TRUE) for end in ends}
                if len(values) == 1:
                    parts += values
                elif values:
                    parts.append(either_of(*(all_of(end.path, end.set_to.get(key, TRUE)) for end in ends)))
            layout = self._parents[layout]
        return Place(shown.name, shown.symbols, shown.owner, shown.path, all_of(*parts))

    def _calls(self, node: ast.expr) -> None:
        """Reads the calls in an expression: what they show, and names that they bind."""
        parts = [*walk(node)]
        for part in parts:
            if isinstance(part, ast.Call) and isinstance(part.func, ast.Attribute):
                if part.func.attr in SHOWS:
                    self._show(part, part.func.value)
                elif part.func.attr in OFFERS:
                    self._offer(part, part.func.value)
        for part in parts:
            if isinstance(part, ast.NamedExpr):
                self._assign(part.target, part.value)

    def _show(self, call: ast.Call, receiver: ast.expr) -> None:
        owner, named = shown_property(call)
        if owner is None or named is None:
            return
        row = self.script.analysis.resolutions.get(named)
        symbols = (row.symbols or row.possible) if row is not None and row.kind == "button" else ()
        layout = self._layout(receiver)
        for name in self._strings(named):
            self._shown.append(_Shown(name, symbols, self.text(owner), layout, self._state.path))

    def _offer(self, call: ast.Call, receiver: ast.expr) -> None:
        given = {keyword.arg: keyword.value for keyword in call.keywords}
        named = call.args[0] if call.args else given.get("operator")
        layout = self._layout(receiver)
        for name in self._strings(named) if named is not None else ():
            self._shown.append(_Shown(name, (OPERATORS + name,), "", layout, self._state.path))

    def _strings(self, node: ast.expr) -> list[str]:
        """The strings that an expression can be."""
        kind = self.type_of(node) or UNKNOWN
        values = [node.value] if isinstance(node, ast.Constant) else literal_texts(kind)
        return [value for value in values if isinstance(value, str)]

    # Statements.

    def _body(self, body: Iterable[ast.stmt]) -> bool:
        """Reads statements in their order; whether what follows them is reached."""
        return all(self._statement(statement) for statement in body)

    def _statement(self, node: ast.stmt) -> bool:  # noqa: PLR0911, PLR0912 - one case a statement
        match node:
            case ast.Expr():
                self._calls(node.value)
            case ast.Assign():
                self._calls(node.value)
                for target in node.targets:
                    self._assign(target, node.value)
            case ast.AnnAssign(value=ast.expr() as value):
                self._calls(value)
                self._assign(node.target, value)
            case ast.AugAssign():
                self._calls(node.value)
                self._assign(node.target, None)
            case ast.If():
                self._calls(node.test)
                return self._parted(self.truth(node.test), node.body, node.orelse)
            case ast.For() | ast.AsyncFor():
                self._calls(node.iter)
                self._loop(node, [node.target])
            case ast.While():
                self._calls(node.test)
                self._loop(node, [])
            case ast.With() | ast.AsyncWith():
                for item in node.items:
                    self._calls(item.context_expr)
                    if item.optional_vars is not None:
                        self._assign(item.optional_vars, None)
                return self._body(node.body)
            case ast.Try() | ast.TryStar():
                handlers = [handler.body for handler in node.handlers]
                return self._ways([[*node.body, *node.orelse], *handlers]) and self._body(node.finalbody)
            case ast.Match():
                self._calls(node.subject)
                return self._ways([*(case.body for case in node.cases), []])
            case ast.Return():
                if node.value is not None:
                    self._calls(node.value)
                self._leave(FALSE if node.value is None else self.truth(node.value))
                return False
            case ast.Raise():
                return False
            case ast.Continue() | ast.Break():
                if self._jumps:
                    self._jumps[-1].append(self._state.copy())
                return False
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                self._bind_unknown(node.name)
            case _:
                pass
        return True

    def _bind_unknown(self, name: str) -> None:
        self.names[name] = Held(self.script.unknown_text(), self.script.unknown())

    def _assign(self, target: ast.expr, value: ast.expr | None) -> None:
        match target:
            case ast.Name():
                text = "" if value is None else self.text(value)
                if value is None or len(text) > _LONGEST_TEXT:
                    self._bind_unknown(target.id)
                else:
                    source = value if isinstance(value, ast.Attribute) else None
                    truth = self._bounded(self.truth(value))
                    self.names[target.id] = Held(text, truth, self._layout(value), source)
            case ast.Attribute(attr="active" | "enabled"):
                self._set(target, None if value is None else self.truth(value))
            case ast.Tuple() | ast.List():
                self._unpack(target.elts, value)
            case ast.Starred():
                self._assign(target.value, None)
            case _:
                pass

    def _unpack(self, targets: list[ast.expr], value: ast.expr | None) -> None:
        made = self._layout(value) if isinstance(value, ast.Call) else None
        for target in targets:
            self._assign(target, None)
            if made is not None and isinstance(target, ast.Name):
                held = self.names[target.id]
                self.names[target.id] = Held(held.text, held.truth, self._new_layout(made))

    # Ways that part and meet.

    def _enter(self, state: _State) -> None:
        self._state, self.names = state, state.names

    def _parted(self, test: Formula, body: list[ast.stmt], orelse: list[ast.stmt]) -> bool:
        before = self._state
        ends: list[tuple[_State, bool]] = []  # with whether every way through it comes here
        for condition, statements in ((test, body), (negated(test), orelse)):
            self._enter(before.copy())
            entered = self._state.path = all_of(before.path, condition)
            if self._body(statements):
                ends.append((self._state, self._state.path == entered))
        if not ends:
            return False
        if len(ends) == 1:
            self._enter(ends[0][0])
            return True
        (first, first_whole), (second, second_whole) = ends
        whole = first_whole and second_whole
        path = before.path if whole else either_of(first.path, second.path)
        if is_large(path):
            path = before.path  # holds as well
        self._enter(self._met(test, first, second, path))
        return True

    def _ways(self, bodies: list[list[ast.stmt]]) -> bool:
        """Reads statements of which some are run, nobody knows which."""
        before = self._state
        met: _State | None = None
        for body in bodies:
            self._enter(before.copy())
            if self._body(body):
                state = self._state
                met = state if met is None else self._met(self.script.unknown(), met, state, before.path)
        self._enter(met or before)
        self._state.path = before.path
        return met is not None

    def _loop(self, node: ast.For | ast.AsyncFor | ast.While, targets: list[ast.expr]) -> None:
        before, made = self._state, len(self._parents)
        self._enter(before.copy())
        bound = {
            part.id
            for part in (*targets, *node.body)
            for part in walk(part)
            if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)
        }
        for name in bound:
            self._bind_unknown(name)  # what the round before left there
        if isinstance(node, ast.While):
            self._state.path = all_of(before.path, self.truth(node.test))
        self._jumps.append([])
        is_through = self._body(node.body)
        ends = [*self._jumps.pop(), *([self._state] if is_through else [])]
        met = before
        for end in ends:
            met = self._met(self.script.unknown(), met, end, before.path)
        # A layout that is made in a round is as that round leaves it.
        for key in {key for end in ends for key in end.set_to if key[0] >= made}:
            values = {end.set_to.get(key, TRUE) for end in ends}
            met.set_to[key] = values.pop() if len(values) == 1 else self.script.unknown()
        self._enter(met.copy())
        self._body(node.orelse)

    def _met(self, test: Formula, first: _State, second: _State, path: Formula) -> _State:
        """What holds where two ways meet: the first one was taken where ``test`` held."""
        names = {
            name: self._either_held(test, first.names.get(name), second.names.get(name))
            for name in dict.fromkeys((*first.names, *second.names))
        }
        set_to = {
            key: self._bounded(chosen(test, first.set_to.get(key, TRUE), second.set_to.get(key, TRUE)))
            for key in dict.fromkeys((*first.set_to, *second.set_to))
        }
        return _State(path, names, set_to)

    def _either_held(self, test: Formula, first: Held | None, second: Held | None) -> Held:
        if first == second and first is not None:
            return first
        if first is None or second is None:
            # Bound on one way only: who reads it came along that way.
            return first or second or Held(self.script.unknown_text(), self.script.unknown())
        layout = first.layout
        if first.layout != second.layout:
            both = first.layout, second.layout
            layout = None if None in both else self._stand_in(first.layout or 0, second.layout or 0)
        text = first.text if first.text == second.text else self.script.unknown_text()
        return Held(text, self._bounded(chosen(test, first.truth, second.truth)), layout)


def _arguments(function: ast.FunctionDef) -> list[str]:
    given = function.args
    return [argument.arg for argument in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
