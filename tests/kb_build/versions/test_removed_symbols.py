"""What a base is told of other versions' symbols."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_build.flow.blender.facts import LOST_MODULES
from kb_build.index.analysis import key
from kb_build.symbols.records import Symbol
from kb_build.versions.history import ApiHistory, paths_of
from kb_build.versions.removed_symbols import find_removed_symbols

if TYPE_CHECKING:
    from kb_build.blender.extract_reader import Extract
    from kb_build.versions.removed_symbols import RemovedSymbols


@pytest.fixture(scope="module")
def removed_symbols(extract: Extract) -> RemovedSymbols:
    return find_removed_symbols(extract.symbols, ApiHistory.load(), ".".join(extract.version.split(".")[:2]))


def test_no_extracted_symbol_is_called_removed(extract: Extract, removed_symbols: RemovedSymbols) -> None:
    known = {path for symbol in extract.symbols for path in paths_of(symbol)}
    assert {"bpy.context.mode:POSE", "bpy.props.FloatProperty(subtype):ANGLE"} <= known
    assert len(removed_symbols.removed) > 500
    assert not known & {path for path, *_ in removed_symbols.removed}


def test_spans_end_with_the_last_version_that_had_the_symbol(removed_symbols: RemovedSymbols) -> None:
    spans = {path: (first, last) for path, first, last, *_ in removed_symbols.removed}
    assert spans["bpy.types.Action.fcurves"][1] == "4.5"
    assert spans["bpy.types.Scene.node_tree"][1] == "4.5"
    assert spans["bpy.types.Mesh.use_auto_smooth"][1] == "4.0"
    for first, last in spans.values():
        # What only the table of successors knows has no first version.
        assert not first or tuple(map(int, first.split("."))) <= tuple(map(int, last.split(".")))


def test_a_removed_symbol_is_found_with_and_without_prefix(removed_symbols: RemovedSymbols) -> None:
    names = set(removed_symbols.names)
    path = "bpy.types.Action.fcurves"
    assert (key(path), path) in names
    assert (key("Action.fcurves"), path) in names
    removed = {row[0] for row in removed_symbols.removed}
    assert {path for _, path in names} == removed - LOST_MODULES.keys()
    assert removed >= LOST_MODULES.keys()


def test_an_item_alone_means_that_of_an_enumeration_and_not_of_calls(removed_symbols: RemovedSymbols) -> None:
    names = set(removed_symbols.names)
    argument = "bpy.types.ObjectGpencilModifiers.new(type):GP_NOISE"
    assert {path for spelled, path in names if spelled == key("GP_NOISE")} == {
        "bpy.types.GpencilModifier.type:GP_NOISE"
    }
    assert (key(argument), argument) in names


def test_replacements_exist_in_this_version(extract: Extract, removed_symbols: RemovedSymbols) -> None:
    known = {symbol.path for symbol in extract.symbols}
    assert {target.partition(":")[0] for _, target, _ in removed_symbols.similar_names} <= known
    assert all(score > 0 for _, _, score in removed_symbols.similar_names)


def test_since_names_new_symbols_of_this_version(extract: Extract, removed_symbols: RemovedSymbols) -> None:
    known = {symbol.path for symbol in extract.symbols}
    since = {path: (version, lacked) for path, version, lacked in removed_symbols.since}
    assert set(since) <= known
    assert since["bpy.types.Scene.compositing_node_group"] == ("5.0", "")
    assert since["bpy.types.GreasePencilArrayModifier"] == ("4.2", "3.4")
    assert since["bpy.ops.wm.obj_export"] == ("3.1", "")
    assert "bpy.types.Object.location" not in since


@pytest.mark.parametrize(
    "path",
    [
        pytest.param("bpy.types.Light.use_shadow", id="on each kind of light before"),
        pytest.param("bpy.types.AttributeGroupMesh.new", id="of a class that was called otherwise"),
        pytest.param("bpy.ops.wm.alembic_export", id="left out of the package that was asked"),
    ],
)
def test_since_says_nothing_of_new_names_for_old_things(removed_symbols: RemovedSymbols, path: str) -> None:
    assert path not in {row[0] for row in removed_symbols.since}


def test_a_symbol_that_came_back_is_not_removed() -> None:
    history = ApiHistory.load()
    gone = next(span.path for span in history.removed_from("5.1") if span.path.startswith("bpy.types."))
    here = Symbol(gone, "property", gone.rpartition(".")[0])
    assert gone not in {path for path, *_ in find_removed_symbols([here], history, "5.1").removed}
