"""Writes right names in the place of wrong ones, and tells where that is all that it takes.

A new name is sure only where what is given by the old one is taken by the new one too: the keywords of a call, the
values of an enumeration. What belongs together is written together, or left: an operator and its keywords, and what is
read from something that itself has another name.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.syntax.trees import walk
from kb_build.flow.values.types import UNKNOWN, Module, Plain, members
from kb_build.symbols.api_names import OPERATORS
from kb_build.symbols.flag_names import READ_ONLY
from kb_build.symbols.paths import item_of, split_path
from kb_check.findings import Edit, Fix, Span
from kb_check.names.uses import are_refused
from kb_check.script import once_per_script
from kb_check.syntax.bindings import bindings
from kb_check.syntax.literals import written
from kb_check.values.conversions import misfit
from kb_check.values.given import assigned, property_taker

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_build.flow.values.types import Resolution
    from kb_build.symbols.records import Parameter, Symbol
    from kb_check.names.known import Lacking
    from kb_check.script import Script

_TAKES = {
    "boolean": {bool, int},
    "int": {bool, int},
    "float": {bool, int, float},
    "string": {str},
    "enum": {str},
}


def renaming(script: Script, row: Resolution, lacking: Lacking) -> Fix | None:
    """Writes the right name in the place of a wrong one, where only the name differs."""
    if not lacking.replacement or (row.kind == "value" and not isinstance(row.node, ast.Constant)):
        return None
    if lacking.replacement.startswith(OPERATORS) and row.kind == "attribute":
        return _renamed_operator(script, row, lacking)
    owner, name = _split(lacking.replacement)
    same_owner = "." not in lacking.replacement or any(
        cls == owner for missing in row.missing for cls in (missing, *script.api.lineage(missing))
    )
    # A property that became a socket is not reached by its name.
    is_alike = (row.kind == "item") == ('puts["' in lacking.replacement) or "." not in lacking.replacement
    node = row.node.slice if isinstance(row.node, ast.Subscript) else row.node
    if not same_owner or not is_alike or not name or (edit := script.renamed(node, name)) is None:
        return None
    if _is_refused(script, row, lacking.replacement) or not _is_reached(script, row, lacking):
        return None
    sure = lacking.sure and _takes_its_keywords(script, row.node, row, lacking)
    if row.kind == "keyword":
        return _renamed_keyword(script, row, name, edit, sure=sure)
    values = _values_beside(script, row, lacking)
    is_refused = values is None and isinstance(_assigned(row), ast.Constant)
    fix = Fix(f"Write {name}", (edit, *(values or ())), sure=sure and values is not None)
    return None if is_refused else fix


# Calls.


def may_take(script: Script, parameter: Parameter, value: ast.expr) -> bool:
    """Whether a parameter may take what is given: what was a switch may have become a choice."""
    if parameter.plain_type not in _TAKES:
        return True
    if not isinstance(value, ast.Constant):
        taken = {kind.__name__ for kind in _TAKES[parameter.plain_type]}
        kinds = members(script.type_of(value) or UNKNOWN)
        return not all(isinstance(kind, Plain) and kind.kind not in taken for kind in kinds)
    listed = {item.identifier for item in parameter.enum_items}
    if isinstance(value.value, str) and listed and not parameter.is_open:
        return value.value in listed
    return type(value.value) in _TAKES[parameter.plain_type]


def _renamed_keyword(script: Script, row: Resolution, name: str, edit: Edit, *, sure: bool) -> Fix | None:
    """Writes the name of another keyword, unless the call has that already."""
    call = next((one for one in _calls(row) if row.node in one.keywords), None)
    if call is not None and any(keyword.arg == name for keyword in call.keywords):
        return None
    return Fix(f"Write {name}", (edit,), sure=sure and _is_of_right_callee(script, row))


def _renamed_operator(script: Script, row: Resolution, lacking: Lacking) -> Fix | None:
    """Writes the module and the name of another operator: ``export_scene.obj`` → ``wm.obj_export``."""
    node = row.node
    if isinstance(node, ast.Attribute) and row.missing == ("bpy.ops",):  # the whole module is gone
        node = next((each for each in script.all(ast.Attribute) if each.value is row.node), node)
    if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Attribute):
        return None
    if script.type_of(node.value.value) != Module("bpy.ops"):
        return None
    former, new = f"{node.value.attr}.{node.attr}", lacking.replacement.removeprefix(OPERATORS)
    end, begin = script.name_span(node), script.name_span(node.value)
    span = Span(begin.line, begin.column, end.end_line, end.end_column)
    if begin.line != end.end_line or script.text(span) != former:
        return None
    if former.partition(".")[0] == new.partition(".")[0]:
        span, new = end, new.partition(".")[2]
    sure = lacking.sure and _takes_its_keywords(script, node, row, lacking)
    return Fix(f"Write {new}", (Edit(span, new),), sure=sure)


def _takes_its_keywords(script: Script, callee: ast.AST, row: Resolution, lacking: Lacking) -> bool:
    """Whether what is called under a new name takes the keywords that are given, as they are or by new names."""
    call = next((one for one in _calls(row) if one.func is callee), None)
    symbol = script.api.symbols.symbol(lacking.replacement)
    if call is None or symbol is None or not symbol.parameters:
        return True
    parameters = {parameter.name: parameter for parameter in symbol.parameters}
    return any(name.startswith("*") for name in parameters) or all(
        keyword.arg is None or _takes_keyword(script, lacking.symbol, parameters, keyword)
        for keyword in call.keywords
    )


def _takes_keyword(
    script: Script, former: str, parameters: dict[str, Parameter], keyword: ast.keyword
) -> bool:
    if keyword.arg in parameters:
        return may_take(script, parameters[keyword.arg], keyword.value)
    known = script.names.path(f"{former}({keyword.arg})")
    if known is None or not known.sure:
        return False
    named = parameters.get(_split(known.replacement)[1])
    return named is None or may_take(script, named, keyword.value)


def _is_of_right_callee(script: Script, row: Resolution) -> bool:
    """Whether what takes a keyword is called by its right name, or surely will be."""
    call = next((one for one in _calls(row) if row.node in one.keywords), None)
    callee = script.analysis.resolutions.get(call.func) if call else None
    if call is None or callee is None or not callee.missing or callee.symbols:
        return True
    lacking = script.names.member(callee.missing[0], callee.value)
    fix = renaming(script, callee, lacking)
    return fix is not None and fix.sure


def _calls(row: Resolution) -> Iterator[ast.Call]:
    return (node for node in walk(row.statement or row.node) if isinstance(node, ast.Call))


# Properties.


def _is_reached(script: Script, row: Resolution, lacking: Lacking) -> bool:
    """Whether all that a member of a former class is read from is called by its right name, or surely will be."""
    if not isinstance(row.node, ast.Attribute) or script.api.is_class(lacking.symbol.rpartition(".")[0]):
        return True
    rows = (script.analysis.resolutions.get(part) for part in _read_from(script, row.node.value))
    return all(
        bool(script.names.successor(one.missing[0], one.value))
        for one in rows
        if one is not None and one.kind == "attribute" and one.missing and not (one.symbols or one.possible)
    )


def _read_from(script: Script, node: ast.expr) -> Iterator[ast.AST]:
    """The parts of an expression, and of those that its names may hold, or be an item of."""
    waiting, followed = [node], set[str]()
    for whole in waiting:  # it grows
        for part in walk(whole):
            yield part
            if isinstance(part, ast.Name) and part.id not in followed:
                followed.add(part.id)
                waiting += (value for value in bindings(script).get(part.id, []) if value)
                waiting += _iterated(script).get(part.id, [])


@once_per_script
def _iterated(script: Script) -> dict[str, list[ast.expr]]:
    """Name → what loops take its values from."""
    found: dict[str, list[ast.expr]] = {}
    for loop in script.all(ast.For, ast.comprehension):
        for part in walk(loop.target):
            if isinstance(part, ast.Name):
                found.setdefault(part.id, []).append(loop.iter)
    return found


def _is_refused(script: Script, row: Resolution, replacement: str) -> bool:
    """Whether the right name surely does not take what the script does with it: ``use_alpha = True`` is no alpha_mode,
    and what is called is a function.
    """
    value = _assigned(row)
    symbol = script.api.symbols.symbol(replacement)
    if row.kind == "store" and symbol is not None and READ_ONLY in symbol.flags:
        return True
    if symbol is not None and isinstance(row.node, ast.Attribute) and are_refused(script, row.node, symbol):
        return True
    if value is None or symbol is None or symbol.kind != "property":
        return False
    return misfit(script, property_taker(symbol), value) is not None


def _assigned(row: Resolution) -> ast.expr | None:
    return assigned(row.statement, row.node) if isinstance(row.node, ast.Attribute) else None


def _values_beside(script: Script, row: Resolution, lacking: Lacking) -> tuple[Edit, ...] | None:
    """The edits of the values that are given to a property, or compared with it, beside its own: none where it takes
    them as they are. None where it may lack one of them, and where nobody knows what became of that.
    """
    symbol = script.api.symbols.symbol(lacking.replacement)
    if not isinstance(row.node, ast.Attribute) or symbol is None or symbol.type != "enum":
        return ()
    taken = frozenset(script.api.values_of(symbol.path))
    if symbol.enum_computed or not taken:
        return ()
    edits: list[Edit] = []
    for value in _given_or_compared(script, row):
        if not isinstance(value, ast.Constant):
            if _has_lost_values(script, lacking.symbol, taken):
                return None
        elif isinstance(value.value, str) and value.value not in taken:
            edit = _renamed_value(script, lacking, symbol, value)
            if edit is None:
                return None
            edits.append(edit)
    return tuple(edits)


def _given_or_compared(script: Script, row: Resolution) -> Iterator[ast.expr]:
    """What a statement assigns to a property, or compares with it: the items of what is written out."""
    if isinstance(row.node, ast.Attribute) and (value := assigned(row.statement, row.node)) is not None:
        yield from _parts(script, value)
    for side in _compared(script).get(row.node, ()):
        yield from _parts(script, side)


@once_per_script
def _compared(script: Script) -> dict[ast.AST, list[ast.expr]]:
    """Each side of a comparison → the others."""
    found: dict[ast.AST, list[ast.expr]] = {}
    for node in script.all(ast.Compare):
        sides = [node.left, *node.comparators]
        found |= {side: [other for other in sides if other is not side] for side in sides}
    return found


def _parts(script: Script, value: ast.expr) -> list[ast.expr]:
    whole = written(script, value)
    if isinstance(whole, ast.IfExp):
        return [*_parts(script, whole.body), *_parts(script, whole.orelse)]
    return whole.elts if isinstance(whole, (ast.Tuple, ast.List, ast.Set)) else [whole]


def _renamed_value(script: Script, lacking: Lacking, symbol: Symbol, value: ast.Constant) -> Edit | None:
    known = script.names.path(f"{lacking.symbol}:{value.value}")
    if known is None or not known.sure or not known.replacement.startswith(f"{symbol.path}:"):
        return None
    return script.renamed(value, _split(known.replacement)[1])


def _has_lost_values(script: Script, former: str, taken: frozenset[str]) -> bool:
    """Whether a property had values that the one in its place lacks."""
    rows = script.names.reader.rows(
        "SELECT path FROM removed WHERE path > ? AND path < ?", f"{former}:", f"{former};"
    )
    return any(item_of(path) not in taken for (path,) in rows)


def _split(path: str) -> tuple[str, str]:
    """``a`` and ``b`` of ``a.b``, ``a(b)``, ``a:b``, ``a.inputs["b"]``; ``a(c)`` and ``b`` of ``a(c):b``."""
    owner, _, name = split_path(path)
    return owner, name
