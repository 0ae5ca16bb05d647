"""What a base says of new things is what Blender gives, by calls that are not the extractor's."""

from __future__ import annotations

import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.live.values import compare_values, same_value, told_empty, told_value
from kb_build.schema import pack, unpack
from kb_build.symbols.flag_names import EMPTY, FILLED_AT_START
from kb_build.symbols.records import NewValue, Symbol
from simworlds.sandbox.runtime import find_runtime

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built

SUN = Symbol(
    "bpy.types.SunLight.energy",
    "property",
    default=10,
    new_values=(NewValue(10), NewValue(1, ("sun by operator",)), NewValue(5, ("sun light",), "mode='A'")),
)


@pytest.mark.parametrize(
    ("label", "value"), [("sun light", 10), ("sun by operator", 1), ("mode='A'", 5), ("other", 10)]
)
def test_a_thing_is_told_by_its_name_its_mode_or_as_usual(label: str, value: int) -> None:
    assert told_value(SUN, label) == value


def test_without_new_values_rnas_default_is_told() -> None:
    assert told_value(Symbol("a", "property", default=3), "x") == 3


def test_a_pointer_is_told_none_usually_or_by_name() -> None:
    usual = Symbol("a", "property", type="pointer", flags=("filled-on:b",), new_values=(NewValue(None),))
    named = Symbol("a", "property", type="pointer", new_values=(NewValue(None, ("b",)),))
    assert [told_empty(usual, label) for label in ("a", "b")] == [True, False]
    assert [told_empty(named, label) for label in ("a", "b")] == [False, True]
    assert not told_empty(Symbol("a", "property", type="pointer", flags=("compared",)), "a")


@pytest.mark.parametrize(
    ("told", "value", "equal"),
    [
        (0.1, 0.10000000149011612, True),
        ([0, 0.2], [0.0, 0.20000000298], True),
        (0.1, 0.1001, False),
        ([0, 1], [0, 1, 2], False),
        (True, True, True),
        ("A", "B", False),
        (["A"], ["A"], True),
    ],
)
def test_floats_are_equal_as_far_as_single_precision_goes(told: object, value: object, equal: bool) -> None:
    assert same_value(told, value) is equal  # type: ignore[arg-type]


@pytest.mark.blender
def test_every_default_holds_in_the_live_blender(built: Built) -> None:
    found = compare_values(built.path, find_runtime(None, home=built.home))
    assert found.wrong == ()
    assert found.compared > 8_000
    assert found.differing > 2_500


@pytest.mark.blender
def test_what_is_wrong_is_found(built: Built, tmp_path: Path) -> None:
    base = built.copy(tmp_path / "copy").path
    damping = "bpy.types.ClothCollisionSettings.damping"
    body, field, keys = (
        f"bpy.types.{name}" for name in ("Object.rigid_body", "Object.field", "Mesh.shape_keys")
    )
    with closing(sqlite3.connect(base)) as connection, connection:

        def change(path: str, name: str, old: object, new: object) -> None:
            found = connection.execute("SELECT record FROM symbols WHERE path = ?", (path,)).fetchone()
            row = unpack(found[0])
            assert row[name] == old
            row[name] = new
            connection.execute("UPDATE symbols SET record = ? WHERE path = ?", (pack(row), path))

        change(damping, "new_values", [{"value": 0, "made": ["cloth modifier"], "when": "", "by": ""}], [])
        change(body, "new_values", [{"value": None, "made": [], "when": "", "by": ""}], [])
        flags = ["readonly", "compared", "filled-by:"]
        made = flags[2] + "bpy.ops.object.forcefield_toggle()"
        known = [flags[0], FILLED_AT_START, flags[1]]
        change(field, "flags", [*known, made], [*known, flags[2] + "bpy.ops.rigidbody.object_add()"])
        layers = "bpy.types.Scene.view_layers"
        change(layers, "flags", ["readonly"], ["readonly", EMPTY])
        change(keys, "flags", [*flags[:2], flags[2] + "obj.shape_key_add()"], flags[:2])
    found = compare_values(base, find_runtime(None, home=tmp_path))
    assert found.wrong == (
        "Object.field is still None after bpy.ops.rigidbody.object_add(), which is told to make it",
        "ClothCollisionSettings.damping of a new cloth modifier: 0.0, told 1",
        "Object.rigid_body of a new mesh object: None, told not None",
        "Scene.view_layers of a new scene: has elements, told empty",
    )
