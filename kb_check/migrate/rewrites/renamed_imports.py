"""Classes and functions that are imported by a former name: ``from bpy.types import MetaStrip as MetaSequence``."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_check.migrate.rewrite import Rewrite

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.migrate.change import Change
    from kb_check.migrate.place import Place


def _propose(place: Place) -> Iterator[Change]:
    for row, match in place.gone_like(r"[\w.]+"):
        alias, statement = row.node, place.parent(row.node)
        if not isinstance(alias, ast.alias) or not isinstance(statement, ast.ImportFrom):
            continue
        successors = place.script.names.reader.history.successors(match[0])
        if len(successors) != 1 or successors[0].how:
            continue
        module, _, name = successors[0].target.rpartition(".")
        if module == statement.module and name.isidentifier():
            # What uses the name goes on with it.
            text = f"{name} as {alias.asname or alias.name}"
            yield place.change(REWRITE.id, match[0], [place.write(alias, text)])


REWRITE = Rewrite("renamed-import", _propose)
