"""A run's folder: what is put into it, and what is taken out of the part that executed code writes to."""

from __future__ import annotations

import os
import resource
import threading
from typing import TYPE_CHECKING

import pytest

from agents.blender.run_folder import RunFolder, new_run
from simworlds.folder_lock import locked
from simworlds.sandbox import usage
from simworlds.sandbox.confined_command import ResourceLimits
from simworlds.sandbox.errors import Refusal

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture
def folder(tmp_path: Path) -> RunFolder:
    return RunFolder.make(tmp_path / "run")


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


# Names that callers give


@pytest.mark.parametrize(
    ("name", "lies"),
    [
        ("tower", "tower.blend"),
        ("tower.blend", "tower.blend"),
        ("saves/tower", "saves/tower.blend"),
        ("saves\\tower.blend", "saves/tower.blend"),
        ("Turm (2) +ß", "Turm (2) +ß.blend"),
        ("v1.2", "v1.2.blend"),
        (".hidden", ".hidden.blend"),
    ],
)
def test_accepts_plain_file_names(folder: RunFolder, name: str, lies: str) -> None:
    assert folder.place_for(name, ".blend") == folder.root / lies


@pytest.mark.parametrize(
    "name",
    [
        *("", ".", "..", "/", "../tower", "a/../../tower", "/etc/passwd", "~/tower", "C:\\tower", "a//../b"),
        *("a\0b", "a\nb", "a:b", "x" * 200, "/".join("abcdefghij"), " ", "...", "a/ /b"),
    ],
)
def test_a_name_that_leads_elsewhere_is_refused(folder: RunFolder, name: str) -> None:
    with pytest.raises(Refusal, match="give a relative path such as"):
        folder.place_for(name, ".blend")


@pytest.mark.parametrize(
    "name", ["workspace/x", "checkpoints/000001", "private/x", "Workspace/x", "CHECKPOINTS/x"]
)
def test_refuses_to_save_in_reserved_folders(folder: RunFolder, name: str) -> None:
    with pytest.raises(Refusal, match="choose another folder"):
        folder.place_for(name, ".blend")


def test_refuses_links_that_lead_out_of_the_run(folder: RunFolder, outside: Path) -> None:
    (folder.root / "saves").symlink_to(outside.parent)
    with pytest.raises(Refusal, match="leads out"):
        folder.place_for("saves/secret", ".blend")


# Files that Blender made


def test_takes_files_whole(folder: RunFolder) -> None:
    (folder.workspace / "deep").mkdir()
    (folder.workspace / "deep" / "made.bin").write_bytes(os.urandom(3_000_000))
    content = (folder.workspace / "deep" / "made.bin").read_bytes()
    target = folder.root / "new" / "kept.bin"
    folder.take("deep/made.bin", target)
    assert target.read_bytes() == content
    assert not (folder.workspace / "deep" / "made.bin").exists()
    assert [path.name for path in target.parent.iterdir()] == ["kept.bin"]


@pytest.mark.parametrize("relative", ["", "/etc/passwd", "../../outside/secret.blend", "a/../b", "a\0b"])
def test_refuses_invalid_workspace_paths(folder: RunFolder, outside: Path, relative: str) -> None:
    with pytest.raises(Refusal, match="not a valid path in the workspace"):
        folder.open_made(relative)


def test_never_follows_links(folder: RunFolder, outside: Path) -> None:
    (folder.workspace / "link.blend").symlink_to(outside)
    (folder.workspace / "linked").symlink_to(outside.parent)
    for relative in ("link.blend", "linked/secret.blend"):
        with pytest.raises(Refusal, match="not a regular file"):
            folder.open_made(relative)
        with pytest.raises(Refusal, match="not a regular file"):
            folder.take(relative, folder.root / "kept.blend")
    assert outside.read_text() == "secret"
    assert not (folder.root / "kept.blend").exists()


def test_survives_a_folder_replaced_by_a_link(folder: RunFolder, outside: Path) -> None:
    """The file is opened in ``made``, which is a link to elsewhere by the time that it is to be removed."""
    (folder.workspace / "made").mkdir()
    mine = folder.workspace / "made" / "secret.blend"
    mine.write_bytes(b"mine" * 5_000_000)
    stop = threading.Event()

    def swap() -> None:
        while not stop.is_set():
            (folder.workspace / "made").rename(folder.workspace / "real")
            (folder.workspace / "made").symlink_to(outside.parent)
            (folder.workspace / "made").unlink()
            (folder.workspace / "real").rename(folder.workspace / "made")

    swapper = threading.Thread(target=swap)
    swapper.start()
    try:
        for _ in range(200):
            if not mine.exists():
                continue
            try:
                folder.take("made/secret.blend", folder.root / "kept.blend", durable=False)
            except Refusal:
                continue
            break
    finally:
        stop.set()
        swapper.join()
    assert outside.read_text() == "secret"
    if (folder.root / "kept.blend").exists():
        assert (folder.root / "kept.blend").read_bytes()[:4] == b"mine"


@pytest.mark.parametrize("kind", ["pipe", "folder", "nothing"])
def test_refuses_irregular_files_at_once(folder: RunFolder, kind: str) -> None:
    path = folder.workspace / "made"
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    with pytest.raises(Refusal, match="not a regular file"):
        folder.open_made("made")


def test_takes_no_partial_file(folder: RunFolder, small_files: None) -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, resource.getrlimit(resource.RLIMIT_FSIZE)[1:] * 2)
    (folder.workspace / "made.bin").write_bytes(bytes(50_000))
    target = folder.root / "kept.bin"
    target.write_text("from before")
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
    with pytest.raises(Refusal, match=r"kept\.bin cannot be written: File too large"):
        folder.take("made.bin", target)
    assert target.read_text() == "from before"
    assert (folder.workspace / "made.bin").stat().st_size == 50_000
    assert not list(folder.root.glob(".*.part"))


# Files that Blender is given


@pytest.mark.parametrize("there", ["nothing", "file", "link", "dangling link", "folder", "pipe"])
def test_put_replaces_whatever_is_there(folder: RunFolder, outside: Path, there: str) -> None:
    place = folder.workspace / "scene.blend"
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
    source = folder.checkpoints / "000001.blend"
    source.write_text("new")
    assert folder.put(source, "scene.blend") == place
    assert not place.is_symlink()
    assert place.read_text() == "new"
    assert outside.read_text() == "secret"
    assert not outside.with_name("none").exists()
    assert [path.name for path in folder.workspace.iterdir()] == ["scene.blend"]


def test_put_leaves_no_partial_file(folder: RunFolder, small_files: None) -> None:
    source = folder.checkpoints / "000001.blend"
    hard = resource.getrlimit(resource.RLIMIT_FSIZE)[1]
    resource.setrlimit(resource.RLIMIT_FSIZE, (hard, hard))
    source.write_bytes(bytes(50_000))
    resource.setrlimit(resource.RLIMIT_FSIZE, (10_000, hard))
    with pytest.raises(Refusal, match="File too large"):
        folder.put(source, "scene.blend")
    assert list(folder.workspace.iterdir()) == []


# One run, one worker


def test_refuses_a_second_lock_of_a_run(folder: RunFolder) -> None:
    with locked(folder.root), pytest.raises(Refusal, match="in use"), locked(folder.root):
        pass
    with locked(folder.root):
        pass


def test_runs_started_in_one_second_get_their_own_folders(tmp_path: Path) -> None:
    made = [new_run(tmp_path / "runs").root for _ in range(5)]
    assert len(set(made)) == 5
    assert all((root / "workspace").is_dir() and (root / "checkpoints").is_dir() for root in made)


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
    usage.empty_folder(room)
    assert list(room.iterdir()) == []
    assert outside.read_text() == "secret"


def test_emptying_a_missing_folder_is_no_error(tmp_path: Path) -> None:
    usage.empty_folder(tmp_path / "none")


def test_measures_disk_usage_without_following_links(tmp_path: Path, outside: Path) -> None:
    room = tmp_path / "room"
    (room / "deep").mkdir(parents=True)
    (room / "deep" / "file").write_bytes(os.urandom(100_000))
    (room / "link").symlink_to(outside.parent)
    found = usage.measure(room)
    assert found.files == 3
    assert 100_000 <= found.bytes <= 130_000
    assert usage.measure(room, at_most=1).files == 2


def test_measures_endless_folders_down_to_a_depth(tmp_path: Path) -> None:
    deep = tmp_path.joinpath(*["d"] * (usage.DEEPEST + 1))
    deep.mkdir(parents=True)
    found = usage.measure(tmp_path)
    assert found.deepest == found.files == usage.DEEPEST


def test_removes_only_files_newer_than_a_moment(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()
    (tmp_path / "old" / "kept").write_text("kept")
    moment = usage.now(tmp_path)
    while usage.now(tmp_path) <= moment:
        pass
    (tmp_path / "new" / "deep").mkdir(parents=True)
    (tmp_path / "new" / "deep" / "file").write_text("new")
    (tmp_path / "old" / "new").write_text("new")
    usage.remove_since(tmp_path, moment)
    assert [path.relative_to(tmp_path).as_posix() for path in sorted(tmp_path.rglob("*"))] == [
        "old",
        "old/kept",
    ]


# Limits


@pytest.fixture
def two(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """Folders to watch; looking at them is quick, however slow this machine is at present."""
    monkeypatch.setattr(usage, "_QUICK_SECONDS", 1e6)
    (tmp_path / "workspace").mkdir()
    (tmp_path / "private").mkdir()
    return tmp_path / "workspace", tmp_path / "private"


def test_counts_usage_of_both_folders_together(two: tuple[Path, Path]) -> None:
    watch = usage.UsageMonitor(two, ResourceLimits(disk=150_000, files=0))
    for number, folder in enumerate(two):
        assert watch.excess(at_end=True) is None
        for name in range(20):  # many files are no fault, where their number has no limit
            (folder / f"{number}-{name}").write_bytes(bytes(4096))
    assert watch.excess(at_end=True) == "brought the run's files to 0 MB; the limit is 0 MB"


def test_counts_only_usage_beyond_the_initial_files(two: tuple[Path, Path]) -> None:
    for number in range(30):
        (two[0] / f"old{number}").write_text("x")
    watch = usage.UsageMonitor(two, ResourceLimits(files=10))
    assert watch.excess(at_end=True) is None
    (two[0] / "new").write_text("x")
    assert watch.excess(at_end=True) == "brought the run to more than 30 files"


def test_pauses_between_checks_except_at_the_end_of_a_call(
    two: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(usage, "_CHECK_SECONDS", 1e6)
    watch = usage.UsageMonitor(two, ResourceLimits(files=1))
    assert watch.excess() is None
    for number in range(5):
        (two[0] / str(number)).write_text("x")
    assert watch.excess() is None
    assert watch.excess(at_end=True) is not None


def test_removes_nothing_from_before_the_last_check(two: tuple[Path, Path]) -> None:
    watch = usage.UsageMonitor(two, ResourceLimits(files=3))
    (two[0] / "kept").write_text("x")
    assert watch.excess(at_end=True) is None
    since = watch.last_within_limits
    for number in range(5):
        (two[1] / str(number)).write_text("x")
    assert watch.excess(at_end=True) is not None
    assert watch.last_within_limits == since
    for folder in two:
        usage.remove_since(folder, since)
    assert (two[0] / "kept").exists()
