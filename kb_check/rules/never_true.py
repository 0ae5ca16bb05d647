"""A comparison with a value that the enumeration never has.

Blender does not refuse it: the condition simply never holds (with ``!=`` it always does), so the branch behind it is
dead. Often the value was renamed.

```python
if context.mode == "WEIGHT_PAINT":  # reported: the mode is called PAINT_WEIGHT
    ...
if context.mode == "PAINT_WEIGHT":
    ...
if node.type == "ShaderNodeEmission":  # reported: its type is "EMISSION", and this its bl_idname
    ...
if context.mode == "EDIT_GPENCIL":  # reported in 5.1: RNA lists it, and no object comes into such a mode
    ...
```

The fix is never sure: a branch that has not run for some versions runs again with it, and may need more than a name.
A value that went and that nothing took the place of is a note, once for all its places in a file: the branch is left
over from another Blender, and does no harm.

Not reported: an empty text, since Blender gives one where a file holds a value that this version does not know; an old
value beside the one that took its place (``ob.type in {"GPENCIL", "GREASEPENCIL"}``, the same with ``or`` or ``elif``).
"""

from __future__ import annotations

import ast
from collections import defaultdict
from dataclasses import replace
from typing import TYPE_CHECKING

from kb_build.symbols.api_names import NODE
from kb_build.symbols.api_names import TYPES as T
from kb_build.symbols.flag_names import NODE_TYPE, READ_ONLY
from kb_build.symbols.paths import item_of
from kb_check.findings import Finding, Fix, told_once
from kb_check.names.lacking import lacking_finding
from kb_check.rule import Rule
from kb_check.script import once_per_script

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from kb_build.symbols.records import EnumItem, Symbol
    from kb_check.script import Script


def _check(script: Script) -> Iterator[Finding]:
    yield from _never_reached(script)
    yield from _class_as_type(script)
    left_over: dict[str, list[Finding]] = {}
    for row in script.missing("compared"):
        if row.value:
            beside = _beside(script).get(row.node, frozenset())
            owner = row.missing[0]
            lacking = script.names.value(owner, row.value, script.api.values_of(owner))
            if any(item_of(path) in beside for path in lacking.instead):
                continue
            lacking = replace(
                lacking, message=f"{lacking.message} The comparison never matches it.", sure=False
            )
            if lacking.removed and not lacking.instead:
                found = lacking_finding(script, RULE.id, row, lacking, "note")
                left_over.setdefault(found.symbol, []).append(found)
            else:
                yield lacking_finding(script, RULE.id, row, lacking, RULE.severity)
    yield from map(told_once, left_over.values())


def _never_reached(script: Script) -> Iterator[Finding]:
    """Comparisons with what RNA lists for a property that Blender alone sets, and nothing that was tried came to have.

    Meant is what has the same label.
    """
    for row in script.resolutions("compared"):
        if (
            not row.sure
            or row.guarded
            or row.missing
            or row.possible
            or not isinstance(row.node, ast.Constant)
        ):
            continue
        symbols = [script.api.symbols.symbol(path) for path in row.symbols]
        never = [
            item
            for symbol in symbols
            if symbol
            for item in _never_had(symbol)
            if item.identifier == row.value
        ]
        if not never or len(never) < len(symbols) or (symbol := symbols[0]) is None:
            continue
        had = [item for item in symbol.enum_items if item.is_taken]
        meant = [item.identifier for item in had if item.name == never[0].name]
        if not _beside(script).get(row.node, frozenset()).isdisjoint(meant):
            continue
        edit = script.renamed(row.node, meant[0]) if len(meant) == 1 else None
        told = f" {' or '.join(map(repr, meant))} has its label." if meant else ""
        yield Finding(
            RULE.id, RULE.severity, script.span(row.node),
            f"RNA lists {row.value!r} for `{symbol.path}`, and nothing comes to have it: the comparison never matches "
            f"it.{told}",
            f"{symbol.path}:{row.value}", tuple(f"{symbol.path}:{name}" for name in meant),
            Fix(f"Write {meant[0]}", (edit,)) if edit else None,
        )  # fmt: skip


def _class_as_type(script: Script) -> Iterator[Finding]:
    """The ``type`` of a node, compared with the name of a class of nodes, which ``bl_idname`` is."""
    for node in script.all(ast.Compare):
        match node:
            case ast.Compare(
                left=ast.Attribute(value=held, attr="type") as left,
                comparators=[ast.Constant(value=str(text))],
            ):
                pass
            case _:
                continue
        symbol = script.api.symbols.symbol(f"{T}{text}") if text.isidentifier() else None
        kind = "".join(symbol.flagged(NODE_TYPE)) if symbol else ""
        cls = script.class_of(held) if kind else ""
        if not cls or not script.api.descends(cls, NODE):
            continue
        edit = script.renamed(left, "bl_idname")
        yield Finding(
            RULE.id, RULE.severity, script.span(node.comparators[0]),
            f"The `type` of a node never is the name of a class: of `{text}` it is {kind!r}, and `bl_idname` is "
            f"{text!r}. The comparison never matches it.",
            f"{NODE}.type", (f"{NODE}.bl_idname",), Fix("Write bl_idname", (edit,)) if edit else None,
        )  # fmt: skip


def _never_had(symbol: Symbol) -> list[EnumItem]:
    """The items that a property is never read as; none of one that scripts may set."""
    items = symbol.enum_items if READ_ONLY in symbol.flags else ()
    return [item for item in items if not item.is_taken]


@once_per_script
def _beside(script: Script) -> dict[ast.AST, frozenset[str]]:
    """Of each text that something is compared with: all texts of the container that it is in, and of the comparisons of
    the same thing beside it, ``engine == "A" or engine == "B"``, or in the branches of one ``if``.
    """
    found: dict[ast.AST, frozenset[str]] = {}
    for tests in _beside_each_other(script):
        asked: defaultdict[str, list[ast.Constant]] = defaultdict(list)
        for left, text in _compared(tests):
            asked[left].append(text)
        for texts in asked.values():
            found.update(dict.fromkeys(texts, frozenset(str(text.value) for text in texts)))
    return found


def _beside_each_other(script: Script) -> Iterator[Sequence[ast.expr]]:
    """The conditions that choose between one and the other, the longest rows last."""
    for alone in script.all(ast.Compare):
        yield (alone,)
    for either in script.all(ast.BoolOp):
        yield (either,)
    in_chains: set[ast.If] = set()
    for first in script.all(ast.If):
        chain = [first]
        while len(chain[-1].orelse) == 1 and isinstance(following := chain[-1].orelse[0], ast.If):
            chain.append(following)
        if first not in in_chains:
            yield [branch.test for branch in chain]
        in_chains.update(chain)


def _compared(tests: Iterable[ast.expr]) -> Iterator[tuple[str, ast.Constant]]:
    """(the source of what is compared, a text) of conditions that hold for one of some texts."""
    for test in tests:
        match test:
            case ast.BoolOp(op=ast.Or(), values=values):
                yield from _compared(values)
            case ast.Compare(left=left, ops=[ast.Eq()], comparators=[ast.Constant(value=str()) as text]):
                yield ast.unparse(left), text
            case ast.Compare(
                left=left, comparators=[ast.Tuple(elts=items) | ast.List(elts=items) | ast.Set(elts=items)]
            ):
                for item in items:
                    if isinstance(item, ast.Constant) and isinstance(item.value, str):
                        yield ast.unparse(left), item
            case _:
                pass


RULE = Rule("never-true", "warning", "A comparison with a value that the enumeration never has", _check)
