"""Names of operators are reported that Blender refuses, and no others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from classes_in_blender import found_parts, parts_of, refused_parts

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

_NAMES = (
    "object.grow", "MyOperator", "Object.Do_It", "object.do.it", "object.do-it", "object.do it", ".do", "do.",
    "1ob.1do", "OBJECT_OT_do", "object_ot_do", "object.doé", "", "a." + "b" * 58, "a." + "b" * 59, "class.import",
)  # fmt: skip


def test_what_is_refused_is_reported_and_nothing_else(check: Check, tmp_path: Path) -> None:
    for base in ("Operator", "Macro"):
        parts = parts_of(
            "\n\n".join(
                f"class X({base}):\n    bl_label = 'label'\n    bl_idname = {name!r}" for name in _NAMES
            )
        )
        refused = refused_parts(tmp_path, parts)
        assert found_parts(check, "operator-idname", parts) == refused
        assert len(refused) == len(_NAMES) - 4


def test_a_name_that_is_taken_is_proposed(check: Check) -> None:
    (found,) = check(
        "operator-idname",
        'import bpy\nclass Grow(bpy.types.Operator):\n    bl_label = ""\n    bl_idname = "OBJECT_OT_growAll"\n',
    )
    assert "'object.grow_all'" in found.message


def test_an_empty_name_of_a_class_to_derive_from_is_left_alone(check: Check) -> None:
    assert not check("operator-idname", 'import bpy\nclass Base(bpy.types.Operator):\n    bl_idname = ""\n')
