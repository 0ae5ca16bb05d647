"""The official layout: what is found, and what is wrong with the rest, each fault with its path."""

from __future__ import annotations

import os
import struct
import zlib
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner
from PIL import Image

from bench.blenderbench.errors import NoTasks
from bench.blenderbench.task_set import natural_key, read_set, select_tasks
from simworlds.cli import main

if TYPE_CHECKING:
    from pathlib import Path

GOAL = "renders/goal/render1.png"


def make_task(root: Path, name: str = "level1/attic1") -> Path:
    """A task whose files are there; nobody opens its .blend."""
    folder = root / name
    for kind in ("start", "goal"):
        (folder / "renders" / kind).mkdir(parents=True)
        Image.new("RGB", (32, 16), (90, 30, 30)).save(folder / "renders" / kind / "render1.png")
    (folder / "blender_file.blend").write_bytes(b"BLENDER-v405")
    (folder / "start.py").write_text("import bpy\n")
    (folder / "goal.py").write_text("import bpy\n")
    (folder / "task.txt").write_text("Adjust the camera.\n")
    return folder


def fault_of(root: Path) -> str:
    """What is wrong with the one task of a set."""
    with pytest.raises(NoTasks) as caught:
        read_set(root)
    return str(caught.value)


def test_finds_tasks_by_level_in_natural_order(tmp_path: Path) -> None:
    names = ["level3/a1", "level1/room10", "level1/room9", "level2/Böden (2)"]
    for name in names:
        make_task(tmp_path, name)
    (tmp_path / "level1" / "README.md").write_text("Not a task.")
    (tmp_path / "level1" / ".cache").mkdir()
    found = read_set(tmp_path)
    assert [task.id for task in found.tasks] == [
        "level1/room9",
        "level1/room10",
        "level2/Böden (2)",
        "level3/a1",
    ]
    assert found.faults == ()


def test_a_task_has_the_contents_of_its_files(tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / "task.txt").write_bytes(b"\xef\xbb\xbfFirst the lamp,\r\nthen the mug.\r\n")
    Image.new("RGB", (32, 16)).save(folder / "renders" / "goal" / "visprompt1.png")
    [task] = read_set(tmp_path).tasks
    assert task.instruction == "First the lamp,\nthen the mug."
    assert (task.size, task.code) == ((32, 16), "import bpy\n")
    assert task.visprompt == folder / "renders" / "goal" / "visprompt1.png"


def test_a_task_without_a_render_of_its_start_can_be_used(tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / "renders" / "start" / "render1.png").unlink()
    [task] = read_set(tmp_path).tasks
    assert (task.start, task.visprompt) == (None, None)


@pytest.mark.parametrize("name", ["blender_file.blend", "start.py", "task.txt", GOAL])
def test_names_the_path_of_a_missing_file(name: str, tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / name).unlink()
    assert f"{folder / name} is missing." in fault_of(tmp_path)


@pytest.mark.parametrize(
    "name", ["blender_file.blend", "start.py", "task.txt", GOAL, "renders/start/render1.png"]
)
def test_a_link_out_of_the_set_is_not_followed(name: str, tmp_path: Path) -> None:
    folder = make_task(tmp_path / "set")
    elsewhere = tmp_path / "elsewhere"
    (folder / name).rename(elsewhere)
    (folder / name).symlink_to(elsewhere)
    assert f"{folder / name} is a link out of the set, to {elsewhere}" in fault_of(tmp_path / "set")


def test_skips_a_task_that_links_out_of_the_set(tmp_path: Path) -> None:
    make_task(tmp_path / "set")
    make_task(tmp_path / "other", "level1/theirs")
    (tmp_path / "set" / "level1" / "theirs").symlink_to(tmp_path / "other" / "level1" / "theirs")
    found = read_set(tmp_path / "set")
    assert [task.id for task in found.tasks] == ["level1/attic1"]
    assert "is a link out of the set" in found.faults[0]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("task.txt", b" \n\t\n", "is empty; it must hold the instruction"),
        ("task.txt", b"\xff\xfe no text", "is not UTF-8 text"),
        ("task.txt", b"Move\x00 it", "contains control characters"),
        ("task.txt", b"x" * 20_001, "has more than 20,000 bytes"),
        ("start.py", b"#" * (1 << 20) + b"#", "has more than 1,048,576 bytes"),
        ("start.py", b"\xe9", "is not UTF-8 text"),
        ("blender_file.blend", b"", "it is empty"),
        ("blender_file.blend", b"PK\x03\x04", "it is not a .blend file"),
        (GOAL, b"GIF89a", "is not a PNG"),
        (GOAL, b"\x89PNG\r\n\x1a\n", "is not a PNG"),
    ],
)
def test_names_the_path_of_an_invalid_file(name: str, content: bytes, said: str, tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / name).write_bytes(content)
    told = fault_of(tmp_path)
    assert str(folder / name) in told
    assert said in told


def png_of(width: int, height: int) -> bytes:
    """A PNG that claims to be so large; what it holds does not matter."""
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(b"\0" * 100)), (b"IEND", b""))
    body = b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + body


@pytest.mark.parametrize(
    ("size", "said"),
    [
        ((60_000, 60_000), "pixels"),
        ((12_000, 9_000), "pixels"),
        ((5_000, 5_000), "pixels"),
        ((8, 8), "at least 16"),
        ((4_000, 20), "more than 16 times"),
    ],
)
def test_rejects_a_goal_of_a_bad_size_without_reading_it(
    size: tuple[int, int], said: str, tmp_path: Path
) -> None:
    folder = make_task(tmp_path)
    (folder / GOAL).write_bytes(png_of(*size))
    told = fault_of(tmp_path)
    assert str(folder / GOAL) in told
    assert said in told


def test_does_not_wait_for_a_pipe(tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / "task.txt").unlink()
    os.mkfifo(folder / "task.txt")
    assert f"{folder / 'task.txt'} is not a plain file" in fault_of(tmp_path)


def test_rejects_a_name_with_control_characters(tmp_path: Path) -> None:
    make_task(tmp_path)
    make_task(tmp_path, "level2/a\x1b[31m")
    assert "cannot be a task's name" in read_set(tmp_path).faults[0]


@pytest.mark.parametrize(
    ("inside", "said"), [(None, "is not a folder"), ("scenes", "it has none of level1, level2")]
)
def test_says_what_a_folder_lacks_to_be_a_set(inside: str | None, said: str, tmp_path: Path) -> None:
    root = tmp_path / "set"
    if inside:
        (root / inside).mkdir(parents=True)
    assert said in fault_of(root)


def test_selects_tasks_by_level_or_id_and_lists_known_names(tmp_path: Path) -> None:
    for name in ("level1/a", "level1/b", "level2/a"):
        make_task(tmp_path, name)
    found = read_set(tmp_path)
    assert [task.id for task in select_tasks(found, ["level2", "level1/b"])] == ["level1/b", "level2/a"]
    assert select_tasks(found, []) == found.tasks
    with pytest.raises(NoTasks, match=r"has no usable level9.*level1/a, level1/b, level2/a"):
        select_tasks(found, ["level9"])


def test_sorts_numbers_of_any_script() -> None:
    names = ["a10", "a9", "10", "9", "b²", "٣", "a"]
    assert sorted(names, key=natural_key) == ["٣", "9", "10", "a", "a9", "a10", "b²"]


def test_the_command_lists_tasks_and_faults(tmp_path: Path) -> None:
    make_task(tmp_path)
    (make_task(tmp_path, "level2/bad") / "task.txt").unlink()
    done = CliRunner().invoke(main, ["bench", "blenderbench", "tasks", str(tmp_path)])
    assert done.exit_code == 1
    assert "level1/attic1  32 × 16  Adjust the camera." in done.stdout
    assert "task.txt is missing." in done.stderr


def test_the_command_says_why_there_are_no_tasks(tmp_path: Path) -> None:
    done = CliRunner().invoke(main, ["bench", "blenderbench", "tasks", str(tmp_path / "none")])
    assert done.exit_code == 2
    assert "is not a folder" in done.stderr
