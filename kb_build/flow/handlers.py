"""Reads what is ready for errors: ``try``, and ``with``, whose managers may suppress them."""

from __future__ import annotations

import ast

from kb_build.flow.guards import Guards, assigned_names
from kb_build.flow.scopes import joined
from kb_build.flow.types import UNKNOWN, Builtin, Sequence, Tuple, Type, members, union
from kb_build.flow.ways import Ways

_FORGIVING = frozenset(
    {
        "AttributeError",
        "Exception",
        "BaseException",
        "ImportError",
        "KeyError",
        "LookupError",
        "ModuleNotFoundError",
        "TypeError",
        "RuntimeError",
        "ValueError",
    }
)


class Handlers(Guards, Ways):
    """Reads ``try`` and ``with``; each reader tells whether the next statement can be reached."""

    def read_try(self, node: ast.Try) -> bool:
        """Reads ``try``: a handler begins anywhere within what it handles."""
        forgives = [self._forgives(handler) for handler in node.handlers]
        forgiving = any(forgives)
        before = self.scope.state
        self.tolerant += forgiving
        after = self.way(self.copied(before), node.body)
        self.tolerant -= forgiving
        within = joined([before, after or self.scope.state])
        if after is not None and node.orelse:
            after = self.way(after, node.orelse)
        ways = [after]
        for handler, is_ready in zip(node.handlers, forgives, strict=True):
            self.scope.state = self.copied(within)
            if handler.name:
                self.bind(handler.name, UNKNOWN)
            # What is done where a name is lacking may be for another Blender.
            self.tolerant += is_ready
            ways.append(self.way(self.scope.state, handler.body))
            self.tolerant -= is_ready
        reached = self.meet(ways, self.copied(within))
        if forgiving:
            handled = [statement for handler in node.handlers for statement in handler.body]
            self.tell(assigned_names([*node.body, *node.orelse, *handled]), self.lacked(node.body))
        return self.read_body(node.finalbody) and reached

    def read_with(self, node: ast.With | ast.AsyncWith) -> bool:
        """Reads ``with``: what follows is reached also where the manager suppresses an error."""
        for item in node.items:
            kind = self.evaluate(item.context_expr)
            if item.optional_vars is not None:
                self.bind_target(item.optional_vars, _entered(kind))
        forgiving = any(self._suppresses(item.context_expr) for item in node.items)
        self.tolerant += forgiving
        reached = self.read_body(node.body)
        self.tolerant -= forgiving
        return reached or forgiving

    def _forgives(self, handler: ast.ExceptHandler) -> bool:
        """Whether a handler is ready for a name that does not exist."""
        return handler.type is None or self._is_forgiving(handler.type)

    def _suppresses(self, manager: ast.expr) -> bool:
        """Whether a context manager, which was read, is ready for a name that does not exist.

        ``contextlib.suppress(AttributeError)`` is, and so is what else is given such an error: ``assertRaises``.
        """
        return isinstance(manager, ast.Call) and any(map(self._is_forgiving, manager.args))

    def _is_forgiving(self, errors: ast.expr) -> bool:
        """Whether one of the classes that an expression stands for is that of a missing name's error."""
        kinds = [*members(self.evaluate(errors))]
        for kind in kinds:  # it grows
            if isinstance(kind, Tuple):
                kinds += kind.items
        return any(isinstance(kind, Builtin) and kind.name in _FORGIVING for kind in kinds)


def _entered(kind: Type) -> Type:
    """What ``with`` gives: of a generator, which only a decorator makes a context manager, what it yields."""
    yielded = [one.element for one in members(kind) if isinstance(one, Sequence) and one.kind == "iterator"]
    return union(yielded) if yielded else kind
