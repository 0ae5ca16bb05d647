"""In which mode the active object surely is where a script calls an operator, and of which type it is, or that there
is none.

A run is followed from statement to statement, through conditions, loops and the script's own functions. Whatever may
change the mode out of sight ends what is known; an operator that runs in one mode only tells it again.
"""

from __future__ import annotations

import ast
import re
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import children, walk
from kb_build.flow.values.types import Mapping
from kb_check.calls.sites import calls, calls_by_node
from kb_check.modes.absence import active_reads, lines_without_active, without_active
from kb_check.modes.edit_bones import names_in
from kb_check.modes.keeping import (
    LEFT,
    REMOVING,
    SWITCHED,
    is_harmless,
    is_operator,
    own_functions,
    own_names,
    sets_active,
)
from kb_check.modes.state import (
    UNKNOWN,
    Absence,
    State,
    after_operator,
    has_to_do_with_modes,
    lacks_active,
    refusal,
)
from kb_check.running.context_managers import leaves_scene
from kb_check.running.out_of_sight import knows_all
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings, iterated
from kb_check.syntax.definitions import FUNCTIONS, FunctionDefinition
from kb_check.syntax.words import named_words

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Sequence

    from kb_check.script import Script

_ENTERING = re.compile(
    r"mode_set|mode_toggle|editmode|sculptmode|posemode|paint_toggle|edit_toggle|mainfile|homefile|app_template"
    r"|^(mode|poll|is_editmode)$"
)
_OF_MODES = re.compile(r"mode|poll")
# What a condition, or a loop, names that may depend on there being an active object, or objects at all.
_OF_ACTIVE = re.compile(r"object|active|select|mode|poll")
_MOST_VISITS = 2000

_CONDITIONAL = (ast.IfExp, ast.BoolOp, ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


@once_per_script
def states(script: Script) -> dict[ast.expr, State]:
    """Of each call of an operator, and of each place that reads the active object: what is known before it.

    Nothing where no call of an operator has to do with modes, and nothing leaves the script without active object.
    """
    if not any(has_to_do_with_modes(call) for call in calls(script)) and not lines_without_active(script):
        return {}
    with suppress(RecursionError):
        return _Run(script).seen
    return {}


@once_per_script
def enters_modes(script: Script) -> bool:
    """Whether a script names anything that may enter a mode or asks for it, or may do so out of sight."""
    return not knows_all(script) or any(map(_ENTERING.search, named_words(script)))


class _Run:
    """Follows a script, and keeps what is known at each call, whichever way it is come to."""

    def __init__(self, script: Script) -> None:
        self.script = script
        self.seen: dict[ast.expr, State] = {}
        self._calls = calls_by_node(script)
        self._functions = own_functions(script)
        self._names = own_names(script)
        self._outcomes: dict[tuple[FunctionDefinition, State], State] = {}
        self._running: list[FunctionDefinition] = []
        self._returned: list[list[State]] = []
        self._jumped: list[list[State]] = []
        self._reads = active_reads(script) if lines_without_active(script) else frozenset[ast.expr]()
        self._calling_lines = {node.lineno for node in (*script.all(ast.Call, *LEFT), *self._reads)}
        self._made_in: dict[ast.AST, list[tuple[ast.expr, bool]]] = {}
        stores = [node for node in script.all(ast.Attribute) if not isinstance(node.ctx, ast.Load)]
        self._storing_lines = {
            node.lineno for node in stores if node.attr in SWITCHED or node.attr == "active"
        }
        self._parameters = {node.arg for node in script.all(ast.arg)}
        self._visits = self._finals = 0
        self._is_left_edited = False  # an object may be in Edit Mode that is no longer active
        self._block(script.tree.body, UNKNOWN)
        direct = {node.func.id for node in script.all(ast.Call) if isinstance(node.func, ast.Name)}
        handed_on = _handed_on(script)
        lines = self._telling_lines()
        for node in script.all(*FUNCTIONS):
            if not lines.isdisjoint(_lines(node)):
                is_own = self._functions.get(node.name) is node and node.name in direct
                if not is_own or node.name in handed_on:
                    self._function(node, UNKNOWN)

    def _telling_lines(self) -> set[int]:
        """The lines that have to do with modes, themselves or by the script's own functions that they call."""
        lines = {node.lineno for node, call in self._calls.items() if has_to_do_with_modes(call)}
        lines |= lines_without_active(self.script)
        asked: set[str] = set()
        while True:
            names = {name for name, node in self._functions.items() if not lines.isdisjoint(_lines(node))}
            if names <= asked:
                return lines
            asked |= names
            lines |= {
                node.lineno
                for node in self.script.all(ast.Call)
                if isinstance(node.func, ast.Name) and node.func.id in names
            }

    def _block(self, statements: Sequence[ast.stmt], state: State | None) -> State | None:
        """What is known after statements; None where a run does not get behind them."""
        for statement in statements:
            if state is None:
                return None
            self._visits += 1
            state = self._statement(statement, state)
        return state

    def _statement(self, node: ast.stmt, state: State) -> State | None:
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                after = state
            case ast.If():
                after = self._if(node, self._expressions([node.test], state))
            case ast.For() | ast.AsyncFor():
                after = self._loop(node, self._expressions([node.iter], state))
            case ast.While():
                after = self._loop(node, state)
            case ast.With() | ast.AsyncWith():
                after = self._with(node, state)
            case ast.Try() | ast.TryStar():
                after = self._try(node, state)
            case ast.Match():
                subject = self._expressions([node.subject], state)
                after = self._all_ways([case.body for case in node.cases], State(muted=subject.muted))
            case ast.Assign():  # the value comes first
                after = self._stores(node, self._expressions([node.value, *node.targets], state))
            case _:
                after = self._simple(node, self._stores(node, self._expressions([node], state)))
        return without_active(self.script, node, after) if after else None

    def _simple(self, node: ast.stmt, state: State) -> State | None:
        """What is known behind a statement that has none within it; a run may leave with it."""
        left = State(muted=state.muted) if self._finals else state
        if isinstance(node, ast.Return) and self._returned:
            self._returned[-1].append(left)
        if isinstance(node, (ast.Break, ast.Continue)) and self._jumped:
            self._jumped[-1].append(left)
        return None if isinstance(node, (ast.Return, ast.Raise, ast.Break, ast.Continue)) else state

    def _if(self, node: ast.If, state: State) -> State | None:
        words = {part.attr for part in walk(node.test) if isinstance(part, ast.Attribute)}
        asks = self._asks(node.test)
        asks_for_active = self._asks_for_active(node.test)
        inside = replace(state, mode="" if asks else state.mode, kind="" if words else state.kind)
        inside = _present(inside) if asks_for_active else inside
        ways = self._block(node.body, inside), self._block(node.orelse, inside) if node.orelse else state
        after = _join(*ways)
        if after is None or None not in ways:
            return after
        after = replace(after, mode="") if asks else after
        return _present(after) if asks_for_active else after

    def _asks(self, test: ast.expr) -> bool:
        """Whether a condition may have to do with the mode: names it, or depends on what callers say."""
        for node in walk(test):
            if isinstance(node, ast.Attribute) and _OF_MODES.search(node.attr):
                return True
            if isinstance(node, ast.Name) and (node.id in self._parameters or node.id in self._names):
                return True
            if isinstance(node, ast.Name) and any(
                value is None or _mentions_modes(value) for value in bindings(self.script).get(node.id, ())
            ):
                return True
        return False

    def _asks_for_active(self, node: ast.expr) -> bool:
        """Whether what a condition or a loop goes by may depend on there being an active object, or objects at all."""
        if not lines_without_active(self.script):
            return False
        parts = [*walk(node)]
        for name in names_in(node):
            if name in self._names:
                return True
            values = bindings(self.script).get(name, [])
            through = iterated(self.script).get(name, [])
            if values.count(None) > len(through):
                return True
            parts += (part for value in (*values, *through) if value is not None for part in walk(value))
        return any(
            isinstance(part, (ast.Name, ast.Attribute))
            and _OF_ACTIVE.search(part.id if isinstance(part, ast.Name) else part.attr)
            for part in parts
        )

    def _all_ways(self, bodies: Iterable[Sequence[ast.stmt]], state: State) -> State | None:
        after: State | None = state
        for body in bodies:
            after = _join(after, self._block(body, state))
        return after

    def _loop(self, node: ast.For | ast.AsyncFor | ast.While, state: State) -> State | None:
        while True:
            self._jumped.append([])
            at_test = state
            if isinstance(node, ast.While):
                at_test = self._expressions([node.test], state)
                at_test = State(muted=state.muted) if self._asks(node.test) else at_test
            if self._asks_for_active(node.test if isinstance(node, ast.While) else node.iter):
                at_test = _present(at_test)
            after = self._block(node.body, at_test)
            for jumped in self._jumped.pop():
                after = _join(after, jumped)
            again = _join(state, after) or state
            if again == state:
                asks = isinstance(node, ast.While) and self._asks(node.test)
                return self._block(node.orelse, State(muted=state.muted) if asks else state)
            state = again

    def _with(self, node: ast.With | ast.AsyncWith, state: State) -> State | None:
        items = [item.context_expr for item in node.items]
        state = self._expressions(items, state)
        if any(not isinstance(item, ast.Call) or "override" in ast.unparse(item) for item in items):
            self._block(node.body, State(muted=True))
            return State(muted=state.muted)
        if any("suppress" in ast.unparse(item) for item in items):
            after = self._block(node.body, replace(state, muted=True))
            return replace(_join(State(), after) or State(), muted=state.muted)
        after = self._block(node.body, state)
        return after if leaves_scene(node) or after is None else State(muted=state.muted)

    def _try(self, node: ast.Try | ast.TryStar, state: State) -> State | None:
        muted = bool(node.handlers)
        self._finals += bool(node.finalbody)
        after = self._block(node.body, replace(state, muted=muted or state.muted))
        after = self._block(node.orelse, replace(after, muted=state.muted)) if after else None
        for handler in node.handlers:
            after = _join(after, self._block(handler.body, State(muted=state.muted)))
        self._finals -= bool(node.finalbody)
        if not node.finalbody:
            return after
        known = self._block(node.finalbody, after or State(muted=state.muted))
        return known if after else None

    def _function(self, node: FunctionDefinition, state: State) -> State:
        """What is known after a call of one of the script's own functions."""
        if node in self._running or self._visits > _MOST_VISITS:
            return State(muted=state.muted)
        if (known := self._outcomes.get((node, state))) is not None:
            return known
        self._running.append(node)
        self._returned.append([])
        jumped, self._jumped = self._jumped, []
        finals, self._finals = self._finals, 0
        after = self._block(node.body, state)
        self._jumped, self._finals = jumped, finals
        for returned in self._returned.pop():
            after = _join(after, returned)
        self._running.pop()
        found = self._outcomes[node, state] = after or State(muted=state.muted)
        return found

    def _expressions(self, roots: Iterable[ast.AST], state: State) -> State:
        """What is known after the calls within expressions, in the order in which they are made."""
        for root in roots:
            for call, is_sure in self._made(root):
                if call in self._reads:
                    self._see(call, state if is_sure else State(muted=True))
                elif not isinstance(call, ast.Call):
                    state = State(muted=state.muted)
                elif is_sure:
                    state = self._call(call, state)
                else:
                    self._call(call, State(muted=True))
                    state = state if is_harmless(self.script, call) else State(muted=state.muted)
        return state

    def _made(self, root: ast.AST) -> list[tuple[ast.expr, bool]]:
        """The calls within a statement or an expression in their order; a run may come there often."""
        if isinstance(root, (ast.stmt, ast.expr)) and self._calling_lines.isdisjoint(_lines(root)):
            return []
        if (found := self._made_in.get(root)) is None:
            made = _made_calls(root, self._reads)
            found = self._made_in[root] = sorted(made, key=lambda pair: _end(pair[0]))
        return found

    def _call(self, node: ast.Call, state: State) -> State:
        if is_operator(node) and not is_harmless(self.script, node):
            return self._operator(node, state)
        if isinstance(node.func, ast.Name) and (function := self._functions.get(node.func.id)):
            return self._function(function, state)
        if is_harmless(self.script, node):
            if (site := self._calls.get(node)) and has_to_do_with_modes(site) and not self._is_left_edited:
                self._see(node, state)
            return state
        removes = isinstance(node.func, ast.Attribute) and node.func.attr in REMOVING
        after = State("OBJECT" if removes and state.mode == "OBJECT" else "", muted=state.muted)
        return replace(after, absence=state.absence) if removes and node in self._calls else after

    def _operator(self, node: ast.Call, state: State) -> State:
        call = self._calls.get(node)
        given = self.script.type_of(node.args[0]) if node.args else None
        if call is None or call.callee.symbol.kind != "operator" or isinstance(given, Mapping):
            return State(muted=state.muted)
        plain = all(isinstance(value, ast.Constant) for value in node.args)
        if not plain:
            return State(muted=state.muted)
        self._see(node, state)
        if refusal(self.script, call, state):
            return state
        if lacks_active(call, state):
            state = _present(state)  # once is enough
        return replace(after_operator(call, state), muted=state.muted)

    def _see(self, node: ast.expr, state: State) -> None:
        self.seen[node] = self.seen.get(node, state).joined(state)

    def _stores(self, statement: ast.stmt, state: State) -> State:
        """What is known after what a statement assigns."""
        if self._storing_lines.isdisjoint(_lines(statement)):
            return state
        for node in walk(statement):
            if not isinstance(node, ast.Attribute) or isinstance(node.ctx, ast.Load):
                continue
            if node.attr in SWITCHED:
                state = State(muted=state.muted)
            elif sets_active(self.script, node):
                stays = state.mode == "OBJECT" and not enters_modes(self.script)
                self._is_left_edited |= state.mode == "EDIT"
                state = State("OBJECT" if stays else "", muted=state.muted)
        return state


def _present(state: State) -> State:
    """What is known where there may be an active object."""
    return replace(state, absence=Absence.UNKNOWN)


def _join(first: State | None, second: State | None) -> State | None:
    if first is None or second is None:
        return first or second
    return first.joined(second)


def _lines(node: ast.stmt | ast.expr) -> range:
    return range(node.lineno, (node.end_lineno or node.lineno) + 1)


def _mentions_modes(value: ast.expr) -> bool:
    return any(
        (isinstance(node, ast.Attribute) and _OF_MODES.search(node.attr) is not None)
        or (isinstance(node, ast.Constant) and isinstance(node.value, bool))
        for node in walk(value)
    )


def _end(node: ast.expr) -> tuple[int, int]:
    return node.end_lineno or 0, node.end_col_offset or 0


def _made_calls(root: ast.AST, reads: Container[ast.AST]) -> Iterator[tuple[ast.expr, bool]]:
    """The calls within a statement or an expression, what lets others run, and what reads the active object; whether
    each is surely made, once.
    """
    waiting = [(root, True)]
    while waiting:
        node, is_sure = waiting.pop()
        if isinstance(node, (ast.Lambda, *FUNCTIONS, ast.ClassDef)):
            continue
        if isinstance(node, (ast.Call, *LEFT)) or (isinstance(node, ast.expr) and node in reads):
            yield node, is_sure
        is_sure = is_sure and not isinstance(node, _CONDITIONAL)
        waiting += [(child, is_sure) for child in children(node)]


@once_per_script
def _handed_on(script: Script) -> frozenset[str]:
    """The names that are used for more than to call them."""
    called = {node.func for node in script.all(ast.Call)}
    return frozenset(
        node.id for node in script.all(ast.Name) if isinstance(node.ctx, ast.Load) and node not in called
    )
