"""What is said of a removed symbol: when it went, and what takes its place, as far as that is known."""

from __future__ import annotations

from contextlib import closing

import pytest
from other_versions import base_of

from kb_build.symbols.paths import as_code
from kb_serve.lookups.records import Successor
from kb_serve.reader import BaseReader
from kb_serve.recognise.notes import Notes
from kb_serve.recognise.removed.removed_symbols import RemovedSymbol, RemovedSymbolLookup

USE = Successor("bpy.types.A.b", "", "2.80", "")
HOW = Successor("bpy.types.A.b", "Call it with True.", "4.0", "")
LISTED = Successor("bpy.types.A.b", "", "4.2", "listing of the API, 4.2")
NONE = Successor("", "It is always on.", "2.80", "")


@pytest.mark.parametrize(
    ("symbol", "said"),
    [
        (
            RemovedSymbol("x", "2.79", "2.79", "2.80", (USE,)),
            "removed in 2.80 (last in 2.79). Use `bpy.types.A.b`.",
        ),
        (
            RemovedSymbol("x", "2.79", "3.6", "4.0", (HOW,)),
            "removed in 4.0 (last in 3.6). Use `bpy.types.A.b`. Call it with True.",
        ),
        (
            RemovedSymbol("x", "3.4", "3.4", "4.0", (HOW,)),
            "removed in 4.0. Use",
        ),  # it may have been in 3.6 too
        (RemovedSymbol("x", "3.4", "3.4", "4.2", (USE,)), "gone by 4.2 (last seen in 3.4). Use"),
        (RemovedSymbol("x", "3.4", "3.4", "4.2", (LISTED,)), "gone by 4.2 (last seen in 3.4). Use"),
        (
            RemovedSymbol("x", "2.79", "2.79", "2.80", (NONE,)),
            "removed in 2.80 (last in 2.79). Nothing takes its place. It is always on.",
        ),
        (
            RemovedSymbol("x", "2.79", "2.79", "2.80", (), (("bpy.types.A.c", 1.0), ("bpy.types.A.d", 0.3))),
            "(last in 2.79). Similar names: `bpy.types.A.c`.",
        ),
        (RemovedSymbol("x", "5.2", "5.2", ""), "new in 5.2."),
    ],
)
def test_a_removed_symbol_is_dated_and_replaced(reader: BaseReader, symbol: RemovedSymbol, said: str) -> None:
    note = Notes(reader).removed(symbol)
    assert note.startswith("`x` does not exist in Blender ")
    assert said in note
    assert ".." not in note


@pytest.mark.blender
@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("bpy.ops.sequencer.select_handle", "does not exist in Blender 3.4: new in 4.2 or a little before."),
        (
            'bpy.types.ShaderNodeBsdfPrincipled.inputs["Coat Weight"]',
            "does not exist in Blender 3.4: new in 4.0.",
        ),
        ("bpy.types.NodeTree.interface", "does not exist in Blender 3.4: new in 4.0."),
    ],
)
def test_what_is_newer_is_dated_as_far_as_it_is_known(path: str, said: str) -> None:
    with closing(BaseReader(base_of("3.4"))) as older:
        removed = RemovedSymbolLookup(older).of_path(path)
        assert removed is not None
        assert said in Notes(older).removed(removed)


@pytest.mark.blender
def test_what_a_build_was_made_without_is_not_called_new() -> None:
    with closing(BaseReader(base_of("3.4"))) as older:
        removed = RemovedSymbolLookup(older).of_path("bpy.ops.wm.alembic_import")
        if removed is None:
            pytest.skip("this Blender 3.4 is made with Alembic")
        note = Notes(older).removed(removed)
    assert "`bpy.app.build_options.alembic` is True" in note
    assert "new in" not in note


@pytest.mark.parametrize(
    ("owner", "name", "said"),
    [
        ("Object", "no_such_thing", ", and never had it from 2.79 to "),
        ("UvSculpt", "input_samples", ""),  # once inherited: Paint had it
    ],
)
def test_what_a_class_may_have_inherited_once_is_not_said_never_to_have_been(
    reader: BaseReader, owner: str, name: str, said: str
) -> None:
    told = Notes(reader).never(f"bpy.types.{owner}", name)
    assert told.startswith(said) if said else told == ""


@pytest.mark.parametrize(
    ("path", "written"),
    [
        (
            "bpy.types.RenderSettings.engine:BLENDER_EEVEE_NEXT",
            "bpy.types.RenderSettings.engine = 'BLENDER_EEVEE_NEXT'",
        ),
        ("bpy.types.ObjectModifiers.new(type):SMOKE", "bpy.types.ObjectModifiers.new(type='SMOKE')"),
        ("bpy.ops.mesh.primitive_cube_add(radius)", "bpy.ops.mesh.primitive_cube_add(radius=…)"),
        ('bpy.types.ShaderNodeMix.inputs["A:B"]', 'bpy.types.ShaderNodeMix.inputs["A:B"]'),
        ("bpy.types.Object.select", "bpy.types.Object.select"),
    ],
)
def test_paths_of_values_and_arguments_are_written_as_in_scripts(path: str, written: str) -> None:
    assert as_code(path) == written
