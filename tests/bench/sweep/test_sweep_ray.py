"""A sweep on a Ray cluster of two nodes, one of which is killed meanwhile: the same results, and nothing lost."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from sweeping import CHEAP, content, record, scores

from bench.sweep.bundles import (
    Bundle,
    BundledFile,
    DamagedBundle,
    bundle_changes,
    bundle_files,
    unpack_bundle,
)
from bench.sweep.content_hash import digest_of_bytes
from simworlds.cli import main

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from sweeping import Command

pytestmark = pytest.mark.slow

HERE = Path(__file__).parent
SCENES = ("cloth_D1_01", "cloth_D1_02", "cloth_D2_01", "rigid_D1_01")
LOOPBACK = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}


@pytest.fixture
def cluster() -> Iterator[subprocess.Popen[str]]:
    """The program that holds the cluster. Its folder has a short name: sockets are in it."""
    pytest.importorskip("ray", reason="the extra 'ray' is not installed")
    with tempfile.TemporaryDirectory(prefix="ray", dir="/tmp", ignore_cleanup_errors=True) as folder:
        process = subprocess.Popen(
            [sys.executable, "-P", str(HERE / "cluster.py"), folder],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        with process:
            yield process
            assert process.stdin is not None
            process.stdin.close()
            process.wait(60)


@pytest.fixture
def many(made: Path, tmp_path: Path) -> Path:
    """Files for four scenes."""
    folder = tmp_path / "made"
    shutil.copytree(made, folder)
    shutil.copy(made / "cloth_D1_01.blend", folder / "cloth_D2_01.blend")
    return folder


@pytest.mark.whole
@pytest.mark.blender
def test_a_killed_node_costs_only_time(
    many: Path, tmp_path: Path, cluster: subprocess.Popen[str], command: Callable[..., Command]
) -> None:
    assert cluster.stdout is not None
    assert cluster.stdin is not None
    address = cluster.stdout.readline().strip()
    assert address.startswith("127.0.0.1:")
    words = ("run", "--system", f"folder={many}", "--name", "theirs", "--scenes", ",".join(SCENES), *CHEAP)
    sweep = command(*words, "--frames", "none", "--out", tmp_path / "there", "--ray", address, **LOOPBACK)
    sweep.until("[1/4]")
    print("lose", file=cluster.stdin, flush=True)
    assert cluster.stdout.readline() == "lost\n"
    assert len(scores(tmp_path / "there" / "theirs")) < len(SCENES)
    code, out, said = sweep.end()
    assert (code, "4 scenes: 3 scored" in out) == (0, True), said
    assert "raylet" not in out
    here = ["bench", *words, "--frames", "none", "--out", str(tmp_path / "here")]
    assert CliRunner().invoke(main, here).exit_code == 0
    there_found, here_found = tmp_path / "there" / "theirs", tmp_path / "here" / "theirs"
    assert content(there_found) == content(here_found)
    assert len(content(there_found)) == len(SCENES)
    assert scores(there_found) == scores(here_found)
    assert record(there_found, "cloth_D1_01")["system"]["settings"] == {"folder": str(many)}


def test_without_a_cluster_it_says_how_to_start_one(
    made: Path, tmp_path: Path, command: Callable[..., Command]
) -> None:
    pytest.importorskip("ray", reason="the extra 'ray' is not installed")
    words = ("--system", f"folder={made}", "--scenes", "cloth_D1_03", "--out", tmp_path, *CHEAP)
    sweep = command("run", *words, "--ray", "127.0.0.1:1", **LOOPBACK)
    code, _, said = sweep.end()
    assert (code, "ray start --head" in said) == (2, True), said


def test_without_the_package_it_says_what_to_install(
    made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    words = ["bench", "run", "--system", f"folder={made}", "--out", str(tmp_path), "--ray", "auto", *CHEAP]
    done = CliRunner().invoke(main, words)
    assert (done.exit_code, "extra 'ray'" in done.stderr) == (2, True)


# What travels


def test_a_bundle_has_changed_and_deleted_files(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    (here / "frames").mkdir(parents=True)
    (here / "record.json").write_text("old")
    (here / "frames" / "old.png").write_text("old")
    (here / "same").write_text("same")
    before = unpack_bundle(bundle_files(here, [path for path in here.rglob("*") if path.is_file()]), there)
    (there / "record.json").write_text("new")
    (there / "frames" / "old.png").unlink()
    (there / "frames" / "new.png").write_text("new")
    bundle = bundle_changes(there, before)
    assert {file.path for file in bundle.files} == {"record.json", "frames/new.png"}
    unpack_bundle(bundle, here, last="record.json")
    assert {path.name: path.read_text() for path in here.rglob("*") if path.is_file()} == {
        "record.json": "new",
        "new.png": "new",
        "same": "same",
    }


@pytest.mark.parametrize("path", ["../out", "/etc/out", "link/out", "", "a\0b"])
def test_a_bundle_writes_nothing_outside_its_folder(path: str, tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path)
    good = BundledFile("good", digest_of_bytes(b"good"), b"good")
    bad = BundledFile(path, digest_of_bytes(b"bad"), b"bad")
    with pytest.raises(DamagedBundle, match="is outside"):
        unpack_bundle(Bundle((good, bad)), folder)
    assert sorted(tmp_path.rglob("*")) == [folder, folder / "link"]


def test_a_damaged_bundle_is_not_unpacked(tmp_path: Path) -> None:
    with pytest.raises(DamagedBundle, match="did not arrive as it was sent"):
        unpack_bundle(Bundle((BundledFile("file", "0" * 64, b"other"),)), tmp_path)
    assert not list(tmp_path.iterdir())
