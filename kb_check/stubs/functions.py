"""Functions, methods and operators as the definitions of a stub."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import DERIVED_BY_SCRIPTS, SAME_CLASS
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import OF_CLASS, STATIC
from kb_check.stubs.annotations import ANY, MAYBE_NONE, RNA_TYPES
from kb_check.stubs.names import docstring, is_writable
from kb_serve.signatures import signature_arguments

if TYPE_CHECKING:
    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.stubs.annotations import Annotations

# Modules written in C, whose documentation leaves out only the result None.
_DOCUMENTED = ("mathutils", "bmesh", "gpu", "blf", "bl_math")
BMESH_OPERATORS = "bmesh.ops"
_LONGEST_DEFAULT = 40
_FIRST = {"method": "self", "class": "cls", "static": "", "function": ""}


@dataclass(frozen=True, slots=True)
class Argument:
    """A parameter as it is written: ``name: annotation = default``; kind as inspect names it in ``/`` and ``*``."""

    name: str
    annotation: str
    default: str = ""
    star: str = ""  # "*" or "**"

    def __str__(self) -> str:
        default = f" = {self.default}" if self.default else ""
        return f"{self.star}{self.name}: {self.annotation}{default}"


@dataclass(slots=True)
class Signature:
    """The parameters of a function: before ``/``, usual ones, and behind ``*``."""

    positional: list[Argument]
    usual: list[Argument]
    keywords: list[Argument]

    def text(self, first: str = "") -> str:
        """All of them as they stand between the brackets; ``first`` is ``self`` or ``cls``."""
        rows = [first] if first else []
        rows += map(str, self.positional)
        if self.positional:
            rows.append("/")
        rows += map(str, self.usual)
        if self.keywords:
            if not self.keywords[0].star:
                rows.append("*")
            rows += map(str, self.keywords)
        return ", ".join(rows)

    def replaced(self, name: str, annotation: str) -> Signature:
        """The same with another type for one parameter, which must be given."""

        def row(arguments: list[Argument]) -> list[Argument]:
            return [Argument(a.name, annotation, "", a.star) if a.name == name else a for a in arguments]

        usual, keywords = row(self.usual), row(self.keywords)
        place = next((i for i, argument in enumerate(usual) if argument.name == name), len(usual))
        if any(argument.default for argument in usual[:place]):
            # What must be given cannot follow what need not, except by its name.
            usual, keywords = usual[:place], usual[place:] + keywords
        return Signature(row(self.positional), usual, keywords)


class Functions:
    """Writes functions."""

    def __init__(self, annotations: Annotations, *, with_docs: bool) -> None:
        self._annotations = annotations
        self._with_docs = with_docs

    def signature(self, symbol: Symbol) -> Signature:
        """The parameters of a function, as its signature orders them or else as its records do."""
        arguments = signature_arguments(symbol.signature)
        known = {parameter.name: parameter for parameter in symbol.parameters}
        if arguments is None:
            return self._from_records(symbol)
        found = Signature([], [], [])
        rows = [*arguments.posonlyargs, *arguments.args]
        defaults = [None] * (len(rows) - len(arguments.defaults)) + list(arguments.defaults)
        optional = False
        for place, (row, default) in enumerate(zip(rows, defaults, strict=True)):
            if place == 0 and row.arg in {"self", "cls"} and row.arg not in known:
                continue
            optional = optional or default is not None or _is_optional(known.get(row.arg))
            argument = self._argument(row.arg, known, symbol, default, optional=optional)
            (found.positional if row in arguments.posonlyargs else found.usual).append(argument)
        if arguments.vararg:
            found.keywords.append(Argument(arguments.vararg.arg, ANY, star="*"))
        for row, default in zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True):
            if is_writable(row.arg):
                is_optional = default is not None or _is_optional(known.get(row.arg))
                found.keywords.append(self._argument(row.arg, known, symbol, default, optional=is_optional))
        if arguments.kwarg:
            found.keywords.append(Argument(arguments.kwarg.arg, ANY, star="**"))
        if found.keywords and found.keywords[0].star == "**":
            found.usual.append(found.keywords.pop(0))
        return found

    def _argument(
        self,
        name: str,
        known: dict[str, Parameter],
        symbol: Symbol,
        default: ast.expr | None,
        *,
        optional: bool,
    ) -> Argument:
        parameter = known.get(name)
        annotation = self._annotations.parameter(parameter, symbol.path) if parameter else ANY
        written = _default(default) if optional else ""
        if written in {"True", "False"} and "bool" not in annotation:
            written = "..."  # documented as another type
        if written == "None" and annotation != ANY and not annotation.endswith("None"):
            annotation += " | None"
        return Argument(name, annotation, written)

    def _from_records(self, symbol: Symbol) -> Signature:
        """What is required behind what is not can only be given by its name."""
        found = Signature([], [], [])
        optional = False
        for parameter in symbol.parameters:
            if not is_writable(parameter.name):
                continue
            optional = optional or not parameter.required
            annotation = self._annotations.parameter(parameter, symbol.path)
            argument = Argument(parameter.name, annotation, "" if parameter.required else "...")
            (found.keywords if optional and parameter.required else found.usual).append(argument)
        return found

    def result(self, symbol: Symbol, owner: str = "") -> str:
        """What a function returns."""
        if symbol.owner == BMESH_OPERATORS and symbol.returns:
            return f"{symbol.path}_result"
        declared = f"{T}{symbol.returns[0].type}" if len(symbol.returns) == 1 else ""
        if owner and symbol.name in SAME_CLASS and self._annotations.api.descends(owner, declared):
            return "typing_extensions.Self"
        is_told = symbol.path.startswith(_DOCUMENTED) or any(
            parameter.plain_type in RNA_TYPES and parameter.type not in {"int", "float"}
            for parameter in symbol.parameters
        )
        text = self._annotations.results(symbol, "None" if is_told or symbol.name == "__init__" else ANY)
        makes = symbol.name in {"new", "add", "create", "load"} or symbol.name.startswith("new_")
        if text.startswith(T) and "|" not in text and not makes and len(symbol.returns) == 1:
            text += f" | {MAYBE_NONE}"
        return text

    @staticmethod
    def binding(symbol: Symbol, owner: str) -> str:
        """How a function is bound: method, class, static, or function."""
        if not owner:
            return "function"
        if OF_CLASS in symbol.flags or (STATIC in symbol.flags and owner in DERIVED_BY_SCRIPTS):
            return "class"
        return "static" if STATIC in symbol.flags else "method"

    def define(self, symbol: Symbol, owner: str = "") -> str:
        """A function's definition."""
        return self.definition(symbol, owner, self.signature(symbol), self.result(symbol, owner))

    def operator_result(self, symbol: Symbol) -> str:
        """The class of what an operator of bmesh returns, a dictionary of lists."""
        rows = [f"    {row.name}: {self._annotations.text(row.type, symbol.path)}" for row in symbol.returns]
        return "\n".join([f"class {symbol.name}_result(typing.TypedDict):", *rows])

    def definition(
        self, symbol: Symbol, owner: str, signature: Signature, result: str, *, docs: bool = True
    ) -> str:
        """A definition with these parameters and this result."""
        binding = self.binding(symbol, owner)
        decorator = {"class": "@classmethod\n", "static": "@staticmethod\n"}.get(binding, "")
        said = docstring(symbol.description) if self._with_docs and docs else ""
        end = f"\n    {said}" if said else " ..."
        return f"{decorator}def {symbol.name}({signature.text(_FIRST[binding])}) -> {result}:{end}"

    def operator(self, symbol: Symbol) -> str:
        """An operator's definition: its context and whether it can be undone come first, all else by keyword."""
        arguments: list[Argument] = []
        for parameter in symbol.parameters:
            if is_writable(parameter.name):
                annotation = self._annotations.parameter(parameter, symbol.path)
                is_settings = "_OT_" in parameter.type or parameter.type.startswith("list of")
                default = _default_of(parameter)
                arguments.append(Argument(parameter.name, ANY if is_settings else annotation, default))
        first = [Argument("execution_context", "str", "..."), Argument("with_undo", "bool", "...")]
        text = Signature(first, [], arguments).text()
        said = docstring(symbol.label, symbol.description) if self._with_docs else ""
        end = f"\n    {said}" if said else " ..."
        return f"@bpy._typing.operator\ndef {symbol.name}({text}) -> set[bpy._typing.OperatorResult]:{end}"


def _is_optional(parameter: Parameter | None) -> bool:
    return parameter is not None and not parameter.required


def _default(node: ast.expr | None) -> str:
    """A default as it is written: short constants as they are."""
    value = node.operand if isinstance(node, ast.UnaryOp) else node
    if node is None or not isinstance(value, ast.Constant):
        return "..."
    text = ast.unparse(node)
    return text if len(text) <= _LONGEST_DEFAULT else "..."


def _default_of(parameter: Parameter) -> str:
    value = parameter.default
    if isinstance(value, list) or value is None:
        return "..."
    text = repr(value)
    return text if len(text) <= _LONGEST_DEFAULT and "inf" not in text and "nan" not in text else "..."
