"""Runs statements one by one in this environment's Blender: the truth that rules are held against."""

from __future__ import annotations

from typing import TYPE_CHECKING

from told_by_blender import told_by_blender

if TYPE_CHECKING:
    from pathlib import Path

_RUN = """
import json, sys
import bpy
lines, watched = json.load(open(sys.argv[-1]))
names, answers = {}, []
def seen(place):
    try:
        return repr(eval(watched[place], names)) if place in watched else ""
    except Exception as error:
        return type(error).__name__
for place, line in enumerate(lines):
    before, failed = seen(str(place)), ""
    try:
        exec(line, names)
    except Exception as error:
        failed = f"{type(error).__name__}: {error}"
    answers.append([failed, before, seen(str(place))])
open(sys.argv[-1], "w").write(json.dumps(answers))
"""


def run_statements(folder: Path, lines: list[str], watched: dict[int, str] | None = None) -> list[list[str]]:
    """What became of each statement: its error or nothing, and an expression's value before and after it.

    ``watched`` has the expressions, by the place of their statement.
    """
    return told_by_blender(_RUN, folder, [lines, watched or {}], seconds=240)
