"""How the history file is made and what protects an old one; with this environment's Blender."""

from __future__ import annotations

import shutil
from typing import TYPE_CHECKING

import pytest
from whole import IS_WHOLE

from kb_build.errors import KBBuildError, StoreError
from kb_build.versions.history import ApiHistory
from kb_build.versions.history_builder import build_history
from kb_build.versions.history_merge import merge_versions
from simworlds.installed import installed_bpy
from simworlds.releases import minor_of

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def version() -> str:
    found = installed_bpy()
    if found is None:
        pytest.skip("there is no Blender in this environment")
    return found


@pytest.fixture(scope="module")
def home(small_base: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """With what Blender said of a few symbols, which is read where it would be asked."""
    folder = tmp_path_factory.mktemp("history-home")
    shutil.copytree(small_base.parent.parent / "extracts", folder / "extracts")
    return folder


def test_one_blenders_symbols_are_written(version: str, built_once: Built, tmp_path: Path) -> None:
    home = tmp_path / "home"
    # Blender is asked where all is tried: that takes most of this, and building the base shows it, too.
    if not IS_WHOLE:
        shutil.copytree(built_once.home / "extracts", home / "extracts")
    report = build_history([version], home=home, output=tmp_path / "api.csv.gz")
    history = ApiHistory.load(tmp_path / "api.csv.gz")
    assert (report.written, report.extracted, report.missing) == (True, (version,), {})
    assert history.patches == (version,)
    assert history.exists("bpy.ops.object.modifier_add(type):NODES", version)
    assert report.size == (tmp_path / "api.csv.gz").stat().st_size
    again = build_history([version], home=home, output=tmp_path / "api.csv.gz")
    assert not again.written


def test_unavailable_versions_are_named_and_kept_from_the_old_file(
    version: str, home: Path, tmp_path: Path
) -> None:
    output = tmp_path / "api.csv.gz"
    output.write_bytes(merge_versions({"3.4.1": {"bpy", "bpy.old"}}).to_bytes())
    absent = tmp_path / "no-blender-here"
    report = build_history([version], home=home, output=output, blender_exes=[absent])
    assert report.kept == ("3.4.1",)
    assert "no Blender executable" in report.missing[str(absent)]
    assert ApiHistory.load(output).span("bpy.old") == ("3.4", "3.4")


def test_a_poorer_extract_does_not_replace_the_file(version: str, home: Path, tmp_path: Path) -> None:
    output = tmp_path / "api.csv.gz"
    richer = {f"bpy.types.Lost.p{n}" for n in range(100_000)}
    output.write_bytes(merge_versions({version: richer}).to_bytes())
    before = output.read_bytes()
    with pytest.raises(StoreError, match=r"lost: bpy\.types\.Lost\.p0"):
        build_history([version], home=home, output=output)
    assert output.read_bytes() == before
    assert build_history([version], home=home, output=output, force=True).written
    assert not ApiHistory.load(output).exists("bpy.types.Lost.p0", minor_of(version))


def test_with_no_blender_at_all_the_file_stays_and_the_reasons_are_given(home: Path, tmp_path: Path) -> None:
    output = tmp_path / "api.csv.gz"
    output.write_text("whatever", encoding="utf-8")
    with pytest.raises(KBBuildError, match="no Blender was available"):
        build_history(["2.79"], home=home, output=output, force=True)
    assert output.read_text(encoding="utf-8") == "whatever"


def test_a_folder_that_cannot_be_written_is_a_clear_error(version: str, home: Path, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("", encoding="utf-8")
    with pytest.raises(StoreError, match="cannot be written"):
        build_history([version], home=home, output=blocked / "api.csv.gz")
