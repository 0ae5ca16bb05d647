"""Short ways to ask what an analysis found."""

from __future__ import annotations

import ast
from textwrap import dedent
from typing import TYPE_CHECKING

from kb_build.flow.analysis import analyse
from kb_build.flow.values.types import Instance, members

if TYPE_CHECKING:
    from kb_build.flow.analysis import Analysis
    from kb_build.flow.blender.api import Api
    from kb_build.flow.values.types import Resolution

TYPES = "bpy.types."


def read(api: Api, code: str, version: tuple[int, ...] = (5, 1, 0)) -> Analysis:
    """The analysis of a script that can be parsed and is read to its end."""
    analysis = analyse(dedent(code), api, version)
    assert analysis.error is None
    assert analysis.complete
    return analysis


def last_type(api: Api, code: str) -> set[str]:
    """The classes of the expression that a script ends with, without their module where it is bpy.types."""
    analysis = read(api, code)
    assert analysis.tree is not None
    last = analysis.tree.body[-1]
    assert isinstance(last, ast.Expr)
    return {
        member.cls.removeprefix(TYPES) if isinstance(member, Instance) else type(member).__name__
        for member in members(analysis.types[last.value])
    }


def resolved(api: Api, code: str, kind: str = "") -> dict[str, Resolution]:
    """Name as written → what it was last found to be; of one kind, or of all."""
    found = read(api, code).resolutions.values()
    return {row.value: row for row in found if not kind or row.kind == kind}


def symbol(api: Api, code: str, name: str) -> str:
    """The one symbol that a name in a script stands for."""
    row = resolved(api, code)[name]
    assert len(row.symbols) == 1, row
    assert not row.missing, row
    return row.symbols[0].removeprefix(TYPES)


def unknown(api: Api, code: str) -> set[tuple[str, str]]:
    """(owner, name) of everything that is certainly not there, nor expected to be."""
    return {
        (row.missing[0].removeprefix(TYPES), row.value)
        for row in read(api, code).resolutions.values()
        if row.missing and not row.symbols and row.sure and not row.guarded
    }
