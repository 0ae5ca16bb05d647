"""Blender judges what is found in packages of others."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from measurements.check_blender import Broken
from measurements.check_packages import check, listed, right_and_false
from simworlds.installed import installed_bpy

if TYPE_CHECKING:
    from pathlib import Path

CODE = "import bpy\nbpy.context.scene.frame_strat\nbpy.context.scene.frame_edn\n"


def test_every_fault_is_of_a_listed_package() -> None:
    packages, broken = listed()
    roots = {row.name for row in packages}
    assert {script.partition("/")[0] for row in broken for script in row.scripts} <= roots
    assert len({(row.symbol, script) for row in broken for script in row.scripts}) == sum(
        len(row.scripts) for row in broken
    )


def test_an_error_is_right_only_if_blender_says_what_its_row_says(base: Path, tmp_path: Path) -> None:
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    (tmp_path / "films").mkdir()
    (tmp_path / "films" / "reel.py").write_text(CODE, encoding="utf-8")
    told = check(tmp_path, "5.1", base.parent.parent)
    assert [(one["path"], one["line"]) for one in told["findings"]] == [
        ("films/reel.py", 2),
        ("films/reel.py", 3),
    ]
    lacks = "AttributeError: 'Scene' object has no attribute 'frame_strat'"
    row = Broken(
        ("films/reel.py",), "bpy.types.Scene.frame_strat", "bpy.context.scene.frame_strat", lacks, ""
    )
    right, false = right_and_false(told["findings"], [row], sys.executable)
    assert (right, len(false)) == (1, 1)
    assert "frame_edn" in false[0]
    other = Broken(row.scripts, row.symbol, "bpy.context.scene.frame_start", lacks, "")
    assert right_and_false(told["findings"], [other], sys.executable)[0] == 0
