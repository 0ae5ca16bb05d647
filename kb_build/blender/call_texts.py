"""Calls as text, by their arguments."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from kb_build.index.analysis import split_arguments

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from kb_build.symbols.records import Default, Parameter

# Defaults that are not told, by type: empty ones, and those that are no value to give, as of arrays of any length.
_UNTOLD = {
    "string": "''",
    "list": "[]",
    "enum": "...",
    **dict.fromkeys(("boolean[1]", "float[1]", "int[1]"), "..."),
}
LEFT_OUT = "Left out: "


def python_value(value: Default) -> str:
    """A default as Python source."""
    if isinstance(value, list):
        return f"({', '.join(map(python_value, value))}{',' if len(value) == 1 else ''})"
    return repr(value)


def call_text(name: str, parameters: Iterable[Parameter], *, marked: bool = False) -> str:
    """``modifier_add(type='SUBSURF')``: a call with every argument's default; ``...`` for what is no value to give.

    ``marked`` puts the ``*`` before those that can be given by name only: RNA's functions take by place what they need.
    """
    shown: list[str] = []
    for parameter in parameters:
        if marked and not parameter.required and "*" not in shown:
            shown.append("*")
        if parameter.required:
            shown.append(parameter.name)
        elif parameter.default is None and LEFT_OUT in parameter.description:
            shown.append(f"{parameter.name}=...")
        elif parameter.default is None and (untold := _UNTOLD.get(parameter.type.partition(" ")[0])):
            shown.append(f"{parameter.name}={untold}")
        elif isinstance(parameter.default, list) and parameter.type == "enum":
            chosen = ", ".join(map(repr, parameter.default))  # a list in order, which a set would lose
            shown.append(f"{parameter.name}={{{chosen}}}" if chosen else f"{parameter.name}=set()")
        else:
            shown.append(f"{parameter.name}={python_value(parameter.default)}")
    return f"{name}({', '.join(shown)})"


def requiring(call: str, names: Sequence[str], required: int) -> str:
    """A call's text without arguments, with these: the first ones are required, and others may be left out."""
    shown = (name if place < required else f"{name}=..." for place, name in enumerate(names))
    return f"{call.partition('(')[0]}({', '.join(shown)})"


def with_sets(call: str, parameters: Iterable[Parameter]) -> str:
    """bmesh writes an empty set as ``{}``, which Python would take for a dictionary."""
    for parameter in parameters:
        if parameter.type.startswith("set["):
            call = call.replace(f"{parameter.name}={{}}", f"{parameter.name}=set()")
    return call


def by_place(call: str) -> str:
    """A call's text with the mark of arguments that are given by their places alone."""
    head, _, given = call.removesuffix(")").partition("(")
    return call if not given or "/" in given or "*" in given else f"{head}({given}, /)"


def by_place_up_to(call: str, most: int) -> str:
    """A call's text with the mark before the arguments that are given by their names alone: all but the first few."""
    head, arguments = _parts(call)
    arguments = [text for text in arguments if text not in {"", "*"}]
    named = [text for text in arguments if not text.startswith("**")]
    if len(named) <= most or "/" in named or any(text.startswith("*") for text in named):
        return call
    return f"{head}({', '.join([*arguments[:most], '*', *arguments[most:]])})"


def place_only(call: str, count: int) -> str:
    """A call's text with the mark behind the first arguments that take no name."""
    head, arguments = _parts(call)
    return call if "/" in arguments else f"{head}({', '.join([*arguments[:count], '/', *arguments[count:]])})"


def by_name_too(call: str, name: str) -> str:
    """A call's text without the mark of arguments that are given by their places alone, if a name is among them."""
    head, arguments = _parts(call)
    first = arguments[: arguments.index("/")] if "/" in arguments else []
    if name not in {text.partition("=")[0].partition(":")[0].strip() for text in first}:
        return call
    return f"{head}({', '.join(text for text in arguments if text != '/')})"


def without_default(call: str, name: str) -> str:
    """A call's text in which leaving an argument out is not the same as giving what the call has as its default."""
    return re.sub(rf"\b({name}\b[^,=()]*)=None", r"\1=...", call)


def all_optional(call: str) -> str:
    """A call's text in which no argument is required."""
    head, arguments = _parts(call)
    shown = (text if "=" in text or text.startswith("*") else f"{text}=None" for text in arguments)
    return f"{head}({', '.join(shown)})"


def _parts(call: str) -> tuple[str, list[str]]:
    """A call's text as (what is called, the text of each argument)."""
    head, _, given = call.removesuffix(")").partition("(")
    return head, [text.strip() for text in split_arguments(given)]
