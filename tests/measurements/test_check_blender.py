"""Blender judges what is found in its own scripts."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from kb_check.checker import Checker
from measurements.check_blender import (
    ask_blender,
    broken_rows,
    check_all,
    check_inside,
    packages,
    proof_of,
)
from simworlds.installed import installed_bpy

if TYPE_CHECKING:
    from pathlib import Path

BROKEN = """
import bpy
bpy.context.scene.tool_settings.uv_sculpt.brush
if bpy.context.mode == 'WEIGHT_PAINT':
    bpy.context.scene.frame_strat
"""


def test_files_are_grouped_as_they_belong_together(tmp_path: Path) -> None:
    names = ("startup/bl_ui/a.py", "startup/bl_ui/b/c.py", "startup/d.py", "addons_core/x/__init__.py")
    for name in names:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    groups = {frozenset(files) for files in packages(tmp_path)}
    assert groups == {
        frozenset({"bl_ui/a.py", "bl_ui/b/c.py"}),
        frozenset({"d.py"}),
        frozenset({"x/__init__.py"}),
    }


def test_a_finding_is_proven_by_what_blender_says(base: Path, tmp_path: Path) -> None:
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    path = tmp_path / "startup" / "bl_ui" / "space_image.py"
    path.parent.mkdir(parents=True)
    path.write_text(BROKEN, encoding="utf-8")
    with Checker(base) as checker:
        (name, findings, lines), *others = check_all(checker, tmp_path)
    assert (name, lines, others) == ("startup/bl_ui/space_image.py", 5, [])
    proofs = {finding.symbol: proof_of(name, finding, broken_rows()) for finding in findings}
    assert proofs["bpy.types.Scene.frame_strat"] == ("", "")
    wanted = {symbol: proof for symbol, proof in proofs.items() if proof[0]}
    assert set(wanted) == {"bpy.types.UvSculpt.brush", "bpy.types.Context.mode:WEIGHT_PAINT"}
    answers = ask_blender(sys.executable, (code for code, _ in wanted.values()))
    assert answers == dict(wanted.values())


def test_a_name_that_nothing_binds_is_proven_by_its_module(base: Path, tmp_path: Path) -> None:
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    path = tmp_path / "modules" / "bpy_extras" / "anim_utils.py"
    path.parent.mkdir(parents=True)
    path.write_text("import bpy\nprint(nobody_binds_me)\n", encoding="utf-8")
    with Checker(base) as checker:
        ((name, (finding,), _),) = check_all(checker, tmp_path)
    code, says = proof_of(name, finding, broken_rows())
    bound = code.replace("nobody_binds_me", "bake_action")
    assert ask_blender(sys.executable, [code, bound]) == {code: says, bound: ""}


def test_a_blender_that_cannot_be_run_says_nothing(tmp_path: Path) -> None:
    assert ask_blender(str(tmp_path / "python"), ["1"]) == {}


def test_own_scripts_that_run_inside_blender_have_no_error(base: Path, tmp_path: Path) -> None:
    path = tmp_path / "agents" / "x" / "inside" / "a.py"
    path.parent.mkdir(parents=True)
    path.write_text("import bpy\nbpy.context.scene.frame_strat\n", encoding="utf-8")
    with Checker(base) as checker:
        wrong, count = check_inside(checker)
        planted, _ = check_inside(checker, tmp_path)
    assert wrong == []
    assert count > 50
    assert [text.partition(": ")[0] for text in planted] == ["agents/x/inside/a.py:2"]


def test_a_call_in_an_operator_is_proven_by_running_one() -> None:
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    rows = [row for row in broken_rows() if row.symbol.endswith("report(message)")]
    assert (
        ask_blender(sys.executable, (row.code for row in rows)) == {row.code: row.says for row in rows} != {}
    )
