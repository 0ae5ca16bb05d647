"""Whether an expression of a script is recognised by itself, without the lines around it.

What it truly is comes from Blender's own scripts, read as a whole: the types that flow through a script say what
each attribute belongs to. Each expression is asked as it stands, and with a variable's name that tells nothing.
"""

from __future__ import annotations

import ast
import json
import random
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.base_file import read_meta
from kb_build.flow.analysis import analyse
from kb_build.flow.api import Api
from kb_build.flow.symbols import BaseSymbols
from kb_build.usage.scripts import blender_scripts, read_script
from kb_serve.knowledge_base import KnowledgeBase
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say
from simworlds.releases import version_key

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.flow.analysis import Analysis
    from measurements.setting import Setting

_SEED = 11
_ASKED = 1_000
_ASKED_QUICKLY = 100
_LONGEST = 80  # letters of an expression
_NAMELESS = "thing"
_NOT_VARIABLES = frozenset({"bpy", "context", "cls", "self"})
_HEADER = ("expressions of Blender's own scripts, asked alone", "asked", "right first", "among five")
_NOTE = (
    f"An attribute of a variable, as types that flow through the whole script say what it is. {_ASKED:,} different "
    f"ones, drawn at random with seed {_SEED}. Many names are those of several classes: nothing but the lines around "
    "them tells which."
)


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression, the same with another variable, and the paths of the symbols that it may be."""

    source: str
    nameless: str
    symbols: frozenset[str]


def measure(setting: Setting) -> ReportPart:
    """Reads Blender's own scripts in this process, and asks for the expressions drawn; ``quick`` asks fewer."""
    folder = json.loads(read_meta(setting.base)["runtime"]).get("scripts", "")
    if not folder or not Path(folder).is_dir():
        return ReportPart(
            "expressions", skipped=(f"Blender's scripts are not there ({folder or 'unknown'})",)
        )
    say("expressions: reading Blender's own scripts")
    found = sorted(_expressions(setting.base, Path(folder)), key=lambda each: each.source)
    drawn = random.Random(_SEED).sample(found, min(len(found), _ASKED_QUICKLY if setting.quick else _ASKED))
    say("expressions: asking")
    with KnowledgeBase(setting.base) as knowledge:
        first, five = _shares(knowledge, [(each.source, each.symbols) for each in drawn])
        nameless = _shares(knowledge, [(each.nameless, each.symbols) for each in drawn])
    rows = (
        ("as they stand", f"{len(drawn):,}", f"{first:.3f}", f"{five:.3f}"),
        (
            f"with a variable called {_NAMELESS}",
            f"{len(drawn):,}",
            f"{nameless[0]:.3f}",
            f"{nameless[1]:.3f}",
        ),
    )
    return ReportPart(
        "expressions",
        (
            TargetFigure("expressions1", first, f"{len(drawn):,} of {len(found):,} different ones"),
            TargetFigure("expressions5", five),
            TargetFigure("nameless5", nameless[1], f"first: {nameless[0]:.3f}"),
        ),
        (Table("Expressions by themselves", _HEADER, rows, _NOTE),),
    )


def _expressions(base: Path, folder: Path) -> set[Expression]:
    found: dict[tuple[str, str], set[str]] = {}
    version = version_key(read_meta(base)["blender"])
    with closing(BaseSymbols(base)) as symbols:
        api = Api(symbols)
        for script in blender_scripts(folder):
            for source, nameless, paths in _of_variables(analyse(read_script(script.path), api, version)):
                found.setdefault((source, nameless), set()).update(paths)
    return {Expression(*texts, frozenset(paths)) for texts, paths in found.items()}


def _of_variables(analysis: Analysis) -> Iterator[tuple[str, str, Sequence[str]]]:
    """(expression, the same with another variable, what it is) for the attributes of a script that start at one."""
    for node in ast.walk(analysis.tree) if analysis.tree else ():
        resolution = analysis.resolutions.get(node) if isinstance(node, ast.Attribute) else None
        root = _root(node)
        if resolution is None or not resolution.symbols or root is None or root.id in _NOT_VARIABLES:
            continue
        source, own = ast.unparse(node), root.id
        if len(source) <= _LONGEST and source.startswith(own) and root not in analysis.resolutions:
            yield source, _NAMELESS + source[len(own) :], resolution.symbols


def _root(node: ast.AST) -> ast.Name | None:
    """The variable that an expression begins with."""
    while isinstance(node, ast.Attribute | ast.Subscript | ast.Call):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node if isinstance(node, ast.Name) else None


def _shares(knowledge: KnowledgeBase, asked: Sequence[tuple[str, frozenset[str]]]) -> tuple[float, float]:
    """The shares of which a right symbol comes first, and among five."""
    ids = [([hit.id for hit in knowledge.query(source).hits], symbols) for source, symbols in asked]
    first, five = (sum(not symbols.isdisjoint(hits[:count]) for hits, symbols in ids) for count in (1, 5))
    return first / max(1, len(asked)), five / max(1, len(asked))
