"""``simworlds migrate``: what it says, writes and leaves."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from checking import RIGHT as NEW
from checking import WRONG as OLD
from checking import Command


@pytest.fixture
def command(command: Command) -> Command:
    return replace(command, name="migrate")


def test_nothing_is_written_without_write(command: Command) -> None:
    path = command.write("old.py", OLD)
    done = command("old.py")
    assert done.code == 0
    assert "+bpy.context.object.display_type" in done.out
    assert "Nothing was written" in done.out
    assert path.read_text() == OLD
    assert [one.name for one in command.folder.iterdir()] == ["old.py"]


def test_write_changes_the_file_and_explains_every_change(command: Command) -> None:
    path = command.write("addon/old.py", OLD + "bpy.context.object.layers[0] = True\n")
    done = command("addon", "--write")
    assert done.code == 1  # a person must decide something
    assert path.read_text().startswith(NEW)
    report = (command.folder / "addon" / "MIGRATION.md").read_text()
    assert '`bpy.context.object.draw_type = "WIRE"` | `bpy.context.object.display_type = "WIRE"`' in report
    assert "release notes 2.80" in report
    assert "- line 3 (now 3), error: `bpy.types.Object.layers` does not exist" in report


def test_diff_prints_the_diff_alone(command: Command) -> None:
    command.write("old.py", OLD)
    done = command("old.py", "--diff")
    assert done.out.splitlines()[0] == "--- old.py"
    assert done.out.splitlines()[-1].startswith("+bpy.context")


def test_json_has_changes_and_decisions(command: Command) -> None:
    command.write("old.py", OLD + "bpy.context.object.layers[0] = True\n")
    (file,) = json.loads(command("old.py", "--json").out)["files"]
    assert file["changed"]
    assert [change["line"] for change in file["changes"]] == [2]
    assert [decision["rule"] for decision in file["decisions"]] == ["unknown-attribute"]


def test_the_encoding_of_a_file_stays(command: Command) -> None:
    text = f'# -*- coding: latin-1 -*-\nname = "Größe"\n{OLD}'
    path = command.folder / "old.py"
    path.write_bytes(text.encode("latin-1"))
    command("old.py", "--write")
    assert path.read_bytes() == f'# -*- coding: latin-1 -*-\nname = "Größe"\n{NEW}'.encode("latin-1")


def test_what_python_cannot_read_is_not_touched(command: Command) -> None:
    broken = f"{OLD}print 'x'\n"
    path = command.write("old.py", broken)
    done = command("old.py", "--write")
    assert path.read_text() == broken
    assert done.code == 1
    assert "syntax-error" in done.out


def test_unknown_versions_and_files_are_said(command: Command) -> None:
    command.write("old.py", OLD)
    assert "not a Blender version" in command("old.py", "--to", "five").err
    assert command("old.py", "--to", "2.49").code == 2
    assert "There is no file" in command("none.py").err


def test_run_compares_the_scenes(command: Command) -> None:
    command.write("old.py", f"{OLD}bpy.ops.mesh.primitive_cube_add(radius=2)\n")
    done = command("old.py", "--run", "--json")
    (run,) = json.loads(done.out)["runs"]
    assert run["after"]["error"] == ""
    assert run["before"] is None


def test_run_tells_where_the_new_code_fails(command: Command) -> None:
    command.write("old.py", "import bpy\n\nraise RuntimeError('no')\n")
    (run,) = json.loads(command("old.py", "--run", "--json").out)["runs"]
    assert run["after"]["error"] == "RuntimeError: no (old.py:3)"


def test_run_registers_an_addon(command: Command) -> None:
    code = "import bpy\nclass A(bpy.types.Operator):\n    bl_idname = 'a.b'\n    bl_label = 'A'\n"
    code += "def register():\n    bpy.utils.register_class(A)\ndef unregister():\n    bpy.utils.unregister_class(A)\n"
    command.write("addon/__init__.py", code)
    done = command("addon", "--run")
    assert "addon: Runs in Blender" in done.out
    assert done.code == 0
