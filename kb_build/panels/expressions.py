"""The expressions of a function that draws: their text with names written out, and as conditions."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from kb_build.flow.values.types import Plain, Sequence, Tuple, literal, members
from kb_build.panels.formulas import (
    FALSE,
    TRUE,
    YES,
    Answer,
    Formula,
    Question,
    all_of,
    chosen,
    either_of,
    negated,
)
from kb_build.symbols.flag_names import ENUM_FLAG

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.symbols import Symbols
    from kb_build.flow.values.types import Type

# What the truth of a value says, by the type of its property.
_TRUTH = {"pointer": "is set", "int": "is not 0", "float": "is not 0", "string": "is not empty"}
_ORDER: dict[type[ast.cmpop], str] = {
    ast.Gt: ">", ast.GtE: ">=", ast.Lt: "<", ast.LtE: "<=", ast.Eq: "==", ast.NotEq: "==",
}  # fmt: skip
_CONTEXT = frozenset({"context", "_context"})


@dataclass(frozen=True, slots=True)
class Held:
    """What a name holds: the text that it stands for, the condition that its truth is, and a layout's number.

    ``source``: the attribute that it is another name of.
    """

    text: str
    truth: Formula
    layout: int | None = None
    source: ast.Attribute | None = field(default=None, compare=False)


@dataclass(slots=True)
class Script:
    """A script with its functions, by name: those of the module, and those of each class, inherited ones included."""

    analysis: Analysis
    symbols: Symbols
    functions: Mapping[str, ast.FunctionDef]
    methods: Mapping[str, Mapping[str, ast.FunctionDef]]
    fresh: int = 0

    def unknown(self) -> Answer:
        """A condition of which nothing is known."""
        return Answer(Question(self.unknown_text()), YES)

    def unknown_text(self) -> str:
        """The text of something that no other expression is."""
        self.fresh += 1
        return f"?{self.fresh}"


def is_unknown(text: str) -> bool:
    """Whether a text stands for something that nobody knows."""
    return text.startswith("?")


class Conditions:
    """Reads the expressions of one function, with what its names hold at this place."""

    def __init__(self, script: Script, cls: str = "") -> None:
        self.script = script
        self.cls = cls
        self.names: dict[str, Held] = {}

    def called(self, function: ast.FunctionDef, arguments: list[ast.expr], *, is_bound: bool) -> Formula:
        """The truth of what a function of the script returns."""
        raise NotImplementedError

    def type_of(self, node: ast.expr) -> Type | None:
        """What an expression is; None where that was not found."""
        return self.script.analysis.types.get(node)

    # Text.

    def text(self, node: ast.expr) -> str:  # noqa: PLR0911 - one return a form
        """An expression with names written out: the same text stands for the same thing in a function."""
        match node:
            case ast.Name():
                if node.id in self.names:
                    return self.names[node.id].text
                return "context" if node.id in _CONTEXT else node.id
            case ast.Attribute():
                return f"{self.text(node.value)}.{node.attr}"
            case ast.Constant():
                return repr(node.value)
            case ast.NamedExpr():
                return self.text(node.value)
            case ast.Subscript():
                return f"{self.text(node.value)}[{self.text(node.slice)}]"
            case ast.Call(keywords=[]):
                return f"{self.text(node.func)}({', '.join(map(self.text, node.args))})"
            case _:
                return self.script.unknown_text()

    # Conditions.

    def truth(self, node: ast.expr) -> Formula:  # noqa: PLR0911 - one return a form
        """When an expression is true."""
        match node:
            case ast.Constant():
                return TRUE if node.value else FALSE
            case ast.BoolOp(op=ast.And()):
                return all_of(*map(self.truth, node.values))
            case ast.BoolOp():
                return either_of(*map(self.truth, node.values))
            case ast.UnaryOp(op=ast.Not()):
                return negated(self.truth(node.operand))
            case ast.IfExp():
                return chosen(self.truth(node.test), self.truth(node.body), self.truth(node.orelse))
            case ast.Compare(ops=[operator], comparators=[right]):
                return self._comparison(node, operator, right)
            case ast.NamedExpr():
                return self.truth(node.value)
            case ast.Name() if node.id in self.names:
                return self.names[node.id].truth
            case ast.Call():
                return self._call(node)
            case _:
                return Answer(self._question(node), YES)

    def _properties(self, node: ast.expr) -> tuple[str, ...]:
        """The properties that an expression can be."""
        row = self.script.analysis.resolutions.get(node)
        if not isinstance(node, ast.Attribute) or row is None or row.kind != "attribute":
            return ()
        return row.symbols or row.possible

    def _type_of_properties(self, paths: tuple[str, ...]) -> str:
        """The type that properties have in common; empty for none, and for arrays."""
        found = {
            symbol.type
            for path in paths
            if (symbol := self.script.symbols.symbol(path))
            and symbol.kind == "property"
            and not symbol.array
            and ENUM_FLAG not in symbol.flags
        }
        return found.pop() if len(found) == 1 else ""

    def _question(self, node: ast.expr, relation: str = "") -> Question:
        """What is asked where an expression is a condition, or ``relation`` is asked of it."""
        text, paths = self.text(node), self._properties(node)
        kind = self._type_of_properties(paths)
        relation = relation or ("" if kind == "boolean" else _TRUTH.get(kind, ""))
        if isinstance(node, ast.Attribute) and not paths:
            return Question(text, self.text(node.value), (), relation)
        if not isinstance(node, ast.Attribute) or not kind or (kind != "boolean" and not relation):
            return Question(text, relation=relation)
        return Question(text, self.text(node.value), paths, relation)

    def _comparison(self, node: ast.Compare, operator: ast.cmpop, right: ast.expr) -> Formula:
        left = self._meant(node.left.value if isinstance(node.left, ast.NamedExpr) else node.left)
        is_not = isinstance(operator, (ast.NotEq, ast.IsNot, ast.NotIn))
        values = self._values(right)
        if not values or isinstance(operator, (ast.In, ast.NotIn)) == isinstance(right, ast.Constant):
            return self._not_understood(node)
        kind = self._type_of_properties(self._properties(left))
        held: Formula
        if values == [None] and not isinstance(operator, (ast.In, ast.NotIn)):
            held = negated(self.truth(left)) if kind in {"", "pointer"} else self._not_understood(node)
        elif all(isinstance(value, bool) for value in values) and len(values) == 1:
            truth = self.truth(left)
            held = truth if values[0] else negated(truth)
        elif (
            all(isinstance(value, str) for value in values)
            and isinstance(left, ast.Attribute)
            and (kind == "enum" or not self._properties(left))
        ):
            question = Question(self.text(left), self.text(left.value), self._properties(left))
            held = Answer(question, frozenset(map(str, values)))
        elif kind in {"int", "float"} and type(operator) in _ORDER and isinstance(values[0], (int, float)):
            held = Answer(self._question(left, f"{_ORDER[type(operator)]} {values[0]!r}"), YES)
        else:
            return self._not_understood(node)
        return negated(held) if is_not else held

    def _meant(self, node: ast.expr) -> ast.expr:
        """The attribute that a name is another name of, while that is still the same."""
        held = self.names.get(node.id) if isinstance(node, ast.Name) else None
        source = held.source if held else None
        return source if source and held and self.text(source) == held.text else node

    def _not_understood(self, node: ast.expr) -> Formula:
        return Answer(Question(self.text(node)), YES)

    def _values(self, node: ast.expr) -> list[object]:
        """The literals that an expression is, or that it holds."""
        if isinstance(node, ast.Constant):
            return [node.value]
        if isinstance(node, (ast.Set, ast.Tuple, ast.List)):
            return [item.value for item in node.elts if isinstance(item, ast.Constant)] * all(
                isinstance(item, ast.Constant) for item in node.elts
            )
        return list(_literals(self.type_of(node)))

    def _call(self, node: ast.Call) -> Formula:
        function = None
        is_bound = False
        match node.func:
            case ast.Name(id="bool") if len(node.args) == 1:
                return self.truth(node.args[0])
            case ast.Name():
                function = self.script.functions.get(node.func.id)
            case ast.Attribute(value=ast.Name(id=name)):
                is_own = name in {"self", "cls"}
                function = self.script.methods.get(self.cls if is_own else name, {}).get(node.func.attr)
                kinds = _decorators(function)
                is_bound = "staticmethod" not in kinds and (is_own or "classmethod" in kinds)
            case _:
                pass
        if function is None or node.keywords or any(isinstance(arg, ast.Starred) for arg in node.args):
            return self._not_understood(node)
        return self.called(function, node.args, is_bound=is_bound)


def _decorators(function: ast.FunctionDef | None) -> set[str]:
    nodes = function.decorator_list if function is not None else ()
    return {node.id for node in nodes if isinstance(node, ast.Name)}


def _literals(kind: Type | None) -> Iterator[object]:
    """The literals of a tuple or list of them; nothing for anything else."""
    if isinstance(kind, Tuple):
        held = list(kind.items)
    elif isinstance(kind, Sequence):
        held = list(members(kind.element))
    else:
        return
    if all(isinstance(item, Plain) and item.value is not None for item in held):
        yield from map(literal, held)
