"""Whatever ends a write half-way, the old base stands, answers, and is alone in its folder."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from places import REPO

from kb_serve.knowledge_base import KnowledgeBase

if TYPE_CHECKING:
    from built_base import Built

QUERY = "ClothSettings.quality"
HALF = 6_000_000  # bytes: less than is written before a writer waits

# Reads everything that a base of Blender needs, says so, then writes it. With a third argument, so many rows more: then
# it waits in the middle of writing.
WRITER = """
import sys, pathlib, time
from kb_build.errors import StoreError
from kb_build.blender.extract_reader import read_extract
from kb_build.store import Contents, write_base
extract = read_extract(pathlib.Path(sys.argv[1]))
def rows(count):
    for number in range(count):
        yield f"bpy.types.Thing{number}", "It still works. " * 5
    if count:
        time.sleep(600)
more = rows(int(sys.argv[3]))
print("ready", flush=True)
try:
    contents = Contents(extract.symbols, (), extract.links, {"fingerprint": "new"}, still_works=more)
    write_base(pathlib.Path(sys.argv[2]), contents)
except StoreError as error:
    sys.exit(f"StoreError: {error}")
print("written", flush=True)
"""

pytestmark = pytest.mark.blender


@pytest.fixture
def old(base: Path, tmp_path: Path) -> Path:
    """A base that answers, in a folder of its own."""
    folder = tmp_path / "old"
    folder.mkdir()
    return Path(shutil.copy(base, folder / base.name))


def start(base: Path, target: Path, limit: int | None = None, more: int = 0) -> subprocess.Popen[str]:
    def bound() -> None:
        if limit is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    extract = next((base.parent.parent / "extracts").glob("*.jsonl"))
    return subprocess.Popen(
        [sys.executable, "-c", WRITER, str(extract), str(target), str(more)],
        env=os.environ | {"PYTHONPATH": str(REPO)}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        preexec_fn=bound,
    )  # fmt: skip


def assert_stands(path: Path, before: bytes) -> None:
    assert path.read_bytes() == before
    with KnowledgeBase(path) as kb:
        assert kb.query(QUERY).hits[0].id == f"bpy.types.{QUERY}"


def parts_of(path: Path) -> list[Path]:
    return [other for other in path.parent.iterdir() if other != path]


def test_a_writer_that_is_killed_leaves_the_old_base_whole(small: Built, old: Path) -> None:
    before = old.read_bytes()
    with start(small.path, old, more=200_000) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        while not any(part.stat().st_size >= HALF for part in parts_of(old)):
            assert process.poll() is None, "the write ended before it could be killed"
        process.send_signal(signal.SIGKILL)
    assert_stands(old, before)


@pytest.mark.parametrize("limit", [4_096, 400_000])
def test_a_disk_that_is_full_is_named_and_the_old_base_stands(small: Built, old: Path, limit: int) -> None:
    before = old.read_bytes()
    with start(small.path, old, limit) as process:
        _, errors = process.communicate()
    assert process.returncode == 1
    assert errors.startswith("StoreError: ")
    assert str(old) in errors
    assert "The old one, if any, is unchanged" in errors
    assert_stands(old, before)
    assert parts_of(old) == []
