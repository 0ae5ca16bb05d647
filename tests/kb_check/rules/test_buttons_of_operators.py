"""What buttons and keys call Blender's operators with: the operator's own keywords, of their types."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from statements_in_blender import run_statements

if TYPE_CHECKING:
    from pathlib import Path

    from conftest import Check

    from kb_check.checker import Checker

pytestmark = pytest.mark.blender

_RULES = ["unknown-keyword", "unknown-value", "wrong-type"]
_LAST = "op = bpy.context.window_manager.operator_properties_last({!r})"
_LINES: list[tuple[str, str]] = [
    ("object.delete", "op.use_global = True"),
    ("object.delete", "op.use_gobal = True"),
    ("object.delete", "op.use_global = 'yes'"),
    ("object.delete", "print(op.foo)"),
    ("object.select_all", "op.action = 'SELECT'"),
    ("object.select_all", "op.action = 'ALL'"),
    ("mesh.primitive_cube_add", "op.size = 3"),
    ("mesh.primitive_cube_add", "op.radius = 3"),
    ("mesh.primitive_cube_add", "op.location = (1, 2)"),
    ("mesh.primitive_cube_add", "op.location = (1, 2, 3)"),
    ("MESH_OT_primitive_cube_add", "op.bl_rna.identifier"),
    ("wm.call_menu", "op.name = 'VIEW3D_MT_add'"),
    ("wm.call_menu", "op.menu = 'VIEW3D_MT_add'"),
    ("mesh.duplicate_move", "op.MESH_OT_duplicate.mode = 1"),
    ("mesh.duplicate_move", "op.TRANSFORM_OT_translate.value = (1, 2, 3)"),
    ("mesh.duplicate_move", "op.TRANSFORM_OT_translate.valeu = (1, 2, 3)"),
    ("mesh.duplicate_move", "op.TRANSFORM_OT_translate.orient_type = 'NEAR'"),
    ("mesh.duplicate_move", "op.MESH_OT_duplicated"),
]


def test_what_blender_refuses_is_found_and_nothing_else(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [part for operator, line in _LINES for part in (_LAST.format(operator), line)]
    answers = run_statements(tmp_path, ["import bpy", *lines])
    refused = {number for number, answer in enumerate(answers) if answer[0]}
    found = rule_checker.check("\n".join(["import bpy", *lines]), rules=_RULES)
    assert {finding.span.line - 1 for finding in found} == refused
    assert len(refused) == 10


@pytest.mark.parametrize(
    ("line", "rules"),
    [
        ('self.layout.operator("object.delete").use_gobal = True', ["unknown-keyword"]),
        ('op = self.layout.row().operator("object.delete")\n        op.foo = 1', ["unknown-keyword"]),
        ('self.layout.operator("object.select_all", text="All").action = "ALL"', ["unknown-value"]),
        ('keys.keymap_items.new("wm.call_menu", "A", "PRESS").properties.menu = "X"', ["unknown-keyword"]),
        ('keys.keymap_items.new("wm.call_menu", "A", "PRESS").properties.name = "X"', []),
        ('self.layout.operator(context.scene.name).foo = 1', []),
        ('self.layout.operator("node.add_node").use_transform = True', []),
    ],
)  # fmt: skip
def test_buttons_and_keys_are_read(rule_checker: Checker, line: str, rules: list[str]) -> None:
    code = (
        "import bpy\nclass TEST_PT_one(bpy.types.Panel):\n    def draw(self, context):\n"
        f"        keys = context.window_manager.keyconfigs.addon.keymaps[0]\n        {line}\n"
    )
    assert [finding.rule for finding in rule_checker.check(code, rules=_RULES)] == rules


_MACROS: dict[str, int] = {
    'TRANSFORM_OT_translate={"value": (1, 0, 0), "orient_type": "LOCAL"}': 0,
    'OBJECT_OT_duplicate={"linked": False}, TRANSFORM_OT_translate={"value": (1, 0, 0)}': 0,
    'TRANSFORM_OT_translate={"constraint_orientation": "GLOBAL"}': 1,
    'TRANSFORM_OT_translate={"orient_type": "NEAR"}': 1,
    'OBJECT_OT_duplicate={"linked": False, "lnked": True}': 1,
}


def test_macros_take_what_their_operators_do(rule_checker: Checker, tmp_path: Path) -> None:
    lines: list[str] = [f"bpy.ops.object.duplicate_move({given})" for given in _MACROS]
    answers = run_statements(tmp_path, ["import bpy", *lines])
    assert [bool(answer[0]) for answer in answers] == [False, *map(bool, _MACROS.values())]
    found = rule_checker.check("\n".join(["import bpy", *lines]), rules=_RULES)
    assert [finding.span.line for finding in found] == [4, 5, 6]
    assert found[0].fix
    assert [edit.text for edit in found[0].fix.edits] == ['"orient_type"']


def test_a_misspelling_is_mended(check: Check) -> None:
    (found,) = check(
        "unknown-keyword", "import bpy\n" + _LAST.format("object.delete") + "\nop.use_gobal = True\n"
    )
    assert found.fix
    assert [edit.text for edit in found.fix.edits] == ["use_global"]
