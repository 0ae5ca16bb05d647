"""Whether answers deny what is right: statements of Blender's own scripts, asked as they stand.

Only statements count of which every attribute is known, by the types that flow through the whole script, to be one of
Blender's: whatever is denied of them is denied wrongly, but for what is proven to fail there.
"""

from __future__ import annotations

import ast
import random
import re
from functools import cache
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_serve.knowledge_base import KnowledgeBase
from measurements.blender_scripts import read_all, scripts_folder, why_none
from measurements.check_blender import broken_rows
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from kb_build.flow.analysis import Analysis
    from measurements.setting import Setting

_SEED = 12
_ASKED = {1: 2_000, 3: 1_000}  # so many runs of so many statements
_QUICKLY = 10  # one of so many
_LONGEST = 400  # letters
_DENIES = re.compile(
    r"has no `|takes (?:no|\d+|`)|does not exist|is not a value of|never had|by name only|Nothing is called"
)
_IF = "If `"  # what a denial begins with that holds only if a variable is what its name suggests
_PLAIN = (ast.Assign, ast.AugAssign, ast.Expr, ast.Return)
_HEADER = (
    "statements of Blender's own scripts",
    "asked",
    "denied something",
    "… if a variable is something else",
)
_NOTE = (
    "Statements whose every attribute is one of Blender's, as types that flow through the whole script say. They are "
    f"asked without the lines around them, and drawn at random with seed {_SEED}."
)


def measure(setting: Setting) -> ReportPart:
    """Reads Blender's own scripts in this process, and asks for the statements drawn; ``quick`` asks fewer."""
    if (folder := scripts_folder(setting.base)) is None:
        return ReportPart("denials", skipped=(why_none(setting.base),))
    say("denials: reading Blender's own scripts")
    found: dict[int, set[str]] = {length: set() for length in _ASKED}
    for analysis in read_all(setting.base, folder):
        for length, texts in found.items():
            texts.update(_runs(analysis, length))
    say("denials: asking")
    rows: list[tuple[str, str, str, str]] = []
    figures: list[TargetFigure] = []
    data: dict[str, list[str]] = {}
    with KnowledgeBase(setting.base) as knowledge:
        for length, texts in found.items():
            most = _ASKED[length] // (_QUICKLY if setting.quick else 1)
            drawn = random.Random(_SEED).sample(sorted(texts), min(len(texts), most))
            flat, doubted = _denied(knowledge, drawn)
            rows.append((_name(length), f"{len(drawn):,}", str(len(flat)), str(len(doubted))))
            share = len(flat) / max(1, len(drawn))
            figures.append(TargetFigure(f"denied{length}", share, f"{len(flat)} of {len(drawn):,}"))
            data[_name(length)] = flat
    return ReportPart(
        "denials", tuple(figures), (Table("Right code denied", _HEADER, tuple(rows), _NOTE),), (), data
    )


def _name(length: int) -> str:
    return "one alone" if length == 1 else f"{length} in a row"


def _runs(analysis: Analysis, length: int) -> Iterator[str]:
    """Every so many plain statements in a row that are known to be right."""
    for node in ast.walk(analysis.tree) if analysis.tree else ():
        body = getattr(node, "body", None)
        body = body if isinstance(body, list) else []
        for start in range(len(body) - length + 1):
            run = body[start : start + length]
            if all(isinstance(statement, _PLAIN) and _is_known(statement, analysis) for statement in run):
                text = "\n".join(map(ast.unparse, run))
                if "." in text and len(text) <= _LONGEST:
                    yield text


def _is_known(statement: ast.stmt, analysis: Analysis) -> bool:
    """Whether all attributes of a statement are Blender's."""
    for node in ast.walk(statement):
        if isinstance(node, ast.Attribute):
            resolution = analysis.resolutions.get(node)
            if resolution is None or not resolution.symbols or resolution.missing:
                return False
    return True


@cache
def _proven() -> tuple[tuple[str, str], ...]:
    """(owner, name) of what Blender's own scripts get wrong, as running it proves."""
    parts = (row.symbol.rpartition(".") for row in broken_rows())
    return tuple((f"`{owner}`", f"`{name}`") for owner, _, name in parts)


def _is_proven(note: str) -> bool:
    return any(owner in note and name in note for owner, name in _proven())


def _denied(knowledge: KnowledgeBase, texts: Sequence[str]) -> tuple[list[str], list[str]]:
    """The statements of which something is denied, and those of which it is only if a variable is something else."""
    flat: list[str] = []
    doubted: list[str] = []
    for text in texts:
        notes = [
            note for note in knowledge.query(text).notes if _DENIES.search(note) and not _is_proven(note)
        ]
        if any(not note.startswith(_IF) for note in notes):
            flat.append(text)
        elif notes:
            doubted.append(text)
    return flat, doubted
