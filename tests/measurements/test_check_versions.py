"""The drift between two Blenders, which is none between a Blender and itself."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kb_check.checker import Checker
from measurements.check_versions import drift, measure
from measurements.setting import Setting

if TYPE_CHECKING:
    from pathlib import Path


def test_a_blender_lacks_nothing_of_its_own(base: Path, tmp_path: Path) -> None:
    folder = tmp_path / "startup"
    folder.mkdir()
    (folder / "script.py").write_text("import bpy\nbpy.context.object.display_type = 'WIRE'\n")
    with Checker(base) as checker:
        found = drift(checker, checker, tmp_path)
    assert not found.places
    assert not found.names


def test_without_an_older_base_it_is_skipped_with_the_reason(base: Path) -> None:
    part = measure(Setting(base, base.parent.parent, ()))
    assert part.skipped == ("there is no base of Blender 4.2 beside the measured one",)
