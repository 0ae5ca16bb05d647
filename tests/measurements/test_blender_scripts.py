"""The scripts of a base's Blender are found, and read as a whole."""

from __future__ import annotations

import json
import shutil
import sqlite3
from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from measurements.blender_scripts import read_all, reading, scripts_folder, why_none

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def moved(base: Path, tmp_path: Path) -> Path:
    """A base whose Blender is no longer where it was."""
    copy = tmp_path / base.name
    shutil.copy(base, copy)
    with closing(sqlite3.connect(copy)) as file, file:
        runtime = json.dumps({"scripts": str(tmp_path / "gone")})
        file.execute("UPDATE meta SET value = ? WHERE name = 'runtime'", (runtime,))
    return copy


def test_the_scripts_of_the_base_s_blender_are_found(base: Path) -> None:
    folder = scripts_folder(base)
    assert folder is not None
    assert (folder / "templates_py").is_dir()


def test_what_is_not_there_is_told(moved: Path, tmp_path: Path) -> None:
    assert scripts_folder(moved) is None
    assert str(tmp_path / "gone") in why_none(moved)


def test_types_flow_through_each_script(base: Path, tmp_path: Path) -> None:
    (tmp_path / "templates_py").mkdir()
    (tmp_path / "templates_py" / "one.py").write_text(
        "import bpy\nscene = bpy.context.scene\nscene.frame_start\n"
    )
    (analysis,) = read_all(base, tmp_path)
    assert "bpy.types.Scene.frame_start" in {
        path for found in analysis.resolutions.values() for path in found.symbols
    }


def test_branches_for_other_blenders_are_left_out(base: Path) -> None:
    with reading(base) as read:
        analysis = read("import bpy\nif bpy.app.version < (2, 80):\n    bpy.context.scene.update()\n")
    assert not any(found.missing for found in analysis.resolutions.values())
