"""Previews are numbered, and none is written over."""

from __future__ import annotations

from typing import TYPE_CHECKING

from agents.blender.files.run_folder import RunFolder
from agents.blender.tools.preview_files import FOLDER, new_preview

if TYPE_CHECKING:
    from pathlib import Path


def test_numbers_go_on_past_four_digits(tmp_path: Path) -> None:
    folder = RunFolder.make(tmp_path / "run")
    assert new_preview(folder, "view", b"first").path.name == "0001-view.png"
    (folder.root / FOLDER / "9999-view.png").touch()
    (folder.root / FOLDER / "12-by-hand.txt").touch()
    names = [new_preview(folder, "view", b"later").path.name for _ in range(2)]
    assert names == ["10000-view.png", "10001-view.png"]
