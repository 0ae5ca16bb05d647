"""Reads loops: what one turn binds is known in the next."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.flow.evaluation.members import Members
from kb_build.flow.execution.turns import turns
from kb_build.flow.execution.ways import Ways
from kb_build.flow.state.scopes import Loop, State, joined
from kb_build.flow.state.trials import Trials

if TYPE_CHECKING:
    import ast
    from collections.abc import Callable
    from collections.abc import Sequence as Rows

    from kb_build.flow.values.types import Type


class Loops(Members, Trials, Ways):
    """Reads ``for``, ``while``, and what leaves a turn; each reader tells whether the next statement can be reached."""

    def read_for(self, node: ast.For | ast.AsyncFor) -> bool:
        """Reads ``for``: the target is bound in each turn."""
        kind = self.iterated(self.evaluate(node.iter))

        def enter() -> None:
            self.here.statement = node
            self.bind_target(node.target, kind)

        def try_turns(start: State) -> None:
            for one in turns(node.iter, self.here.types, node.body):
                self._try_turn(node, one, start)

        return self._loop(node.body, node.orelse, enter, None if self.here.turning else try_turns)

    def _try_turn(self, node: ast.For | ast.AsyncFor, kind: Type, start: State) -> None:
        """Reads one turn of a loop for what its texts come to."""
        outer, function = self.here.scope, self.here.function
        returned = function.returned if function else None

        def read() -> None:
            self.spend(len(outer.ever))
            self.here.scope = replace(
                outer, state=self.copied(start), ever=outer.ever.copy(), asked=outer.asked.copy()
            )
            self.here.statement = node
            self.bind_target(node.target, kind)
            self.read_body(node.body)

        try:
            with self.at(replace(self.here, loops=[Loop()], turning=True)):
                self.try_reading(read)
        finally:
            if function:
                function.returned = returned

    def read_while(self, node: ast.While) -> bool:
        """Reads ``while``: the condition holds in each turn."""

        def enter() -> None:
            self.here.statement = node
            self.evaluate(node.test)
            self.narrow(node.test, holds=True)

        return self._loop(node.body, node.orelse, enter)

    def read_break(self, _node: ast.Break) -> bool:
        """Notes what is known where a loop is left."""
        if self.here.loops:
            self.here.loops[-1].left.append(self.here.scope.state)
        return False

    def read_continue(self, _node: ast.Continue) -> bool:
        """Notes what is known where a turn of a loop ends."""
        if self.here.loops:
            self.here.loops[-1].continued.append(self.here.scope.state)
        return False

    def _loop(
        self,
        body: Rows[ast.stmt],
        orelse: Rows[ast.stmt],
        enter: Callable[[], None],
        try_turns: Callable[[State], None] | None = None,
    ) -> bool:
        """Reads a loop's body twice, so that what one turn binds is known in the next; then single turns, if any."""
        before = self.here.scope.state
        loop = Loop()
        self.here.loops.append(loop)
        start = before
        for turn in range(2):
            self.here.scope.state = self.copied(start)
            enter()
            after = self.way(self.here.scope.state, body)
            ends = [state for state in (after, *loop.continued) if state is not None]
            start = joined([before, *ends])
            if turn == 0 and not _differs(before, start):
                break
        self.here.loops.pop()
        if try_turns is not None:
            try_turns(start)
        self.here.scope.state = self.copied(start)
        reached = self.read_body(orelse) if orelse else True
        return self.meet([self.here.scope.state if reached else None, *loop.left], start)


def _differs(before: State, after: State) -> bool:
    """Whether a loop's first turn bound something that its beginning has otherwise."""
    return any(
        before.names.get(name) is not kind and before.names.get(name) != kind
        for name, kind in after.names.items()
        if name in before.names
    )
