"""Whether an expression of a script is recognised by itself, without the lines around it.

What it truly is comes from Blender's own scripts, read as a whole: the types that flow through a script say what
each attribute belongs to. Each expression is asked as it stands, with a variable's name that tells nothing, and behind
the line that gave that variable its value.
"""

from __future__ import annotations

import ast
import random
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.symbols.paths import plain_path
from kb_serve.knowledge_base import KnowledgeBase
from measurements.blender_scripts import read_all, scripts_folder, why_none
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from kb_build.flow.analysis import Analysis
    from measurements.setting import Setting

_SEED = 11
_ASKED = 1_000
_ASKED_QUICKLY = 100
_LONGEST = 80  # letters of an expression
_NEAR = 10  # lines up to the one that binds a variable
_NAMELESS = "thing"
_NOT_VARIABLES = frozenset({"bpy", "context", "cls", "self"})
_BOUND = "… behind the line that binds it"
_HEADER = ("expressions of Blender's own scripts, asked alone", "asked", "right first", "among five")
_NOTE = (
    f"An attribute of a variable, as types that flow through the whole script say what it is. {_ASKED:,} different "
    f"ones, drawn at random with seed {_SEED}. Many names are those of several classes: nothing but the lines around "
    "them tells which."
)


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression, the same with another variable, the same behind the line that binds that (empty where none is
    near), and the paths of the symbols that it may be.
    """

    source: str
    nameless: str
    bound: str
    symbols: frozenset[str]


def measure(setting: Setting) -> ReportPart:
    """Reads Blender's own scripts in this process, and asks for the expressions drawn; ``quick`` asks fewer."""
    if (folder := scripts_folder(setting.base)) is None:
        return ReportPart("expressions", skipped=(why_none(setting.base),))
    say("expressions: reading Blender's own scripts")
    found = sorted(_expressions(setting.base, folder), key=lambda each: each.source)
    drawn = random.Random(_SEED).sample(found, min(len(found), _ASKED_QUICKLY if setting.quick else _ASKED))
    say("expressions: asking")
    asked = {
        "as they stand": [(each.source, each.symbols) for each in drawn],
        f"with a variable called {_NAMELESS}": [(each.nameless, each.symbols) for each in drawn],
        _BOUND: [(each.bound, each.symbols) for each in drawn if each.bound],
    }
    with KnowledgeBase(setting.base) as knowledge:
        shares = {how: _shares(knowledge, each) for how, each in asked.items()}
    rows = tuple(
        (how, f"{len(asked[how]):,}", f"{first:.3f}", f"{five:.3f}") for how, (first, five) in shares.items()
    )
    (first, five), nameless, bound = shares.values()
    return ReportPart(
        "expressions",
        (
            TargetFigure("expressions1", first, f"{len(drawn):,} of {len(found):,} different ones"),
            TargetFigure("expressions5", five),
            TargetFigure("nameless5", nameless[1], f"first: {nameless[0]:.3f}"),
            TargetFigure("bound5", bound[1], f"{len(asked[_BOUND]):,} that are bound within {_NEAR} lines"),
        ),
        (Table("Expressions by themselves", _HEADER, rows, _NOTE),),
    )


def _expressions(base: Path, folder: Path) -> set[Expression]:
    symbols_of: dict[tuple[str, str], set[str]] = {}
    bound: dict[tuple[str, str], str] = {}
    for analysis in read_all(base, folder):
        for source, nameless, binding, paths in _of_variables(analysis):
            symbols_of.setdefault((source, nameless), set()).update(paths)
            bound[source, nameless] = bound.get((source, nameless)) or binding
    return {
        Expression(*texts, f"{bound[texts]}\n    {texts[1]}" if bound[texts] else "", frozenset(paths))
        for texts, paths in symbols_of.items()
    }


def _of_variables(analysis: Analysis) -> Iterator[tuple[str, str, str, Sequence[str]]]:
    """(expression, the same with another variable, the line that binds that, what it is) for the attributes of a script
    that start at a variable.
    """
    bindings = sorted(_bindings(analysis.tree)) if analysis.tree else []
    for node in ast.walk(analysis.tree) if analysis.tree else ():
        resolution = analysis.resolutions.get(node) if isinstance(node, ast.Attribute) else None
        root = _root(node)
        if resolution is None or not resolution.symbols or root is None or root.id in _NOT_VARIABLES:
            continue
        source, own = ast.unparse(node), root.id
        if len(source) <= _LONGEST and source.startswith(own) and root not in analysis.resolutions:
            nameless = _NAMELESS + source[len(own) :]
            near = [line for at, name, line in bindings if name == own and 0 < root.lineno - at <= _NEAR]
            whole = [
                plain_path(path) for path in resolution.symbols
            ]  # parameters are in their operator's answer
            yield source, nameless, near[-1] if near else "", whole


def _bindings(tree: ast.Module) -> Iterator[tuple[int, str, str]]:
    """(line, variable, the statement with another variable) for the statements that bind one."""
    for node in ast.walk(tree):
        match node:
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                yield node.lineno, name, f"{_NAMELESS} = {ast.unparse(value)}"
            case ast.For(target=ast.Name(id=name), iter=value):
                yield node.lineno, name, f"for {_NAMELESS} in {ast.unparse(value)}:"
            case _:
                pass


def _root(node: ast.AST) -> ast.Name | None:
    """The variable that an expression begins with."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Call):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node if isinstance(node, ast.Name) else None


def _shares(knowledge: KnowledgeBase, asked: Sequence[tuple[str, frozenset[str]]]) -> tuple[float, float]:
    """The shares of which a right symbol comes first, and among five; behind another line, that comes first."""
    ids = [([hit.id for hit in knowledge.query(source).hits], symbols) for source, symbols in asked]
    first, five = (sum(not symbols.isdisjoint(hits[:count]) for hits, symbols in ids) for count in (1, 5))
    return first / max(1, len(asked)), five / max(1, len(asked))
