"""Calls as docstrings and signatures write them: their arguments, in their order, with types and defaults."""

from __future__ import annotations

import ast
import re
import textwrap
from dataclasses import replace
from functools import cache

from kb_build.symbols.records import Default, EnumItem, Parameter

DECLARATIONS = (
    *("function", "method", "classmethod", "staticmethod"),
    *("class", "data", "attribute", "property", "exception"),
)
BMESH_OPERATOR = "BMeshOpFunc "  # how the docstring of an operator of bmesh begins, before its call
_DIRECTIVE = re.compile(rf"\.\. (?:{'|'.join(DECLARATIONS)})::[ \t]*(.*)")
BEGINS_CALL = re.compile(r"\w+\s*\(")
_LITERAL = re.compile(r"\bLiteral(\[[^\[\]]*\])")
_LISTED = re.compile(r"\b(?:enum|string|str) in ([\[{(][^\[\]{}()]*[\]})])", re.IGNORECASE)


def split_calls(text: str) -> tuple[list[str], str]:
    """(calls, body) of a docstring: its own directive with one call a line, or a bare call on the first line."""
    first, _, rest = text.partition("\n")
    if first.startswith(BMESH_OPERATOR):
        # The mesh is the only argument that goes by position.
        call = (
            first.removeprefix(BMESH_OPERATOR)
            .strip()
            .replace("(bmesh,", "(bmesh, /, *,")
            .replace("(bmesh)", "(bmesh, /)")
        )
        return [call], rest
    if not _DIRECTIVE.match(first.strip()):
        return [], text
    while first.endswith("\\"):
        line, _, rest = rest.partition("\n")
        first = f"{first[:-1].rstrip()} {line.strip()}"
    match = _DIRECTIVE.match(first.strip())
    calls = [match.group(1).strip()] if match else []
    while (
        calls and BEGINS_CALL.match(calls[0]) and rest[:1].isspace() and BEGINS_CALL.match(rest.lstrip(" \t"))
    ):
        line, _, rest = rest.partition("\n")
        calls.append(line.strip())
    return calls, textwrap.dedent(rest)


@cache
def definition_of(signature: str) -> ast.FunctionDef | None:
    """A call's text as Python reads a definition with these arguments; None where it is not Python."""
    call = signature[signature.index("(") :] if "(" in signature else "("
    for text in (call, call.partition(" -> ")[0]):
        try:
            definition = ast.parse(f"def _{text}: ...").body[0]
        except (SyntaxError, ValueError):
            continue
        assert isinstance(definition, ast.FunctionDef)
        return definition
    return None


def form(call: str) -> tuple[object, ...] | None:
    """What two texts of one call have in common: the arguments, how each is given, and which may be left out; None
    where that is open.
    """
    definition = definition_of(call)
    if definition is None or definition.args.vararg or definition.args.kwarg:
        return None
    arguments = definition.args
    listed = (arguments.posonlyargs, arguments.args, arguments.kwonlyargs)
    names = tuple(tuple(argument.arg for argument in each if argument.arg != "self") for each in listed)
    return *names, len(arguments.defaults), *(default is None for default in arguments.kw_defaults)


def call_parameters(signature: str) -> list[Parameter]:
    """The arguments in a call's text, ``(a, *, b=1)``; [] when it is not Python.

    A default that is a literal is given as its value; one that is an expression stands in the signature alone.
    """
    definition = definition_of(signature)
    if definition is None:
        return []
    arguments = definition.args
    positional = [*arguments.posonlyargs, *arguments.args]
    defaults: list[ast.expr | None] = [None] * (len(positional) - len(arguments.defaults))
    pairs = [*zip(positional, [*defaults, *arguments.defaults], strict=True)]
    pairs += zip(arguments.kwonlyargs, arguments.kw_defaults, strict=True)
    parameters = [
        Parameter(
            name=argument.arg,
            type=annotation(argument.annotation),
            default=_literal(default),
            required=default is None,
        )
        for argument, default in pairs
        if argument.arg != "self"
    ]
    parameters += [Parameter(name=extra.arg) for extra in (arguments.vararg, arguments.kwarg) if extra]
    return parameters


def _literal(expression: ast.expr | None) -> Default:
    """A default's value in JSON's terms, None where it is an expression."""
    try:
        value = ast.literal_eval(expression) if expression else None
    except ValueError:
        return None
    if isinstance(value, set):
        return sorted(value, key=repr)
    return list(value) if isinstance(value, tuple) else value


def annotation(expression: ast.expr | None) -> str:
    """A type as an annotation gives it, the quotes around a whole one left out."""
    if expression is None:
        return ""
    if isinstance(expression, ast.Constant) and isinstance(expression.value, str):
        return expression.value
    return ast.unparse(expression)


def with_values(parameter: Parameter) -> Parameter:
    """The strings that a type or a description allows, as values: ``Literal['A', 'B']``, ``string in ['A']``."""
    kind = parameter.type
    if values := _values(kind, _LITERAL):
        kind = _LITERAL.sub("enum", kind)
    else:
        values = _values(kind, _LISTED) or _values(parameter.description, _LISTED)
    return replace(parameter, type=kind, enum_items=tuple(map(EnumItem, values))) if values else parameter


def _values(text: str, pattern: re.Pattern[str]) -> list[str]:
    """The strings of the list that this pattern finds; [] for several lists, and for other values."""
    lists = pattern.findall(text)
    try:
        held = ast.parse(lists[0], mode="eval").body if len(lists) == 1 else None
    except SyntaxError:
        return []
    values = [ast.literal_eval(item) for item in getattr(held, "elts", ()) if isinstance(item, ast.Constant)]
    whole = len(values) == len(getattr(held, "elts", ())) and all(isinstance(value, str) for value in values)
    return values if whole else []
