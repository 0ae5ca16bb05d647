"""Measures how much of Blender's own scripts is understood, and how many symbols have an example."""

from __future__ import annotations

import ast
import time
from collections import Counter
from contextlib import closing
from typing import TYPE_CHECKING

from bench.markdown_tables import Table
from kb_build.flow.values.types import UNKNOWN
from kb_build.schema import open_read_only
from kb_build.usage.scripts import blender_scripts, read_script
from measurements.blender_scripts import reading, scripts_folder, why_none
from measurements.report import ReportPart, TargetFigure
from measurements.setting import say

if TYPE_CHECKING:
    from pathlib import Path

    from kb_build.flow.analysis import Analysis
    from measurements.setting import Setting

_MOST_USED = 1000
_HEADER = ("attributes in Blender's own scripts", "number", "share")
_EXAMPLES_HEADER = ("symbols", "number", "with an example")
_RESOLVED, _POSSIBLE, _MISSING, _PYTHON, _UNKNOWN = (
    "resolved to a symbol",
    "of a class derived from the known one",
    "not in the API (add-ons register their own)",
    "of Python, or of the script's own classes",
    "of something unknown, mostly Python's",
)


def measure(setting: Setting) -> ReportPart:
    """Reads every script that the base's Blender brings, in this process; ``quick`` reads the templates alone."""
    say("usage: reading Blender's own scripts")
    figures, tables = _examples(setting.base)
    if (folder := scripts_folder(setting.base)) is None:
        return ReportPart("usage", figures, tables, (why_none(setting.base),))
    counts: Counter[str] = Counter()
    lines, took = 0, 0.0
    with reading(setting.base) as read:
        read("import bpy\nbpy.context.object.modifiers.new('x', 'CLOTH').settings")
        for script in blender_scripts(folder):
            if setting.quick and not script.name.startswith("templates_py"):
                continue
            code = read_script(script.path)
            began = time.process_time()
            analysis = read(code)
            took += time.process_time() - began
            lines += code.count("\n")
            counts += _attributes(analysis)
    total = counts.total()
    figures += (TargetFigure("flow_speed", 1e6 * took / max(1, lines), f"{lines:,} lines, first reading"),)
    rows = tuple(
        (what, f"{counts[what]:,}", f"{counts[what] / max(1, total):.3f}")
        for what in (_RESOLVED, _POSSIBLE, _MISSING, _PYTHON, _UNKNOWN)
    )
    return ReportPart(
        "usage", figures, (*tables, Table("What attributes are", _HEADER, rows)), (), dict(counts)
    )


def _examples(base: Path) -> tuple[tuple[TargetFigure, ...], tuple[Table, ...]]:
    with closing(open_read_only(base)) as connection:
        found: list[tuple[int]] = connection.execute(
            "SELECT EXISTS (SELECT 1 FROM uses WHERE uses.path = use_counts.path) FROM use_counts "
            "ORDER BY uses DESC, path"
        ).fetchall()
        symbols: int = connection.execute("SELECT count(*) FROM symbols").fetchone()[0]
    shown = [bool(row[0]) for row in found]
    most = shown[:_MOST_USED]
    share = sum(most) / max(1, len(most))
    rows = (
        (f"the {_MOST_USED:,} most used ones", f"{len(most):,}", f"{share:.3f}"),
        (
            "used by Blender's own scripts or the guides",
            f"{len(shown):,}",
            f"{sum(shown) / max(1, len(shown)):.3f}",
        ),
        ("all", f"{symbols:,}", f"{sum(shown) / max(1, symbols):.3f}"),
    )
    return (TargetFigure("used_symbols", share),), (Table("Examples", _EXAMPLES_HEADER, rows),)


def _attributes(analysis: Analysis) -> Counter[str]:
    """How many attributes of a script are what."""
    counts: Counter[str] = Counter()
    if analysis.tree is None:
        return counts
    for node in ast.walk(analysis.tree):
        if not isinstance(node, ast.Attribute):
            continue
        found = analysis.resolutions.get(node)
        if found is not None:
            counts[_RESOLVED if found.symbols else _POSSIBLE if found.possible else _MISSING] += 1
        else:
            is_unknown = analysis.types.get(node.value, UNKNOWN) is UNKNOWN
            counts[_UNKNOWN if is_unknown else _PYTHON] += 1
    return counts
