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
from bench.blenderbench.task_set import chosen, in_order, read_set
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


def test_tasks_are_found_by_level_and_in_the_order_that_people_count_in(tmp_path: Path) -> None:
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


def test_a_task_holds_what_its_files_say(tmp_path: Path) -> None:
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
def test_a_missing_file_is_named_with_its_path(name: str, tmp_path: Path) -> None:
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


def test_a_task_that_is_a_link_out_of_the_set_is_left_out(tmp_path: Path) -> None:
    make_task(tmp_path / "set")
    make_task(tmp_path / "other", "level1/theirs")
    (tmp_path / "set" / "level1" / "theirs").symlink_to(tmp_path / "other" / "level1" / "theirs")
    found = read_set(tmp_path / "set")
    assert [task.id for task in found.tasks] == ["level1/attic1"]
    assert "is a link out of the set" in found.faults[0]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("task.txt", b" \n\t\n", "is empty: there is nothing to ask for"),
        ("task.txt", b"\xff\xfe no text", "is no UTF-8 text"),
        ("task.txt", b"Move\x00 it", "holds characters that no text has"),
        ("task.txt", b"x" * 20_001, "has more than 20,000 bytes"),
        ("start.py", b"#" * (1 << 20) + b"#", "has more than 1,048,576 bytes"),
        ("start.py", b"\xe9", "is no UTF-8 text"),
        ("blender_file.blend", b"", "it is empty"),
        ("blender_file.blend", b"PK\x03\x04", "it is not a .blend file"),
        (GOAL, b"GIF89a", "is no PNG"),
        (GOAL, b"\x89PNG\r\n\x1a\n", "is no PNG"),
    ],
)
def test_a_file_that_is_something_else_is_named_with_its_path(
    name: str, content: bytes, said: str, tmp_path: Path
) -> None:
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
def test_a_goal_of_a_size_that_cannot_be_compared_is_known_without_reading_it(
    size: tuple[int, int], said: str, tmp_path: Path
) -> None:
    folder = make_task(tmp_path)
    (folder / GOAL).write_bytes(png_of(*size))
    told = fault_of(tmp_path)
    assert str(folder / GOAL) in told
    assert said in told


def test_a_pipe_in_the_place_of_a_file_is_not_waited_for(tmp_path: Path) -> None:
    folder = make_task(tmp_path)
    (folder / "task.txt").unlink()
    os.mkfifo(folder / "task.txt")
    assert f"{folder / 'task.txt'} is no plain file" in fault_of(tmp_path)


def test_a_name_that_would_not_survive_a_terminal_is_a_fault(tmp_path: Path) -> None:
    make_task(tmp_path)
    make_task(tmp_path, "level2/a\x1b[31m")
    assert "cannot be a task's name" in read_set(tmp_path).faults[0]


@pytest.mark.parametrize(
    ("inside", "said"), [(None, "is no folder"), ("scenes", "it has none of level1, level2")]
)
def test_a_folder_that_is_no_set_says_what_it_lacks(inside: str | None, said: str, tmp_path: Path) -> None:
    root = tmp_path / "set"
    if inside:
        (root / inside).mkdir(parents=True)
    assert said in fault_of(root)


def test_tasks_are_chosen_by_level_or_id_and_unknown_names_tell_the_known_ones(tmp_path: Path) -> None:
    for name in ("level1/a", "level1/b", "level2/a"):
        make_task(tmp_path, name)
    found = read_set(tmp_path)
    assert [task.id for task in chosen(found, ["level2", "level1/b"])] == ["level1/b", "level2/a"]
    assert chosen(found, []) == found.tasks
    with pytest.raises(NoTasks, match=r"has no level9.*level1/a, level1/b, level2/a"):
        chosen(found, ["level9"])


def test_numbers_in_names_count_as_such_whatever_their_script() -> None:
    names = ["a10", "a9", "10", "9", "b²", "٣", "a"]
    assert sorted(names, key=in_order) == ["٣", "9", "10", "a", "a9", "a10", "b²"]


def test_the_command_lists_tasks_and_faults(tmp_path: Path) -> None:
    make_task(tmp_path)
    (make_task(tmp_path, "level2/bad") / "task.txt").unlink()
    done = CliRunner().invoke(main, ["bench", "blenderbench", "tasks", str(tmp_path)])
    assert done.exit_code == 1
    assert "level1/attic1  32 × 16  Adjust the camera." in done.stdout
    assert "task.txt is missing." in done.stderr


def test_the_command_says_why_there_is_nothing(tmp_path: Path) -> None:
    done = CliRunner().invoke(main, ["bench", "blenderbench", "tasks", str(tmp_path / "none")])
    assert done.exit_code == 2
    assert "is no folder" in done.stderr
