"""What a base is told of other versions' symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.index.analysis import key
from kb_build.records import Symbol
from kb_build.versions.history import History
from kb_build.versions.removed_symbols import former_symbols

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract
    from kb_build.versions.removed_symbols import Former


@pytest.fixture(scope="module")
def former(extract: Extract) -> Former:
    return former_symbols(extract.symbols, History.load(), ".".join(extract.version.split(".")[:2]))


def test_nothing_that_extraction_found_is_called_removed(extract: Extract, former: Former) -> None:
    known = {symbol.path for symbol in extract.symbols}
    assert len(former.removed) > 500
    assert not known & {path for path, _, _ in former.removed}


def test_a_symbol_is_known_until_the_version_before_it_went(former: Former) -> None:
    spans = {path: (first, last) for path, first, last in former.removed}
    assert spans["bpy.types.Action.fcurves"][1] == "4.5"
    assert spans["bpy.types.Scene.node_tree"][1] == "4.5"
    assert spans["bpy.types.Mesh.use_auto_smooth"][1] == "3.4"
    for first, last in spans.values():
        assert tuple(map(int, first.split("."))) <= tuple(map(int, last.split(".")))


def test_a_former_symbol_is_found_with_and_without_prefix(former: Former) -> None:
    names = set(former.names)
    path = "bpy.types.Action.fcurves"
    assert (key(path), path) in names
    assert (key("Action.fcurves"), path) in names
    removed = {row[0] for row in former.removed}
    assert {path for _, path in names} == removed


def test_what_is_offered_instead_exists_here(extract: Extract, former: Former) -> None:
    known = {symbol.path for symbol in extract.symbols}
    assert {target.partition(":")[0] for _, target, _ in former.replacements} <= known
    assert all(score > 0 for _, _, score in former.replacements)


def test_since_names_symbols_that_are_here_and_new(extract: Extract, former: Former) -> None:
    known = {symbol.path for symbol in extract.symbols}
    since = dict(former.since)
    assert set(since) <= known
    assert since["bpy.types.Scene.compositing_node_group"] == "5.0"
    assert "bpy.types.Object.location" not in since


def test_a_symbol_that_came_back_is_not_removed() -> None:
    history = History.load()
    gone = next(path for path, _, _ in history.removed_from("5.1") if path.startswith("bpy.types."))
    here = Symbol(gone, "property", gone.rpartition(".")[0])
    assert gone not in {path for path, _, _ in former_symbols([here], history, "5.1").removed}
