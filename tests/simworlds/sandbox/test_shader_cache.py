"""Shaders that Blenders begin with: taken from one that ran our own code, and given to each as its own copy."""

from __future__ import annotations

from pathlib import Path

import pytest

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import HostileGround
from simworlds.sandbox.shader_cache import are_kept, keep_shaders, lend_shaders, shaders_folder


@pytest.fixture
def private(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> HostileGround:
    monkeypatch.setenv("SIMWORLDS_SHADERS", str(tmp_path / "kept"))
    ground = HostileGround(tmp_path / "private").make()
    for name in ("mesa_shader_cache/index", "mesa_shader_cache/ad/2c", "other/ad"):
        path = ground.mount / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(name)
    return ground


def files(folder: Path) -> dict[str, str]:
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*") if path.is_file()}


OF_MESA = {name: name for name in ("mesa_shader_cache/index", "mesa_shader_cache/ad/2c")}


def test_what_one_has_compiled_another_begins_with(private: HostileGround, tmp_path: Path) -> None:
    assert not are_kept()
    assert keep_shaders(private) == 2
    assert are_kept()
    assert files(tmp_path / "kept") == OF_MESA
    other = HostileGround(tmp_path / "other").make()
    (other.mount / "mesa_shader_cache").mkdir()
    lend_shaders(other)
    assert files(other.mount) == OF_MESA
    (other.mount / "mesa_shader_cache" / "index").write_text("changed")
    assert files(tmp_path / "kept") == OF_MESA
    assert sorted(path.name for path in tmp_path.iterdir()) == ["kept", "other", "private"]


def test_links_are_not_followed(private: HostileGround, tmp_path: Path) -> None:
    (tmp_path / "secret").write_text("mine")
    (private.mount / "mesa_shader_cache" / "to-a-file").symlink_to(tmp_path / "secret")
    (private.mount / "mesa_shader_cache" / "to-a-folder").symlink_to(tmp_path)
    keep_shaders(private)
    assert files(tmp_path / "kept") == OF_MESA


def test_a_file_that_is_too_large_is_refused(private: HostileGround) -> None:
    with (private.mount / "mesa_shader_cache" / "large").open("wb") as file:
        file.truncate(17 << 20)
    with pytest.raises(Refusal, match="at most"):
        keep_shaders(private)


def test_without_any_a_blender_compiles_its_own(private: HostileGround) -> None:
    before = files(private.mount)
    lend_shaders(private)
    assert files(private.mount) == before


def test_they_lie_in_the_home_folder_unless_told_otherwise(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SIMWORLDS_SHADERS", raising=False)
    monkeypatch.setenv("SIMWORLDS_HOME", "/somewhere")
    assert shaders_folder() == Path("/somewhere/cache/shaders")
