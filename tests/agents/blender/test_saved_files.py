"""A .blend goes to its place with its caches, and leaves no others beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from agents.blender.files.saved_files import caches_folder, move_saved, put_in_place
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from pathlib import Path


def a_blend(path: Path, text: str, *, caches: bool) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    if caches:
        caches_folder(path).mkdir()
        (caches_folder(path) / "a.bphys").write_text(text)
    return path


def state(path: Path) -> tuple[str, str]:
    """What a .blend holds, and the cache beside it; "" for none."""
    cache = caches_folder(path) / "a.bphys"
    return path.read_text(), cache.read_text() if cache.exists() else ""


@pytest.mark.parametrize("before", [True, False])
@pytest.mark.parametrize("caches", [True, False])
def test_what_was_saved_takes_the_place_of_what_was_there(tmp_path: Path, before: bool, caches: bool) -> None:
    for put in (put_in_place, move_saved):
        place = tmp_path / put.__name__
        target = a_blend(place / "scene.blend", "old", caches=before)
        put(a_blend(place / "staged" / "scene.blend", "new", caches=caches), target)
        assert state(target) == ("new", "new" if caches else "")


def test_a_move_that_was_cut_off_is_finished(tmp_path: Path) -> None:
    target = a_blend(tmp_path / "scene.blend", "old", caches=True)
    made = a_blend(tmp_path / "made" / "scene.blend", "new", caches=True)
    target.unlink()
    target.mkdir()
    with pytest.raises(IsADirectoryError):
        move_saved(made, target)
    target.rmdir()
    move_saved(made, target)
    assert state(target) == ("new", "new")


@pytest.mark.parametrize("before", [True, False])
def test_a_file_that_cannot_be_put_in_place_leaves_no_caches_there(tmp_path: Path, before: bool) -> None:
    target = tmp_path / "scene.blend"
    target.mkdir()
    if before:
        caches_folder(target).mkdir()
        (caches_folder(target) / "a.bphys").write_text("old")
    staged = a_blend(tmp_path / "staged" / "scene.blend", "new", caches=True)
    with pytest.raises(Refusal, match="cannot be written"):
        put_in_place(staged, target)
    cache = caches_folder(target) / "a.bphys"
    assert (cache.read_text() if cache.exists() else "") == ("old" if before else "")
