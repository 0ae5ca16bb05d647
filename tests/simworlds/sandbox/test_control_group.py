"""Control groups: where they are made, what they limit, and that none is left."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from simworlds.sandbox.confinement import control_group
from simworlds.sandbox.confinement.control_group import (
    ControlGroup,
    GroupParents,
    find_parents,
    group_parents,
)
from simworlds.sandbox.confinement.resource_limits import ResourceLimits

LIMITS = ResourceLimits(memory=300 << 20, threads=40)


def unified(top: Path, *groups: str, passed: str = "memory pids") -> str:
    """A tree as cgroup2 shows it, in which every group hands ``passed`` on; returns its line in mountinfo."""
    for group in ("", *groups):
        folder = top / group
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "cgroup.procs").touch()
        (folder / "cgroup.subtree_control").write_text(passed)
    return f"41 31 0:38 / {top} rw,relatime - cgroup2 cgroup2 rw\n"


def test_the_nearest_group_that_hands_memory_on_is_taken(tmp_path: Path) -> None:
    mounts = unified(tmp_path, "user.slice/user-1.slice/app.scope")
    inner = tmp_path / "user.slice" / "user-1.slice" / "app.scope"
    for folder in (inner.parent, inner.parent.parent):
        (folder / "cgroup.procs").touch()
        (folder / "cgroup.subtree_control").write_text("cpu memory pids")
    # The kernel would refuse to hand on what a group with processes has; this file system would not.
    (inner / "cgroup.subtree_control").unlink()
    found = find_parents("0::/user.slice/user-1.slice/app.scope\n", mounts)
    assert found == GroupParents(2, inner.parent, inner.parent)


def test_without_a_group_that_may_be_used_there_is_none(tmp_path: Path) -> None:
    mounts = unified(tmp_path, "a.scope", passed="cpu")
    for folder in (tmp_path, tmp_path / "a.scope"):
        (folder / "cgroup.subtree_control").unlink()
    assert find_parents("0::/a.scope\n", mounts) is None
    assert find_parents("0::/elsewhere\n", mounts) is None
    assert find_parents("", "") is None


def test_a_mount_without_a_source_is_passed_over(tmp_path: Path) -> None:
    mounts = "36 35 98:0 / /mnt rw - tmpfs  rw\n" + unified(tmp_path, "a.scope")
    assert find_parents("0::/a.scope\n", mounts) == GroupParents(
        2, tmp_path / "a.scope", tmp_path / "a.scope"
    )


@pytest.mark.parametrize("text", ["", "0::/\n", "nothing\n", "36 35\n"])
def test_what_cannot_be_read_limits_nothing(monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setattr(Path, "read_text", lambda _: text)
    assert group_parents.__wrapped__() is None


def test_older_hierarchies_are_told_apart_by_controller(tmp_path: Path) -> None:
    rows = ""
    for number, name in enumerate(("memory", "pids")):
        (tmp_path / name / "own").mkdir(parents=True)
        (tmp_path / name / "own" / "cgroup.procs").touch()
        rows += f"3{number} 31 0:3{number} /box {tmp_path / name} rw - cgroup cgroup rw,{name}\n"
    found = find_parents("4:memory:/box/own\n8:pids:/box/own\n0::/\n", rows)
    assert found == GroupParents(1, tmp_path / "memory" / "own", tmp_path / "pids" / "own")
    assert find_parents("4:memory:/other\n", rows) is None  # what is mounted is another part of the hierarchy


def test_what_a_group_of_the_newer_kind_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The kernel makes a new group's files; here they are there before."""
    monkeypatch.setattr(control_group, "_NAME", "simworlds-{owner}-0")
    made = tmp_path / f"simworlds-{os.getpid()}-0"
    real = Path.mkdir

    def mkdir(self: Path, *words: object, **named: object) -> None:
        real(self)
        for name in ("memory.swap.max", "memory.oom.group"):
            (self / name).touch()

    monkeypatch.setattr(Path, "mkdir", mkdir)
    group = ControlGroup(LIMITS, GroupParents(2, tmp_path, tmp_path))
    group.renew()
    assert group.folders == (made,)
    assert {file.name: file.read_text() for file in made.iterdir()} == {
        "memory.max": str(300 << 20),
        "memory.swap.max": "0",
        "memory.oom.group": "1",
        "pids.max": "104",
    }
    assert not group.ran_out_of_memory
    (made / "memory.events").write_text("low 0\noom 2\noom_kill 1\n")
    assert group.ran_out_of_memory


@pytest.fixture
def group() -> ControlGroup:
    """A real one of this machine."""
    made = ControlGroup(LIMITS, group_parents())
    made.renew()
    if not made.folders:
        pytest.skip("no control group can be made here")
    return made


def test_a_group_is_removed_with_its_worker(group: ControlGroup) -> None:
    first = group.folders
    assert all(folder.is_dir() for folder in first)
    group.renew()
    assert not any(folder.exists() for folder in first)
    second = group.folders
    group.close()
    assert not any(folder.exists() for folder in second)
    assert group.folders == ()


def test_what_still_runs_in_a_group_ends_with_it(group: ControlGroup) -> None:
    folders = group.folders
    words = ["sh", "-c", 'for f; do echo $$ > "$f/cgroup.procs"; done; echo in; exec sleep 600', "sh"]
    with subprocess.Popen([*words, *map(str, folders)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "in\n"
        group.close()
        assert process.wait(60) == -9
    assert not any(folder.exists() for folder in folders)


def test_groups_of_a_killed_owner_are_removed_by_the_next(group: ControlGroup) -> None:
    code = (
        "import os\nfrom simworlds.sandbox.confinement.resource_limits import ResourceLimits\n"
        "from simworlds.sandbox.confinement.control_group import ControlGroup, group_parents\n"
        "group = ControlGroup(ResourceLimits(memory=1 << 30), group_parents())\ngroup.renew()\n"
        "print(*group.folders, flush=True)\nos.kill(os.getpid(), 9)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    left = [Path(word) for word in done.stdout.split()]
    assert done.returncode == -9
    assert left
    assert all(folder.is_dir() for folder in left)
    group.renew()
    assert not any(folder.exists() for folder in left)
    group.close()


def test_more_threads_than_the_limit_are_refused_by_the_kernel(group: ControlGroup) -> None:
    if len(group.folders) < 2:
        pytest.skip("processes cannot be limited here")
    code = (
        "import sys, threading\nfor folder in sys.argv[1:]: open(folder + '/cgroup.procs', 'w').write('0')\n"
        "wait = threading.Event()\ntry:\n"
        "    for number in range(500): threading.Thread(target=wait.wait, daemon=True).start()\n"
        "except RuntimeError: print(number)\n"
    )
    words = [sys.executable, "-c", code, *map(str, group.folders)]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.stdout.strip() == str(40 + 64 - 1)
    group.close()
