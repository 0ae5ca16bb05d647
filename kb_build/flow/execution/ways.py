"""Ways that part and meet: what is known on each, and joined behind them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_build.flow.state.core import Core
from kb_build.flow.state.scopes import State, joined

if TYPE_CHECKING:
    import ast
    from collections.abc import Sequence as Rows


class Ways(Core):
    """Goes along ways, each with a state of its own."""

    def way(self, state: State, body: Rows[ast.stmt]) -> State | None:
        """Reads statements from a state on; the state behind them, or None if they do not get there."""
        self.here.scope.state = state
        return self.here.scope.state if self.read_body(body) else None

    def meet(self, states: Rows[State | None], otherwise: State) -> bool:
        """Goes on from where several ways end; whether any does."""
        open_ways = [state for state in states if state is not None]
        self.here.scope.state = joined(open_ways) if open_ways else otherwise
        return bool(open_ways)
