"""What is done from outside in folders that a sandboxed process writes to."""

from __future__ import annotations

import os
import resource
import threading
from typing import TYPE_CHECKING

import pytest

from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.hostile_ground import DEEPEST, HostileGround

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def ground(tmp_path: Path) -> HostileGround:
    (tmp_path / "run" / "workspace").mkdir(parents=True)
    return HostileGround(tmp_path / "run" / "workspace")


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    """A file that executed code must neither read nor write through the host."""
    path = tmp_path / "outside" / "secret.blend"
    path.parent.mkdir()
    path.write_text("secret")
    return path


@pytest.fixture
def small_files() -> Iterator[None]:
    """No file of this process may grow beyond 10,000 bytes meanwhile: as on a disk that is full."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


# Files that Blender made


def test_takes_files_whole(ground: HostileGround) -> None:
    (ground.mount / "deep").mkdir()
    (ground.mount / "deep" / "made.bin").write_bytes(os.urandom(3_000_000))
    content = (ground.mount / "deep" / "made.bin").read_bytes()
    target = ground.mount.parent / "new" / "kept.bin"
    ground.take("deep/made.bin", target)
    assert target.read_bytes() == content
    assert not (ground.mount / "deep" / "made.bin").exists()
    assert [path.name for path in target.parent.iterdir()] == ["kept.bin"]


@pytest.mark.parametrize("relative", ["", "/etc/passwd", "../../outside/secret.blend", "a/../b", "a\0b"])
def test_refuses_invalid_workspace_paths(ground: HostileGround, outside: Path, relative: str) -> None:
    with pytest.raises(Refusal, match="not a valid path in the workspace"):
        ground.open(relative)


def test_never_follows_links(ground: HostileGround, outside: Path) -> None:
    (ground.mount / "link.blend").symlink_to(outside)
    (ground.mount / "linked").symlink_to(outside.parent)
    for relative in ("link.blend", "linked/secret.blend"):
        with pytest.raises(Refusal, match="not a regular file"):
            ground.open(relative)
        with pytest.raises(Refusal, match="not a regular file"):
            ground.take(relative, ground.mount.parent / "kept.blend")
    assert outside.read_text() == "secret"
    assert not (ground.mount.parent / "kept.blend").exists()


def test_survives_a_folder_replaced_by_a_link(ground: HostileGround, outside: Path) -> None:
    """The file is opened in ``made``, which is a link to elsewhere by the time that it is to be removed."""
    (ground.mount / "made").mkdir()
    mine = ground.mount / "made" / "secret.blend"
    mine.write_bytes(b"mine" * 5_000_000)
    stop = threading.Event()

    def swap() -> None:
        while not stop.is_set():
            (ground.mount / "made").rename(ground.mount / "real")
            (ground.mount / "made").symlink_to(outside.parent)
            (ground.mount / "made").unlink()
            (ground.mount / "real").rename(ground.mount / "made")

    swapper = threading.Thread(target=swap)
    swapper.start()
    try:
        for _ in range(200):
            if not mine.exists():
                continue
            try:
                ground.take("made/secret.blend", ground.mount.parent / "kept.blend", durable=False)
            except Refusal:
                continue
            break
    finally:
        stop.set()
        swapper.join()
    assert outside.read_text() == "secret"
    if (ground.mount.parent / "kept.blend").exists():
        assert (ground.mount.parent / "kept.blend").read_bytes()[:4] == b"mine"


@pytest.mark.parametrize("kind", ["pipe", "folder", "nothing"])
def test_refuses_irregular_files_at_once(ground: HostileGround, kind: str) -> None:
    path = ground.mount / "made"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    with pytest.raises(Refusal, match="not a regular file"):
        ground.open("made")


def test_takes_no_partial_file(ground: HostileGround, small_files: None) -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, resource.getrlimit(resource.RLIMIT_FSIZE)[1:] * 2)
    (ground.mount / "made.bin").write_bytes(bytes(50_000))
    target = ground.mount.parent / "kept.bin"
    target.write_text("from before")
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    with pytest.raises(Refusal, match=r"kept\.bin cannot be written: File too large"):
        ground.take("made.bin", target)
    assert target.read_text() == "from before"
    assert (ground.mount / "made.bin").stat().st_size == 50_000
    assert not list(ground.mount.parent.glob(".*.part"))


# Files that Blender is given


@pytest.mark.parametrize("there", ["nothing", "file", "link", "dangling link", "folder", "pipe"])
def test_put_replaces_whatever_is_there(ground: HostileGround, outside: Path, there: str) -> None:
    place = ground.mount / "scene.blend"
    if there == "file":
        place.write_text("old")
    elif there == "link":
        place.symlink_to(outside)
    elif there == "dangling link":
        place.symlink_to(outside.with_name("none"))
    elif there == "folder":
        (place / "deep").mkdir(parents=True)
        (place / "deep" / "file").write_text("old")
    elif there == "pipe":
        os.mkfifo(place)
    source = ground.mount.parent / "000001.blend"
    source.write_text("new")
    ground.put(source, "scene.blend")
    assert not place.is_symlink()
    assert place.read_text() == "new"
    assert outside.read_text() == "secret"
    assert not outside.with_name("none").exists()
    assert [path.name for path in ground.mount.iterdir()] == ["scene.blend"]


def test_put_leaves_no_partial_file(ground: HostileGround, small_files: None) -> None:
    source = ground.mount.parent / "000001.blend"
    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    source.write_bytes(bytes(50_000))
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    with pytest.raises(Refusal, match="File too large"):
        ground.put(source, "scene.blend")
    assert list(ground.mount.iterdir()) == []


# Clearing away


def test_empties_deep_and_closed_folders(tmp_path: Path, outside: Path) -> None:
    room = tmp_path / "room"
    room.mkdir()
    (room / "link").symlink_to(outside.parent)
    here = os.open(room, os.O_RDONLY)
    for _ in range(100):  # longer than any path may be
        os.mkdir("d" * 50, dir_fd=here)
        there = os.open("d" * 50, os.O_RDONLY, dir_fd=here)
        os.close(here)
        here = there
        os.close(os.open("file", os.O_CREAT | os.O_WRONLY, dir_fd=here))
    os.close(here)
    (room / "closed").mkdir()
    (room / "closed" / "file").write_text("x")
    (room / "closed").chmod(0)
    HostileGround(room).empty()
    assert list(room.iterdir()) == []
    assert outside.read_text() == "secret"


def test_emptying_a_missing_folder_is_no_error(tmp_path: Path) -> None:
    HostileGround(tmp_path / "none").empty()


def test_measures_disk_usage_without_following_links(tmp_path: Path, outside: Path) -> None:
    room = tmp_path / "room"
    (room / "deep").mkdir(parents=True)
    (room / "deep" / "file").write_bytes(os.urandom(100_000))
    (room / "link").symlink_to(outside.parent)
    found = HostileGround(room).measure()
    assert found.files == 3
    assert 100_000 <= found.bytes <= 130_000
    assert HostileGround(room).measure(at_most=1).files == 2


def test_measures_endless_folders_down_to_a_depth(tmp_path: Path) -> None:
    deep = tmp_path.joinpath(*["d"] * (DEEPEST + 1))
    deep.mkdir(parents=True)
    found = HostileGround(tmp_path).measure()
    assert found.deepest == found.files == DEEPEST


def test_removes_only_files_newer_than_a_moment(ground: HostileGround) -> None:
    (ground.mount / "old").mkdir()
    (ground.mount / "old" / "kept").write_text("kept")
    moment = ground.now()
    while ground.now() <= moment:
        pass
    (ground.mount / "new" / "deep").mkdir(parents=True)
    (ground.mount / "new" / "deep" / "file").write_text("new")
    (ground.mount / "old" / "new").write_text("new")
    ground.remove_since(moment)
    assert [path.relative_to(ground.mount).as_posix() for path in sorted(ground.mount.rglob("*"))] == [
        "old",
        "old/kept",
    ]
