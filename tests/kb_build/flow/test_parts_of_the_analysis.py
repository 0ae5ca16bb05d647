"""The parts that are mixed into one analysis share one ``self``: each must keep what is its own to itself."""

from __future__ import annotations

import ast
import inspect
import textwrap
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.analysis import Analyzer
from kb_build.flow.state.core import Core
from kb_build.flow.state.source_files import SourceFile

if TYPE_CHECKING:
    from kb_build.flow.blender.api import Api

PARTS = [part for part in Analyzer.__mro__ if part is not object]


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__")


def tree_of(part: type) -> ast.AST:
    return ast.parse(textwrap.dedent(inspect.getsource(part)))


def owned(part: type) -> set[str]:
    """The names that a part defines: in its body, and on ``self``."""
    stored = {
        node.attr
        for node in ast.walk(tree_of(part))
        if isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store)
    }
    return {*vars(part), *stored}


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.__name__)
def test_a_part_uses_no_private_member_of_another(part: type) -> None:
    used = {node.attr for node in ast.walk(tree_of(part)) if isinstance(node, ast.Attribute)}
    assert {name for name in used if is_private(name)} <= owned(part)


def test_no_part_replaces_what_another_defines() -> None:
    """Of several definitions of one name the first would be called by all; Core only declares what parts define."""
    places: dict[str, list[str]] = {}
    for part in PARTS:
        for name in vars(part):
            if not name.startswith("__") and part is not Core:
                places.setdefault(name, []).append(part.__name__)
    assert {name: parts for name, parts in places.items() if len(parts) > 1} == {}


def test_what_core_declares_is_defined() -> None:
    declared = [
        name
        for name, member in vars(Core).items()
        if inspect.isfunction(member) and "raise NotImplementedError" in inspect.getsource(member)
    ]
    assert declared
    assert [name for name in declared if getattr(Analyzer, name) is getattr(Core, name)] == []


NESTED = """
def held(thing):
    for name in ("a", "b"):
        try:
            kept = {"x": {"y": getattr(thing, name)}}
        except AttributeError:
            kept = [each.z for each in thing]
    return kept
class Holder:
    kinds = {"m": held("mesh"), "n": {"o": held("node").p}}
held(Holder.kinds["m"])
"""


def test_it_comes_back_to_where_it_was_wherever_its_time_is_spent(api: Api) -> None:
    complete: list[bool] = []
    for steps in range(400):
        file = SourceFile("", False, ast.parse(NESTED), steps)
        analyzer = Analyzer(api, (), [file])
        began, before = analyzer.here, replace(analyzer.here)
        analyzer.read()
        assert analyzer.here is began
        assert began == before
        complete.append(file.is_read)
    assert not complete[0]
    assert complete[-1]
