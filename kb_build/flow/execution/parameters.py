"""What a function's parameters hold: annotated, passed by calls or by the API, by default, or by convention."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import PARAMETERS
from kb_build.flow.evaluation.annotations import Annotations
from kb_build.flow.execution.contradictions import Contradictions
from kb_build.flow.syntax.trees import default_values, walk
from kb_build.flow.values.type_parts import can_be_unsure, given_away, unsure
from kb_build.flow.values.types import (
    NONE,
    STR,
    UNKNOWN,
    Function,
    Instance,
    LocalClass,
    LocalInstance,
    Mapping,
    Plain,
    Sequence,
    Type,
    general,
    join,
)
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from kb_build.flow.state.definitions import FunctionDefinition


class Parameters(Contradictions, Annotations):
    """Binds parameters."""

    def bind_parameters(self, function: FunctionDefinition) -> None:
        """Binds the names that a function has when it begins to run."""
        arguments = function.node.args
        positional = [*arguments.posonlyargs, *arguments.args]
        declared = self._declared_parameters(function, len(positional))
        defaults = default_values(arguments)
        for place, argument in enumerate((*positional, *arguments.kwonlyargs)):
            given = declared[place] if place < len(declared) else UNKNOWN
            kind = self._parameter(function, argument, given, defaults.get(argument.arg))
            # What some call passes may have been filled, or a default by an earlier call.
            self.bind(argument.arg, kind if function.exact else given_away(kind))
        for rest in (arguments.vararg, arguments.kwarg):
            if rest is not None and rest.annotation is not None:
                self.annotated(rest.annotation)
        if arguments.vararg is not None:
            self.bind(arguments.vararg.arg, Sequence("tuple", UNKNOWN))
        if arguments.kwarg is not None:
            further = function.received.get(arguments.kwarg.arg) if function.exact else None
            self.bind(arguments.kwarg.arg, further or Mapping(STR, UNKNOWN))

    def _parameter(  # noqa: PLR0911 - one return a source
        self, function: FunctionDefinition, argument: ast.arg, declared: Type, default: ast.expr | None
    ) -> Type:
        """A parameter's type: annotated, declared by the API, seen in calls, its default's, or by its name."""
        if argument.annotation is not None:
            kind = self.annotated(argument.annotation)
            if kind is not UNKNOWN:
                received = function.received.get(argument.arg, UNKNOWN)
                if self.contradicts(received, kind):
                    return join(unsure(kind), received)
                return received if function.exact and _is_literal(received) else kind
        if declared is not UNKNOWN:
            return declared
        received = function.received.get(argument.arg, UNKNOWN)
        if function.exact and received is not UNKNOWN and received is not NONE:
            return received
        if argument.arg in function.unknown and received is not UNKNOWN:
            # Some calls pass what is not known: the others tell no more than what may be passed.
            self.here.guessing = self.here.guessing or not can_be_unsure(received)
            received = unsure(received)
        fallback = self.here.types.get(default, UNKNOWN) if default is not None else UNKNOWN
        if argument.arg in function.unknown:
            fallback = unsure(fallback)
        if received is not UNKNOWN and received is not NONE:
            return received if fallback is UNKNOWN else join(received, general(fallback))
        if fallback is not UNKNOWN and fallback is not NONE:
            return general(fallback)
        # An annotation that says nothing here may name another library's class: a ``mesh: trimesh.Trimesh``.
        return UNKNOWN if argument.annotation is not None else self._by_convention(function, argument.arg)

    def _declared_parameters(self, function: FunctionDefinition, count: int) -> list[Type]:
        """What a method is called with: itself, and what the API's class passes to the method that it overrides."""
        if function.cls is None or count == 0:
            return []
        node = function.node
        first: list[Type] = []
        if not function.is_static:
            made = function.is_class_method or (
                isinstance(node, ast.FunctionDef) and node.name in {"__new__", "__init_subclass__"}
            )
            first = [LocalClass(function.cls) if made else LocalInstance(function.cls)]
        if isinstance(node, ast.Lambda):
            return first
        bases, _ = self.api_bases(function.cls)
        for base in bases:
            member = self.api.member(base, node.name)
            if member is not None and isinstance(member.type, Function):
                symbol = member.symbol
                return first + [
                    self.api.read_type(parameter.plain_type, symbol.path) for parameter in symbol.positional
                ]
        return first

    def _by_convention(self, function: FunctionDefinition, name: str) -> Type:
        """The type that everyone's parameters of this name have, if the function uses it so."""
        cls = T + PARAMETERS.get(name, "")
        if not self.api.is_class(cls) or self.here.file.is_without_blender:
            return UNKNOWN
        if function.used is None:
            function.used = _used_names(function.node)
        for attribute in function.used.get(name, ()):
            known = attribute and (self.api.member(cls, attribute) or self.api.below(cls, attribute))
            if not known and not (attribute and self.api.had(cls, attribute)):
                return UNKNOWN
        return Instance(cls, sure=False)


def _is_literal(kind: Type) -> bool:
    return isinstance(kind, Plain) and kind.value is not None


def _used_names(function: ast.AST) -> dict[str, set[str]]:
    """Name → the attributes that a function reads from it; an empty one where it is indexed."""
    used: dict[str, set[str]] = {}
    for node in walk(function):
        if isinstance(node, (ast.Attribute, ast.Subscript)) and isinstance(node.value, ast.Name):
            used.setdefault(node.value.id, set()).add(node.attr if isinstance(node, ast.Attribute) else "")
    return used
