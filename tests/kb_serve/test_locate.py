"""Which file answers for which version."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from kb_serve.errors import BaseMissing
from kb_serve.knowledge_base import KnowledgeBase
from kb_serve.locate import find_base, find_bases

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A home folder with three bases, and things that are none."""
    (tmp_path / "kb").mkdir()
    for name in ("blender-4.2.sqlite", "blender-4.10.sqlite", "blender-4.5.sqlite", ".blender-9.9.sqlite.12.part",
                 "blender-5.sqlite", "blender-6.0.sqlite.old", "notes.txt"):  # fmt: skip
        (tmp_path / "kb" / name).touch()
    (tmp_path / "kb" / "blender-7.0.sqlite").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("asked", "name"),
    [("4.2", "4.2"), ("4.2.3", "4.2"), ("v4.5", "4.5"), (" 4.5.0 ", "4.5"), ("4.10", "4.10"), (None, "4.10")],
)
def test_a_version_is_found_however_it_is_written(folder: Path, asked: str | None, name: str) -> None:
    assert find_base(asked, folder) == folder / "kb" / f"blender-{name}.sqlite"


@pytest.mark.parametrize("asked", ["5.1", "5.0"])
def test_a_version_that_was_not_built_is_missing_with_those_that_were(folder: Path, asked: str) -> None:
    with pytest.raises(BaseMissing) as refused:
        find_base(asked, folder)
    assert f"simworlds kb build {asked}" in str(refused.value)
    assert "4.2, 4.5, 4.10" in str(refused.value)


@pytest.mark.parametrize("asked", ["4.20", "7.0", "3.4"])
def test_a_version_without_a_package_can_only_be_built_from_an_installed_blender(
    folder: Path, asked: str
) -> None:
    with pytest.raises(BaseMissing) as refused:
        find_base(asked, folder)
    assert f"Blender {asked} has no bpy package to build a base from (only 4.2, 4.3," in str(refused.value)
    assert f"simworlds kb build {asked} --blender-exe /path/to/blender" in str(refused.value)
    assert "kb fetch" not in str(refused.value)


@pytest.mark.parametrize("asked", ["0.0", "2.79", "3.0"])
def test_no_build_is_advised_of_blenders_that_are_too_old(folder: Path, asked: str) -> None:
    with pytest.raises(
        BaseMissing, match=f"No base can be built of Blender {asked}: it is older than 3.1"
    ) as refused:
        find_base(asked, folder)
    assert "kb build" not in str(refused.value)


def test_of_several_versions_all_that_are_missing_are_named(folder: Path) -> None:
    assert list(find_bases(["4.2", "4.10"], folder)) == ["4.2", "4.10"]
    with pytest.raises(BaseMissing) as refused:
        find_bases(["4.2", "4.4", "5.1", "7.0"], folder)
    said = str(refused.value)
    assert said.startswith(
        "There are no knowledge bases for Blender 4.4, 5.1, 7.0. Built are: 4.2, 4.5, 4.10. Build them: "
    )
    assert "simworlds kb build 4.4; " in said
    assert "simworlds kb build 5.1 (a minute each; " in said
    assert "simworlds kb fetch VERSION --from URL|FILE. Blender 7.0 has no bpy package" in said


@pytest.mark.parametrize(
    "asked", ["", "newest", "5", "5.x", "5.1.2.3", "../../etc", "5.1\n5.2", "5,1", "-1.2"]
)
def test_invalid_versions_are_refused(folder: Path, asked: str) -> None:
    with pytest.raises(
        BaseMissing, match=r"not a Blender version.*Write it as 5\.1|There is no knowledge base"
    ):
        find_base(asked, folder)


def test_an_empty_home_says_how_to_begin(tmp_path: Path) -> None:
    with pytest.raises(BaseMissing, match="simworlds kb build"):
        find_base(None, tmp_path)
    with pytest.raises(BaseMissing, match="none"):
        find_base("5.1", tmp_path / "nowhere")


def test_a_base_is_opened_by_its_version(base: Path) -> None:
    version = base.stem.removeprefix("blender-")
    with KnowledgeBase.open(version, home=base.parent.parent) as kb:
        assert kb.path == base
        assert kb.meta["minor"] == version
    with KnowledgeBase.open(home=base.parent.parent) as newest:
        assert newest.path == base


def test_the_folder_that_the_environment_names_is_the_home(base: Path) -> None:
    before = os.environ.get("SIMWORLDS_HOME")
    os.environ["SIMWORLDS_HOME"] = str(base.parent.parent)
    try:
        assert find_base(None) == base
    finally:
        if before is None:
            del os.environ["SIMWORLDS_HOME"]
        else:
            os.environ["SIMWORLDS_HOME"] = before
