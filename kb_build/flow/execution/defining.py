"""Reads statements that define something: functions, classes and names of types."""

from __future__ import annotations

import ast
from dataclasses import replace

from kb_build.flow.evaluation.expressions import Expressions
from kb_build.flow.state.core import ANY
from kb_build.flow.state.definitions import ClassDefinition
from kb_build.flow.state.scopes import Scope
from kb_build.flow.syntax.decorators import hands_on, makes_one_that_hands_on
from kb_build.flow.syntax.trees import children
from kb_build.flow.values.types import (
    UNKNOWN,
    ClassObject,
    LocalClass,
    LocalFunction,
    Plain,
    Type,
    general,
    literal,
)
from kb_build.symbols.api_names import TYPES as T

# Decorators of functions that do the same, or that `with` takes what they yield from.
_KEEPING = frozenset({"persistent", "cache", "lru_cache", "contextmanager", "asynccontextmanager"})
_OBJECT = "object"
_MOST_CLASSES = 1_000  # of one script; which ones later classes are mixed into is not asked


class Defining(Expressions):
    """Reads definitions; each reader tells whether the next statement can be reached."""

    def read_function_definition(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
        """Binds a function's name; what it does is read when it is called, or at the end."""
        cls = self.here.scope.cls if self.here.scope.is_class else None
        number = self.define_function(node, cls)
        function = self.functions[number]
        kind: Type = LocalFunction(number)
        for decorator in node.decorator_list:
            self.evaluate(decorator)
            match decorator:
                case ast.Name(id="staticmethod"):
                    function.is_static = True
                case ast.Name(id="classmethod"):
                    function.is_class_method = True
                case (
                    ast.Name(id="property")
                    | ast.Attribute(attr="cached_property")
                    | ast.Name(id="cached_property")
                ):
                    function.is_property = True
                case ast.Attribute(attr="setter" | "getter" | "deleter"):
                    return True
                case ast.Attribute(attr=name) | ast.Name(id=name) if name in _KEEPING:
                    pass
                case ast.Call(func=ast.Attribute(attr="lru_cache") | ast.Name(id="lru_cache")):
                    pass
                case _:
                    kind = UNKNOWN if cls is None and not self._hands_on(decorator) else kind
        self.read_defaults(node.args)
        self._read_type_parameters(node)
        self.bind(node.name, kind)
        return True

    def _hands_on(self, decorator: ast.expr) -> bool:
        """Whether a decorator of the script's leaves what it decorates as it is for those that call it."""
        match decorator:
            case ast.Call(func=made_by):
                test = makes_one_that_hands_on
            case made_by:
                test = hands_on
        kind = self.here.types.get(made_by, UNKNOWN)
        return isinstance(kind, LocalFunction) and test(self.functions[kind.number].node)

    def read_class_definition(self, node: ast.ClassDef) -> bool:
        """Reads a class with its body, and binds its name."""
        for decorator in node.decorator_list:
            self.evaluate(decorator)
        self._read_type_parameters(node)
        bases = tuple(self._base(base) for base in node.bases)
        for keyword in node.keywords:
            self.evaluate(keyword.value)
        number = self.numbers.get(node)
        if number is None:
            number = self.numbers[node] = len(self.classes)
            self.classes.append(ClassDefinition(node, bases))
            for kind in self.ancestors(number):
                if isinstance(kind, LocalClass) and kind.number != number and number < _MOST_CLASSES:
                    self.derived.setdefault(kind.number, []).append(number)
        scope = Scope(self.here.scope, is_class=True, cls=number)
        scope.state.chains = dict(self.here.scope.state.chains)
        scope.state.doubted = self.here.scope.state.doubted
        with self.at(replace(self.here, scope=scope)):
            self.read_body(node.body)
        definition = self.classes[number]
        definition.declared = frozenset(
            statement.target.id
            for statement in node.body
            if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name)
            if self.is_declared(statement.annotation)
        )
        own_bases, known = self.direct_bases(number)
        is_plain = known and own_bases in {(), (_OBJECT,)} and not node.keywords
        if is_plain and node.decorator_list:
            is_plain = all(map(_makes_data_class, node.decorator_list))
            definition.fields = _fields(node) if is_plain else ()
        self._add_to_api(node.name, number, scope.state.names.get("bl_idname"))
        for name, kind in scope.ever.items():
            is_general = isinstance(kind, Plain) and name != "bl_idname"  # by which buttons name an operator
            definition.bind(name, general(kind) if is_general and not is_plain else kind)
        self.bind(node.name, LocalClass(number))
        return True

    def read_type_alias(self, node: ast.stmt) -> bool:
        """Reads ``type X = value``."""
        self._read_type_parameters(node)
        match children(node):
            case [ast.Name(id=name), *_, ast.expr() as value]:
                with self.ready_for():
                    self.evaluate(value)
                self.bind(name, UNKNOWN)
            case _:
                pass
        return True

    def _read_type_parameters(self, node: ast.stmt) -> None:
        """Evaluates what ``[T: bound]`` and ``type X = value`` name, which Python reads when it is asked for."""
        with self.ready_for():
            for parameter in getattr(node, "type_params", ()):
                for part in children(parameter):
                    if isinstance(part, ast.expr):
                        self.evaluate(part)

    def _base(self, node: ast.expr) -> Type:
        kind = self.evaluate(node)
        if isinstance(node, ast.Name) and node.id == _OBJECT:
            return ClassObject(_OBJECT)
        return kind

    def _add_to_api(self, name: str, number: int, identifier: Type | None) -> None:
        """Notes that a class, once it is registered, is found below bpy.types, and an operator below bpy.ops."""
        bases, known = self.direct_bases(number)
        if known and not any(base.startswith(T) for base in bases):
            return
        text = literal(identifier) if identifier is not None else name
        if not isinstance(text, str):
            self.own_types[name] = LocalClass(number)
            if not known or any(self.api.descends(base, f"{T}Operator") for base in bases):
                self.own_operators.add(ANY)
            return
        module, is_class_name, operator = text.partition("_OT_")
        if not is_class_name:
            module, _, operator = text.partition(".")
        if module and operator:
            self.own_operators |= {f"bpy.ops.{module.lower()}", f"bpy.ops.{module.lower()}.{operator}"}
            text = f"{module.upper()}_OT_{operator}"
        self.own_types[name] = self.own_types[text] = LocalClass(number)


def _makes_data_class(decorator: ast.expr) -> bool:
    """Whether a decorator is that of ``dataclasses``, which gives an instance what it is made with."""
    function = decorator.func if isinstance(decorator, ast.Call) else decorator
    name = function.attr if isinstance(function, ast.Attribute) else getattr(function, "id", "")
    return name == "dataclass"


def _fields(node: ast.ClassDef) -> tuple[str, ...]:
    return tuple(
        statement.target.id
        for statement in node.body
        if isinstance(statement, ast.AnnAssign) and isinstance(statement.target, ast.Name)
    )
