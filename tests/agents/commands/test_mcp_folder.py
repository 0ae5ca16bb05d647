"""The folder that ``simworlds mcp --run`` names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from click.testing import CliRunner

from agents.blender.files.run_folder import RunFolder
from agents.commands.mcp import mcp

if TYPE_CHECKING:
    from pathlib import Path


def test_a_folder_with_files_of_somebody_else_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "addon.py").write_text("mine")
    done = CliRunner().invoke(mcp, ["--run", str(tmp_path)])
    assert done.exit_code == 2
    assert "is not empty, and holds no run. Choose another folder." in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["addon.py"]


def test_a_new_an_empty_and_a_runs_own_folder_are_taken(tmp_path: Path) -> None:
    assert not RunFolder.is_foreign(tmp_path / "new")
    assert not RunFolder.is_foreign(tmp_path)
    RunFolder.make(tmp_path)
    assert not RunFolder.is_foreign(tmp_path)
