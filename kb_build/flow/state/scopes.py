"""The names of a script: what each holds at the place that is being read, and what it ever held."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.state.doubts import NO_DOUBTS, Doubts
from kb_build.flow.syntax.shared_names import NONE_SHARED, SharedNames
from kb_build.flow.values.type_parts import HOLDING, bounded, unsure
from kb_build.flow.values.types import (
    UNKNOWN,
    Builtin,
    Function,
    Instance,
    LocalFunction,
    Mapping,
    Tuple,
    Type,
    Union,
    join,
    members,
)
from kb_build.flow.values.types import Sequence as ListType

if TYPE_CHECKING:
    from collections.abc import Sequence

_DEEPEST_CHAIN = 8
_NESTED = (ListType, Tuple, Mapping, Union, Instance, Function, Builtin, LocalFunction)


def kept(kind: Type) -> Type:
    """A type as a name holds it; the same object where it is simple."""
    return bounded(kind) if isinstance(kind, _NESTED) else kind


@dataclass(slots=True)
class State:
    """What is known at one place of one scope: of names, and of chains (``context.object``) by their text.

    ``active`` is the active object, where an operator has just made it.
    """

    names: dict[str, Type] = field(default_factory=dict[str, Type])
    chains: dict[str, Type] = field(default_factory=dict[str, Type])
    doubted: Doubts = NO_DOUBTS
    active: Type | None = None

    def copy(self) -> State:
        """The same, to be changed on its own."""
        return State(self.names.copy(), self.chains.copy(), self.doubted, self.active)

    def doubts_members_of(self, node: ast.expr) -> bool:
        """Whether what is read here from an expression may be for another Blender."""
        doubted = self.doubted
        return doubted.everything or (bool(doubted.chains) and chain_text(node) in doubted.chains)


def joined(states: Sequence[State]) -> State:
    """What is known where several ways meet. A name that is bound on some ways only keeps its type."""
    first, *others = states
    names = first.names.copy()
    chains = first.chains
    doubted = first.doubted
    for other in others:
        for name, kind in other.names.items():
            if name not in names:
                names[name] = kind
            elif names[name] is not kind:
                names[name] = join(names[name], kind)
        chains = {text: kind for text, kind in chains.items() if other.chains.get(text) == kind}
        if other.doubted is not doubted:
            doubted &= other.doubted
    active = first.active if all(other.active == first.active for other in others) else None
    return State(names, dict(chains), doubted, active)


@dataclass(slots=True)
class Loop:
    """A loop that is being read: the states at its ``break`` and ``continue``."""

    left: list[State] = field(default_factory=list[State])
    continued: list[State] = field(default_factory=list[State])


@dataclass(slots=True)
class Scope:
    """A module, a function or a class. ``ever`` joins all that a name was bound to: what other scopes see.

    ``asked`` are the names that hold what ``hasattr`` or ``getattr`` said, with the expression. ``shared`` are names
    that functions bind or fill which are not theirs.
    """

    parent: Scope | None = None
    is_class: bool = False
    cls: int | None = None
    state: State = field(default_factory=State)
    ever: dict[str, Type] = field(default_factory=dict[str, Type])
    elsewhere: set[str] = field(default_factory=set[str])
    asked: dict[str, ast.expr] = field(default_factory=dict[str, ast.expr])
    shared: SharedNames = NONE_SHARED
    changes: int = 0

    def lookup(self, name: str) -> Type | None:
        """What a name holds here; None for a name that the script does not bind."""
        if name in self.shared.bound or (name in self.shared.filled and self._may_be_filled(name)):
            return self._shared(name)
        if name not in self.elsewhere:
            found = self.state.names.get(name)
            if found is not None:
                return found
        scope = self.parent
        while scope is not None:
            if not scope.is_class:
                found = scope.ever.get(name)
                if found is not None:
                    return found
            scope = scope.parent
        return None

    def _shared(self, name: str) -> Type | None:
        """All that a shared name ever held, none of it for sure."""
        held = self._held(name)
        return unsure(held) if held is not None else None

    def _may_be_filled(self, name: str) -> bool:
        """Whether a name ever held a list or a dictionary, which is of another type once it is filled."""
        return any(isinstance(one, HOLDING) for one in members(self._held(name) or UNKNOWN))

    def _held(self, name: str) -> Type | None:
        """All that a name ever held, here or around; None for one that the script does not bind."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.ever and (scope is self or not scope.is_class):
                return scope.ever[name]
            scope = scope.parent
        return None

    def asked_by(self, name: str) -> ast.expr | None:
        """The ``hasattr`` or ``getattr`` whose answer a name holds here."""
        scope: Scope | None = self
        while scope is not None:
            if name in scope.asked or name in scope.ever:
                return scope.asked.get(name)
            scope = scope.parent
        return None

    def bind(self, name: str, kind: Type) -> None:
        """Binds a name, and forgets what was known of chains that begin with it."""
        kind = kept(kind)
        if name in self.elsewhere:
            scope = self.parent
            while scope is not None and scope.parent is not None and name not in scope.ever:
                scope = scope.parent
            if scope is not None:
                scope.remember(name, kind)
            return
        self.state.names[name] = kind
        if self.state.chains:
            self.forget(name)
        self.remember(name, kind)

    def fill_outside(self, name: str, kind: Type) -> None:
        """Adds to what a name of a scope around this one holds."""
        scope = self.parent
        while scope is not None:
            if not scope.is_class and name in scope.ever:
                held = scope.state.names.get(name)
                if held is not None:
                    scope.state.names[name] = join(held, kept(kind))
                scope.remember(name, kept(kind))
                return
            scope = scope.parent

    def remember(self, name: str, kind: Type) -> None:
        """Adds to what a name ever held."""
        before = self.ever.get(name)
        after = kind if before is None else join(before, kind)
        if after != before:
            self.ever[name] = after
            self.changes += 1

    def forget(self, text: str) -> None:
        """Forgets what is known of a chain and of those that begin with it."""
        begins = f"{text}."
        chains = self.state.chains
        for chain in [chain for chain in chains if chain == text or chain.startswith(begins)]:
            del chains[chain]


def chain_text(node: ast.expr) -> str:
    """``context.object.data`` for such an expression; empty for one that is not only names and attributes."""
    parts: list[str] = []
    while isinstance(node, ast.Attribute):
        parts.append(node.attr)
        node = node.value
        if len(parts) > _DEEPEST_CHAIN:
            return ""
    if not isinstance(node, ast.Name):
        return ""
    return ".".join((node.id, *reversed(parts)))


def item_text(node: ast.Subscript) -> tuple[str, str]:
    """(text, key) of an item of a chain that is asked for by a text, ``obj["key"]``.

    Without such a key the text is what those of all the chain's items begin with; it is empty for an item of no chain.
    """
    chain = chain_text(node.value)
    text = f"{chain}.[]" if chain else ""
    match node.slice:
        case ast.Constant(value=str(key)) if text and key:
            return f"{text}.{key}", key
        case _:
            return text, ""
