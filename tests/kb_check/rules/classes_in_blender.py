"""Registers classes one by one in this environment's Blender, and finds the same ones with a rule."""

from __future__ import annotations

from textwrap import dedent
from typing import TYPE_CHECKING

from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_START = """\
import bpy
from bpy.types import (
    AddonPreferences, FileHandler, GizmoGroup, Header, Macro, Menu, Node, NodeSocket, NodeTree, Operator, Panel,
    PropertyGroup, RenderEngine, UIList,
)
from bpy.props import IntProperty, StringProperty
"""


def parts_of(text: str) -> list[str]:
    """Classes, one a paragraph. ``X`` becomes a name that no other has, in lower case where it is written so."""
    parts = [part.strip("\n") for part in dedent(text).split("\n\n")]
    return [
        f"{part}\nbpy.utils.register_class(X)\n".replace("X", f"X{place}").replace("_x_", f"_x{place}_")
        for place, part in enumerate(parts)
    ]


def refused_parts(folder: Path, parts: list[str], behind: str = "", watched: str = "") -> set[str]:
    """The parts that Blender refuses: the part itself, what follows it, or where an expression is False then."""
    named = {place: watched.replace("X", f"X{place}") for place in range(len(parts)) if watched}
    statements = [part + behind.replace("_x_", f"_x{place}_") for place, part in enumerate(parts)]
    answers = run_statements(
        folder, [_START, *statements], {place + 1: expression for place, expression in named.items()}
    )
    return {
        part
        for part, (error, _, after) in zip(parts, answers[1:], strict=True)
        if error or (watched and after != "True")
    }


def found_parts(check: Check, rule: str, parts: list[str], severity: str = "error") -> set[str]:
    """The parts in which a rule finds an error, all being one script."""
    lines = [*_START.splitlines(), ""]
    owners: list[str] = [""] * len(lines)
    for part in parts:
        owners += [part] * len(part.splitlines())
    code = "\n".join(lines) + "\n" + "".join(parts)
    return {owners[finding.span.line - 1] for finding in check(rule, code) if finding.severity == severity}
