"""What operators and functions take and return, an argument a line."""

from __future__ import annotations

import ast
import textwrap
from collections import defaultdict
from typing import TYPE_CHECKING

from kb_build.symbols.flag_names import RETURNS_NONE
from kb_build.symbols.flags import never_taken
from kb_build.symbols.lines import SET, literal, refusal_lines, said_taken, taken_where
from kb_serve.answer.budget import AnswerBlock
from kb_serve.answer.facts.enum_items import item_lines
from kb_serve.answer.facts.properties import UNITS
from kb_serve.answer.facts.ranges import range_text
from kb_serve.signatures import signature_arguments

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence

    from kb_build.symbols.records import Parameter, Symbol
    from kb_serve.answer.facts.asked_values import AskedOf

VALUES_OF = "values of "  # what begins the name of a block of them
_PARAGRAPH = "\n\n"
_NAMED_ITEMS = 40  # enum items in an argument's own line; the full list follows
_MOST_ITEMS = 500  # that are listed one by one
_LONGEST_DEFAULT = 60  # letters
_IN_A_CALL = 20  # arguments
_BMESH_OPERATORS = "bmesh.ops"
_BROWSER_ALWAYS = "filter_folder"  # every operator that opens the file browser has it
_BROWSER = frozenset({"filemode", "display_type", "sort_method", "hide_props_region"})


def arguments(symbol: Symbol, asked: AskedOf) -> Iterator[AnswerBlock]:
    """What an operator or function takes, without what is told already as ``asked`` for, and what it returns."""
    aside = of_file_browser(symbol)
    if symbol.parameters:
        left_out = {*aside, *asked.told}
        lines = argument_lines(symbol, [item for item in symbol.parameters if item.name not in left_out])
        if aside:
            lines.append(f"- of the file browser; a script leaves them out: {_names(aside)}")
        title = "Other parameters" if asked.told else "Parameters"
        if lines:
            yield AnswerBlock(f"**{title}**\n" + "\n".join(lines), "parameters")
    if symbol.returns:
        lines = "\n".join(map(_parameter_line, symbol.returns))
        yield AnswerBlock(f"**Returns**{_kept_in(symbol)}\n{lines}", "returns")
    elif RETURNS_NONE in symbol.flags:
        yield AnswerBlock("**Returns** None: it changes the value that it is called on", "returns")
    if lines := "\n".join(f"- {line}" for line in refusal_lines(symbol)):
        yield AnswerBlock(f"**Refused, of all that was tried**\n{lines}", "refused calls")
    for parameter in symbol.parameters:
        if _has_list(symbol, parameter):
            wanted = asked.values.get(parameter.name, ())
            refused = never_taken(symbol, parameter.name)
            taken = [item for item in parameter.enum_items if item.identifier not in refused]
            listed = [item for item in parameter.enum_items if repr(item.identifier) in wanted]
            # The argument's own line names the others.
            shown = listed if listed and len(parameter.enum_items) <= _NAMED_ITEMS else taken
            items = item_lines(shown, taken_where(symbol, parameter.name), wanted)
            yield AnswerBlock(
                f"**Values of `{parameter.name}`**\n{items}",
                VALUES_OF + parameter.name,
            )


def argument_lines(symbol: Symbol, parameters: Iterable[Parameter]) -> list[str]:
    """Some of the arguments of an operator or function."""
    of_function = symbol.kind == "function"
    defaults = _written_defaults(symbol.signature) if of_function else {}
    return [
        _parameter_line(
            item,
            defaults.get(item.name, ""),
            of_function=of_function,
            refused=never_taken(symbol, item.name),
        )
        + _taken(symbol, item)
        for item in parameters
    ]


def operator_call(operator: Symbol) -> str:
    """An operator's call, without what only the file browser reads."""
    return _call_without(operator.signature, of_file_browser(operator))


def _call_without(signature: str, names: Collection[str]) -> str:
    """An operator's call without some of its arguments, and of very many the first only: all are listed below."""
    if not names and signature.count("=") <= _IN_A_CALL:
        return signature
    try:
        call = ast.parse(signature, mode="eval").body
    except SyntaxError:
        return signature
    if not isinstance(call, ast.Call):
        return signature
    keywords = [keyword for keyword in call.keywords if keyword.arg not in names]
    call.keywords = keywords[:_IN_A_CALL]
    more = len(keywords) - len(call.keywords)
    return ast.unparse(call) + (f"  # and {more} more, see Parameters" if more else "")


def _parameter_line(
    parameter: Parameter,
    written: str = "",
    *,
    of_function: bool = True,
    refused: frozenset[str] = frozenset(),
) -> str:
    """One argument or result. ``written`` is its default as the signature has it; ``refused`` values are left out."""
    head = f"- `{parameter.name}`" if parameter.name else "-"
    kind = SET if parameter.type == "enum" and isinstance(parameter.default, list) else parameter.type
    # RNA gives this size to what may have any, which operators' properties may not.
    notes = [kind.replace("[1]", "[any length]", 1) if of_function else kind]
    if parameter.required:
        notes.append("required")
    elif default := _default_text(parameter, written):
        notes.append(f"default `{default}`")
    if parameter.hard_min is not None or parameter.hard_max is not None:
        notes.append(f"range {range_text(parameter.hard_min, parameter.hard_max, parameter.type)}")
    if parameter.unit:
        notes.append(UNITS.get(parameter.unit, parameter.unit.lower()))
    noted = ", ".join(note for note in notes if note)
    text = f"{head} ({noted})" if noted else head
    if parameter.description:
        said = parameter.description  # its paragraphs belong to the item of the list
        text += f": {textwrap.indent(said, '  ').lstrip() if _PARAGRAPH in said else said}"
    elif parameter.label:
        text += f": {parameter.label}"
    if parameter.values_asked:
        text += f"\n  in a new file one of {_values(parameter.values_asked)}"
    elif parameter.enum_items and not parameter.has_stand_in:
        taken = [item.identifier for item in parameter.enum_items if item.identifier not in refused]
        text += f"\n  one of {_values(taken)}"
    if parameter.has_stand_in:
        listed = [item.identifier for item in parameter.enum_items]
        text += f"\n  {_values(listed)}, which RNA lists, is refused"
    return text


def _default_text(parameter: Parameter, written: str) -> str:
    """An argument's default as Python source; empty for none. ``written`` is what the signature has."""
    told = None if isinstance(parameter.default, list) else parameter.default
    if told is None and written and len(written) <= _LONGEST_DEFAULT:
        return written
    return "" if parameter.default is None else literal(parameter.default, parameter.type)


def _written_defaults(call: str) -> dict[str, str]:
    """The defaults in a call's text by argument, as Python source, where they are told; {} where it is not Python."""
    listed = signature_arguments(call)
    if listed is None:
        return {}
    by_position = [*listed.posonlyargs, *listed.args]
    pairs = [
        *zip(reversed(by_position), reversed(listed.defaults), strict=False),
        *zip(listed.kwonlyargs, listed.kw_defaults, strict=True),
    ]
    told = ((argument.arg, ast.unparse(default)) for argument, default in pairs if default is not None)
    return {name: default for name, default in told if default != "..."}


def _values(identifiers: Sequence[str]) -> str:
    more = f", … {len(identifiers)} in all" if len(identifiers) > _NAMED_ITEMS else ""
    return ", ".join(map(repr, identifiers[:_NAMED_ITEMS])) + more


def _taken(symbol: Symbol, parameter: Parameter) -> str:
    """Which values of an argument only some things take, where no list of its values says it."""
    if _has_list(symbol, parameter):
        return ""
    found: dict[str, list[str]] = defaultdict(list)
    for value, where in taken_where(symbol, parameter.name).items():
        found[where].append(value)
    return "".join(f"\n  {said_taken(where)}: {_values(values)}" for where, values in found.items())


def _has_list(symbol: Symbol, parameter: Parameter) -> bool:
    """Whether the values of an argument are listed one by one."""
    items = () if parameter.name in of_file_browser(symbol) else parameter.enum_items
    if len(items) > _MOST_ITEMS:  # icons, which nobody reads through
        return False
    return len(items) > _NAMED_ITEMS or (
        len(items) > 3 and any(item.description or item.where for item in items)
    )


def _kept_in(symbol: Symbol) -> str:
    """In what a function of ``bmesh.ops`` returns its results; empty for others."""
    return " a dict with these keys" if symbol.owner == _BMESH_OPERATORS else ""


def of_file_browser(symbol: Symbol) -> list[str]:
    """The arguments of an operator on files that say which of them its browser shows, and how."""
    names = [parameter.name for parameter in symbol.parameters]
    if symbol.kind != "operator" or _BROWSER_ALWAYS not in names:
        return []
    return [name for name in names if name.startswith("filter_") or name in _BROWSER]


def _names(names: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)
