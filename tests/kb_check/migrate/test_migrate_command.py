"""``simworlds migrate`` as a process of its own."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import pytest
from places import REPO

if TYPE_CHECKING:
    from pathlib import Path

SIMWORLDS = [sys.executable, "-c", "from simworlds.cli import main; main(prog_name='simworlds')", "migrate"]
OLD = 'import bpy\nbpy.context.object.draw_type = "WIRE"\n'
NEW = 'import bpy\nbpy.context.object.display_type = "WIRE"\n'


@dataclass(frozen=True)
class Outcome:
    code: int
    out: str
    err: str


@dataclass(frozen=True)
class Command:
    """The command in a folder, with a home of its own."""

    home: Path
    folder: Path

    def run(self, *args: str) -> Outcome:
        environment = os.environ | {"SIMWORLDS_HOME": str(self.home), "PYTHONPATH": str(REPO)}
        done = subprocess.run(
            [*SIMWORLDS, *args], cwd=self.folder, env=environment, capture_output=True, text=True, check=False
        )
        assert "Traceback" not in done.stderr, done.stderr
        return Outcome(done.returncode, done.stdout, done.stderr)

    def write(self, name: str, text: str) -> Path:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text.encode())
        return path


@pytest.fixture
def command(base: Path, tmp_path: Path) -> Command:
    home, folder = tmp_path / "home", tmp_path / "code"
    (home / "kb").mkdir(parents=True)
    folder.mkdir()
    (home / "kb" / base.name).symlink_to(base)
    return Command(home, folder)


def test_nothing_is_written_without_write(command: Command) -> None:
    path = command.write("old.py", OLD)
    done = command.run("old.py")
    assert done.code == 0
    assert "+bpy.context.object.display_type" in done.out
    assert "Nothing was written" in done.out
    assert path.read_text() == OLD
    assert [one.name for one in command.folder.iterdir()] == ["old.py"]


def test_write_changes_the_file_and_explains_every_change(command: Command) -> None:
    path = command.write("addon/old.py", OLD + "bpy.context.object.layers[0] = True\n")
    done = command.run("addon", "--write")
    assert done.code == 1  # a person must decide something
    assert path.read_text().startswith(NEW)
    report = (command.folder / "addon" / "MIGRATION.md").read_text()
    assert '`bpy.context.object.draw_type = "WIRE"` | `bpy.context.object.display_type = "WIRE"`' in report
    assert "release notes 2.80" in report
    assert "- line 3 (now 3), error: `bpy.types.Object.layers` does not exist" in report


def test_diff_prints_the_diff_alone(command: Command) -> None:
    command.write("old.py", OLD)
    done = command.run("old.py", "--diff")
    assert done.out.splitlines()[0] == "--- old.py"
    assert done.out.splitlines()[-1].startswith("+bpy.context")


def test_json_has_changes_and_decisions(command: Command) -> None:
    command.write("old.py", OLD + "bpy.context.object.layers[0] = True\n")
    (file,) = json.loads(command.run("old.py", "--json").out)["files"]
    assert file["changed"]
    assert [change["line"] for change in file["changes"]] == [2]
    assert [decision["rule"] for decision in file["decisions"]] == ["unknown-attribute"]


def test_the_encoding_of_a_file_stays(command: Command) -> None:
    text = f'# -*- coding: latin-1 -*-\nname = "Größe"\n{OLD}'
    path = command.folder / "old.py"
    path.write_bytes(text.encode("latin-1"))
    command.run("old.py", "--write")
    assert path.read_bytes() == f'# -*- coding: latin-1 -*-\nname = "Größe"\n{NEW}'.encode("latin-1")


def test_what_python_cannot_read_is_not_touched(command: Command) -> None:
    broken = f"{OLD}print 'x'\n"
    path = command.write("old.py", broken)
    done = command.run("old.py", "--write")
    assert path.read_text() == broken
    assert done.code == 1
    assert "syntax-error" in done.out


def test_unknown_versions_and_files_are_said(command: Command) -> None:
    command.write("old.py", OLD)
    assert "not a Blender version" in command.run("old.py", "--to", "five").err
    assert command.run("old.py", "--to", "2.49").code == 2
    assert "There is no file" in command.run("none.py").err


def test_run_compares_the_scenes(command: Command) -> None:
    command.write("old.py", f"{OLD}bpy.ops.mesh.primitive_cube_add(radius=2)\n")
    done = command.run("old.py", "--run", "--json")
    (run,) = json.loads(done.out)["runs"]
    assert run["after"]["error"] == ""
    assert run["before"] is None


def test_run_tells_where_the_new_code_fails(command: Command) -> None:
    command.write("old.py", "import bpy\n\nraise RuntimeError('no')\n")
    (run,) = json.loads(command.run("old.py", "--run", "--json").out)["runs"]
    assert run["after"]["error"] == "RuntimeError: no (old.py:3)"


def test_run_registers_an_addon(command: Command) -> None:
    code = "import bpy\nclass A(bpy.types.Operator):\n    bl_idname = 'a.b'\n    bl_label = 'A'\n"
    code += "def register():\n    bpy.utils.register_class(A)\ndef unregister():\n    bpy.utils.unregister_class(A)\n"
    command.write("addon/__init__.py", code)
    done = command.run("addon", "--run")
    assert "addon: Runs in Blender" in done.out
    assert done.code == 0
