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


def test_beside_a_diff_stderr_tells_what_is_left(command: Command) -> None:
    command.write("old.py", OLD + "bpy.context.object.layers[0] = True\n")
    done = command("old.py", "--diff")
    assert "layers` does not exist" not in done.out
    assert "old.py:3: error[unknown-attribute] `bpy.types.Object.layers` does not exist" in done.err
    assert "1 place to decide" in done.err


def test_the_diff_of_a_file_from_windows_can_be_applied(command: Command) -> None:
    command.write("old.py", OLD.replace("\n", "\r\n"))
    assert b'\r\n+bpy.context.object.display_type = "WIRE"\r\n' in command.bytes_of("old.py", "--diff")


def test_standard_input_is_printed_as_it_is_now(command: Command) -> None:
    old = f"# \xe9\r\n{OLD}bpy.context.object.layers\n"
    done = command("-", given=old.encode())
    assert done.code == 1
    assert "<stdin>:4: error[unknown-attribute]" in done.err
    assert command.bytes_of("-", given=old.encode()) == old.replace("draw_type", "display_type").encode()
    assert command("-", "--diff", given=old.encode()).out.startswith("--- <stdin>")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["-", "--write"], "goes with no other path"),
        (["-", "old.py"], "goes with no other path"),
        ([""], "It is empty"),
        (["old.py", "--diff", "--json"], "exclude each other"),
        (["old.py", "--from", "9.9"], "--from 9.9 is newer than"),
        (["old.py", "--keep", "4.2,9.8,9.9"], "--keep 9.8,9.9 is newer than"),
    ],
)
def test_what_contradicts_itself_is_refused(command: Command, arguments: list[str], told: str) -> None:
    path = command.write("old.py", OLD)
    done = command(*arguments)
    assert (done.code, done.out) == (2, "")
    assert told in done.err
    assert path.read_text() == OLD


def test_nothing_is_said_of_files_that_were_not_read(command: Command) -> None:
    (command.folder / "empty").mkdir()
    for option in ("--write", "--run"):
        done = command("none.py", "empty", option)
        assert (done.code, done.out) == (2, "")
    assert [one.name for one in command.folder.iterdir()] == ["empty"]


def test_what_the_project_excludes_is_left_out(command: Command) -> None:
    place = command.write("pyproject.toml", '[tool.simworlds.check]\nexclude = ["vendor"]\n')
    command.write("a.py", OLD)
    command.write("vendor/b.py", OLD)
    done = command(".", "--diff")
    assert (done.out.count("+++ "), "a.py" in done.out) == (1, True)
    named = command("vendor/b.py", "--diff")
    assert named.out == ""
    assert named.err.startswith(f"Warning: vendor/b.py was left out: {place} excludes it.\n")


def test_notebooks_stay_as_they_are_and_the_rest_is_migrated(command: Command) -> None:
    cells = [{"cell_type": "code", "source": [OLD]}]
    book = command.write("a/book.ipynb", json.dumps({"cells": cells}))
    command.write("a/empty.ipynb", json.dumps({"cells": []}))
    path = command.write("a/old.py", OLD)
    before = book.read_bytes()
    done = command("a", "--write")
    assert done.code == 1
    assert "a/book.ipynb is a notebook: migrate leaves it as it is." in done.out
    assert "1 change in 1 file; 2 notebooks left as they are." in done.out
    assert (book.read_bytes(), path.read_text()) == (before, NEW)
    assert "a/book.ipynb is a notebook" in (command.folder / "a" / "MIGRATION.md").read_text()


def test_a_report_of_somebody_else_is_not_replaced(command: Command) -> None:
    path = command.write("own/old.py", OLD)
    mine = command.write("own/MIGRATION.md", "# My own text\n")
    done = command("own", "--write")
    assert done.code == 2
    assert "Rename it" in done.err
    assert (path.read_text(), mine.read_text()) == (OLD, "# My own text\n")


def test_a_later_report_stands_above_the_earlier_one(command: Command) -> None:
    command.write("old.py", OLD)
    report = command.folder / "MIGRATION.md"
    command("old.py", "--write")
    first = report.read_text()
    command("old.py", "--write")
    second = report.read_text()
    assert second.endswith(f"\n{first}")
    assert "0 changes" in second
    command("old.py", "--write")
    assert report.read_text() == second


def test_what_breaks_in_a_kept_version_is_left_to_decide(command: Command) -> None:
    command.write("new.py", "import bpy\nbpy.data.node_groups[0].interface.new_socket('a')\n")
    (command.home / "kb" / "blender-4.9.sqlite").write_bytes(b"no base")
    done = command("new.py", "--keep", "3.6")
    assert done.code == 1
    assert (
        "new.py:2: in Blender 3.6: `bpy.types.NodeTree.interface` is there from Blender 4.0 on." in done.out
    )
    assert "1 place to decide; there is no base of 3.6" in done.out


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
