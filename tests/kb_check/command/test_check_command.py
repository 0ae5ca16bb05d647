"""The command as it is run: what it prints, how it ends, and what it leaves of the files."""

from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING, Any

import pytest
from checking import RIGHT, SIMWORLDS, WRONG
from hostile_text import HOSTILE, on_terminal, steering

if TYPE_CHECKING:
    from pathlib import Path

    from checking import Command

# Places and words


def test_a_finding_is_shown_with_its_line_and_its_fix(command: Command) -> None:
    command.write("a.py", WRONG)
    done = command.as_process("a.py")
    lines = done.out.splitlines()
    assert lines[0].startswith(
        "a.py:2:20: error[unknown-attribute] `bpy.types.Object.draw_type` does not exist"
    )
    assert lines[1:4] == [
        '  2 | bpy.context.object.draw_type = "WIRE"',
        "    |                    ^^^^^^^^^",
        "  help: Write display_type (--fix)",
    ]
    assert lines[-2].endswith(": 1 error in 1 file.")
    assert (done.code, done.err) == (1, "")


def test_nothing_found_is_said(command: Command) -> None:
    command.write("a.py", RIGHT)
    done = command()
    assert done.out.startswith("1 file checked for Blender ")
    assert done.out.endswith(": nothing found.\n")
    assert (done.code, done.err) == (0, "")


def test_markers_stand_below_wide_letters_and_tabs(command: Command) -> None:
    command.write("a.py", "import bpy\nif 1:\n\tx = '\u7269\u4f53', bpy.context.object.draw_type\n")
    shown, marker = command().out.splitlines()[1:3]
    assert marker.index("^") - marker.index("|") == shown.index("draw_type") - shown.index("|") + 2


def test_a_long_line_is_cut_around_the_marker(command: Command) -> None:
    command.write("a.py", f"import bpy\nx = '{'a' * 5_000}', bpy.context.object.draw_type, '{'b' * 5_000}'\n")
    shown, marker = command().out.splitlines()[1:3]
    assert len(shown) < 150
    assert shown[marker.index("^") :].startswith("draw_type")


def test_places_in_notebooks_are_those_of_cells(command: Command, base: Path) -> None:
    cells = [
        {"cell_type": "code", "source": ["%pylab\n", "import bpy"]},
        {"cell_type": "code", "source": WRONG},
    ]
    before = json.dumps({"cells": cells}).encode()
    command.write("a.ipynb", before)
    assert command().out.startswith("a.ipynb:cell 2:2:20: error[unknown-attribute]")
    (finding,) = command("--json").json["findings"]
    assert (finding["cell"], finding["line"]) == (2, 2)
    assert "file=a.ipynb,title" in command("--github").out
    several = "--blender", f"2.90,{base.stem.removeprefix('blender-')}"
    (command.home / "kb" / "blender-2.90.sqlite").symlink_to(base)
    told = command(*several).out
    assert "a.ipynb:cell 2:2:20: in " in told
    assert "first at a.ipynb:cell 2:2." in told
    (broken,) = command(*several, "--json").json["breaks"]
    assert (broken["cell"], broken["line"], broken["column"]) == (2, 2, 20)
    assert command("--fix").code == 1
    assert command.read("a.ipynb") == before


# Machines


def test_json_has_everything(command: Command) -> None:
    command.write("b/a.py", WRONG)
    document = command("--json").json
    assert (document["format"], document["files"], document["errors"]) == (1, 1, 1)
    (finding,) = document["findings"]
    assert (finding["line"], finding["column"], finding["end_line"], finding["end_column"]) == (2, 20, 2, 29)
    assert finding["symbol"] == "bpy.types.Object.draw_type"
    assert finding["instead"] == ["bpy.types.Object.display_type"]
    edit = {"line": 2, "column": 20, "end_line": 2, "end_column": 29, "text": "display_type"}
    assert finding["fix"] == {"title": "Write display_type", "sure": True, "edits": [edit]}


def test_sarif_has_what_its_schema_requires(command: Command) -> None:
    command.write("a b/é.py", WRONG)
    document = command("--sarif", ".", "nothing").json
    assert document["version"] == "2.1.0"
    assert document["$schema"].endswith("sarif-schema-2.1.0.json")
    (run,) = document["runs"]
    rules = run["tool"]["driver"]["rules"]
    assert {rule["defaultConfiguration"]["level"] for rule in rules} <= {"error", "warning", "note"}
    assert all(rule["shortDescription"]["text"] and rule["help"]["text"] for rule in rules)
    (result,) = run["results"]
    assert rules[result["ruleIndex"]]["id"] == result["ruleId"] == "unknown-attribute"
    location: dict[str, Any] = result["locations"][0]["physicalLocation"]
    assert location["artifactLocation"] == {"uri": "a%20b/%C3%A9.py", "index": 0}
    assert run["artifacts"][0]["location"]["uri"] == "a%20b/%C3%A9.py"
    region = {"startLine": 2, "startColumn": 20, "endLine": 2, "endColumn": 29}
    assert location["region"] == region
    replacement = result["fixes"][0]["artifactChanges"][0]["replacements"][0]
    assert replacement == {"deletedRegion": region, "insertedContent": {"text": "display_type"}}
    (invocation,) = run["invocations"]
    assert invocation["executionSuccessful"] is False
    assert "nothing" in invocation["toolExecutionNotifications"][0]["message"]["text"]


def test_annotations_cannot_be_forged(command: Command) -> None:
    command.write("a,b:%.py", 'import bpy\nbpy.context.scene.render.engine = "A\\n::error::B%"\n')
    done = command("--github")
    (line,) = done.out.splitlines()
    assert line.startswith("::error file=a%2Cb%3A%25.py,line=2,endLine=2,col=35,endColumn=")
    assert ",title=unknown-value::" in line
    assert done.code == 1


# Ends


def test_what_cannot_be_checked_ends_with_2(command: Command) -> None:
    command.write("a.py", RIGHT)
    (command.folder / "empty").mkdir()
    done = command("a.py", "nothing.py", "empty")
    assert done.code == 2
    assert "1 file checked" in done.out
    assert done.err == (
        "Error: There is no file or folder nothing.py.\nError: There are no Python files in empty.\n"
    )


def test_without_a_base_the_way_to_one_is_said(command: Command) -> None:
    done = command("--blender", "4.0")
    assert done.code == 2
    assert "simworlds kb build 4.0" in done.err
    assert "Traceback" not in done.err


@pytest.mark.parametrize(
    "arguments",
    [
        ["--fix", "--diff"],
        ["--json", "--sarif"],
        ["--github", "--json"],
        ["--diff", "--json"],
        ["--unsafe-fixes"],
        ["--rules", "nothing"],
        ["--rules", ""],
        ["--explain", "nothing"],
        ["--jobs", "0"],
        ["-", "--fix", "."],
        ["--stdin-filename", "a.py", "."],
        [""],
        ["--blender", ","],
        ["--blender", "4.5", "--blender", "5.1", "--fix"],
        ["--blender", "4.5,5.1", "--fix"],
        ["--blender", "4.5,5.1", "--github"],
        ["--blender", "x,y"],
    ],
)
def test_wrong_options_are_told(command: Command, arguments: list[str]) -> None:
    done = command(*arguments)
    assert done.code == 2
    assert "Error: " in done.err


def test_several_versions_of_a_file_are_said_to_be_its(command: Command) -> None:
    place = command.write("pyproject.toml", '[tool.simworlds.check]\nblender = ["4.5", "5.1"]\n')
    done = command("--fix")
    assert done.err.endswith(
        f"Error: --fix is for one version, and {place} names several (4.5, 5.1). Give one, as --blender 5.1.\n"
    )


def test_what_is_excluded_is_told_and_not_called_good(command: Command, base: Path) -> None:
    (command.home / "kb" / "blender-2.90.sqlite").symlink_to(base)
    versions = f"2.90,{base.stem.removeprefix('blender-')}"
    place = command.write("pyproject.toml", '[tool.simworlds.check]\nexclude = ["vendor"]\n')
    command.write("vendor/a.py", WRONG)
    for name in ("vendor", "vendor/a.py"):
        for several in ([], ["--blender", versions]):
            done = command(name, *several)
            assert (done.code, done.out) == (0, "")
            assert done.err == f"Warning: {name} was left out: {place} excludes it.\n"


def test_a_path_that_is_not_there_is_good_in_no_version(command: Command, base: Path) -> None:
    (command.home / "kb" / "blender-2.90.sqlite").symlink_to(base)
    versions = ("--blender", f"2.90,{base.stem.removeprefix('blender-')}")
    done = command("nothing.py", *versions)
    assert (done.code, done.out) == (2, "")
    assert command("nothing.py", "--json", *versions).json["runs_in"] == []


def test_a_rule_is_explained(command: Command) -> None:
    assert "\nsyntax-error            error    Code that Python cannot read\n" in command("--list-rules").out
    done = command("--explain", "syntax-error")
    assert done.out.startswith("# syntax-error\n\nCode that Python cannot read: error.\n")
    assert "```python\nprint" in done.out
    assert done.code == 0


def test_severities_decide_how_it_ends(command: Command) -> None:
    command.write("a.py", WRONG)
    command.write("pyproject.toml", '[tool.simworlds.check]\nseverity = { unknown-attribute = "warning" }\n')
    assert command().code == 0
    command.write("pyproject.toml", '[tool.simworlds.check]\nfail-on = "warning"\n')
    assert command().code == 1
    command.write("pyproject.toml", "[tool.simworlds.check]\nrule = 1\n")
    assert command().code == 2


def test_rules_can_be_chosen(command: Command) -> None:
    command.write("a.py", f"{WRONG}bpy.ops.mesh.nothing()\n")
    assert command("--json", "--rules", "unknown-operator").places == [("a.py", 3, "unknown-operator")]


def test_several_versions_are_a_table(command: Command, base: Path) -> None:
    (command.home / "kb" / "blender-2.90.sqlite").symlink_to(base)
    versions = f"2.90,{base.stem.removeprefix('blender-')}"
    command.write("a.py", WRONG)
    done = command("--blender", versions)
    assert done.out.splitlines()[1].split() == ["a.py", "1", "1"]
    assert done.code == 1
    assert command("--blender", versions, "--json").json["runs_in"] == []
    command.write("a.py", RIGHT)
    assert command("--blender", versions).code == 0


# Input


def test_standard_input_is_checked(command: Command) -> None:
    assert command.as_process("-", "--json", given=WRONG.encode()).places == [
        ("<stdin>", 2, "unknown-attribute")
    ]
    diff = command("-", "--diff", given=WRONG.encode()).out
    assert '+bpy.context.object.display_type = "WIRE"' in diff


def test_standard_input_is_checked_as_a_file_of_its_package(command: Command) -> None:
    command.write("addon/__init__.py", "import bpy\nbpy.types.Scene.mine = bpy.props.IntProperty()\n")
    command.write("addon/ui.py", "broken(")
    for name in ("addon/ui.py", "addon/new.py"):
        typed = f"{WRONG}bpy.context.scene.mine = 1\n".encode()
        done = command("--json", "--stdin-filename", name, given=typed)
        assert done.places == [(name, 2, "unknown-attribute")]
    assert command("-", "--stdin-filename", "a.ipynb", given=b"{}").out.startswith("a.ipynb:1:1: error")


def test_the_mended_text_of_standard_input_is_printed(command: Command) -> None:
    command.write("pyproject.toml", '[tool.simworlds.check]\nexclude = ["vendor"]\n')
    typed = WRONG.replace("\n", "\f\r\n").encode()
    done = command("-", "--fix", given=typed)
    assert done.out.encode() == RIGHT.replace("\n", "\f\r\n").encode()
    assert done.err.startswith("Mended: 1 finding.\n")
    assert done.code == 0
    excluded = command("--stdin-filename", "vendor/a.py", "--fix", given=typed)
    assert (excluded.code, excluded.out.encode()) == (0, typed)


def test_pipes_are_checked_and_not_written(command: Command) -> None:
    pipe = ("sh", "-c", 'printf "%s" "$1" | { shift; "$@"; }', "sh", WRONG)
    done = subprocess.run(
        [*pipe, *SIMWORLDS, "check", "/dev/stdin", "--fix"],
        env=command.environment,
        cwd=command.folder,
        capture_output=True,
        check=False,
        text=True,
    )
    assert "/dev/stdin cannot be written: it is not a file." in done.stderr
    assert done.stdout.startswith("Mended: 1 finding.")


def test_what_a_package_registers_may_be_used_in_all_of_it(command: Command) -> None:
    command.write("addon/__init__.py", "import bpy\nbpy.types.Scene.mine = bpy.props.IntProperty()\n")
    command.write("addon/ui/panel.py", "import bpy\nbpy.context.scene.mine = 1\n")
    command.write("other.py", "import bpy\nbpy.context.scene.mine = 1\n")
    assert command("--json", "addon/ui/panel.py").places == []
    assert command("--json").places == [("other.py", 2, "unknown-attribute")]


def test_what_a_package_registers_its_projects_tests_may_use(command: Command) -> None:
    command.write("pyproject.toml", "")
    command.write("addon/__init__.py", "import bpy\nbpy.types.Scene.mine = bpy.props.IntProperty()\n")
    command.write(
        "tests/test_mine.py",
        "import bpy\nimport addon\nbpy.context.scene.mine = 1\nbpy.context.scene.other\n",
    )
    command.write("tests/test_other.py", "import bpy\nbpy.context.scene.mine = 1\n")
    expected = [
        ("tests/test_mine.py", 4, "unknown-attribute"),
        ("tests/test_other.py", 2, "unknown-attribute"),
    ]
    assert command("--json").places == expected
    assert command("--json", "tests").places == expected


def test_what_a_broken_file_may_register_is_not_missed(command: Command) -> None:
    command.write(
        "addon/__init__.py", "import bpy\ndef register():\n    bpy.types.Scene.mine = 1\n    print 'x'\n"
    )
    command.write("addon/panel.py", "import bpy\nbpy.context.scene.mine = 1\nbpy.context.scene.other\n")
    assert command("--json").places == [
        ("addon/__init__.py", 4, "syntax-error"), ("addon/panel.py", 3, "unknown-attribute")
    ]  # fmt: skip


def test_a_python_2_script_is_said_to_be_one_and_checked(command: Command) -> None:
    command.write("a.py", "import bpy\nprint 'x'\nob = bpy.context.object\nob.draw_type = 'WIRE'\n")
    done = command("--json")
    assert done.places == [("a.py", 2, "syntax-error"), ("a.py", 4, "unknown-attribute")]
    assert "Python 2" in done.json["findings"][0]["message"]


@pytest.mark.parametrize(
    ("content", "rule"),
    [
        (b"x = '\xe9'\n", "syntax-error"),
        (b"a\0b\n", "syntax-error"),
        (b"(" * 5_000, "syntax-error"),
        (b"x = " + b"-" * 100_000 + b"1", "syntax-error"),
        (b"# coding: none\n", "syntax-error"),
        ("x = 1\n".encode("utf-16"), "syntax-error"),
        (b"BLENDER-v501\0\xff(\n", "syntax-error"),
    ],
)
def test_bad_files_are_a_finding(command: Command, content: bytes, rule: str) -> None:
    command.write("a.py", content)
    done = command("--json")
    assert [found for _, _, found in done.places] == [rule]
    assert done.err == ""


def test_a_null_byte_is_reported_where_it_stands(command: Command) -> None:
    command.write("a.py", b"import bpy\r\nx = \0 1\r\nbpy.context.object.draw_type\r\n")
    done = command("--json")
    assert done.places == [("a.py", 2, "syntax-error"), ("a.py", 3, "unknown-attribute")]
    assert done.json["findings"][0]["column"] == 5


def test_a_file_that_cannot_be_read_is_told(command: Command) -> None:
    command.write("a.py", b"#" * ((16 << 20) + 1))
    command.write("b.py", WRONG)
    command.write("c.py", b"x\n" * 1_000_001)
    done = command("--json")
    assert done.code == 2
    assert "a.py cannot be read: it is larger than 16 MiB" in done.err
    assert (
        "c.py was not checked: it has 2,000,002 characters, and no more than 2,000,000 are read" in done.err
    )
    assert done.json["files"] == 1
    assert done.json["unchecked"]
    assert len(done.places) == 1


def test_files_that_import_each_other_end(command: Command) -> None:
    command.write("p/__init__.py", "from . import a\n")
    command.write("p/a.py", "from . import b, a\nfrom .b import *\nx = b.x\n")
    command.write("p/b.py", "from . import a\nfrom .a import x\nx = a.x\n")
    assert command().code == 0


# Fixes


def test_a_fix_keeps_what_it_does_not_change(command: Command) -> None:
    command.write("bom.py", b"\xef\xbb\xbf" + WRONG.replace("\n", "\r\n").encode())
    command.write("latin.py", f"# coding: latin-1\n# \xe9\n{WRONG}".encode("latin-1"))
    done = command("--fix")
    assert done.code == 0
    assert "Mended: 2 findings." in done.out
    assert command.read("bom.py") == b"\xef\xbb\xbf" + RIGHT.replace("\n", "\r\n").encode()
    assert command.read("latin.py") == f"# coding: latin-1\n# \xe9\n{RIGHT}".encode("latin-1")


def test_a_diff_changes_nothing(command: Command) -> None:
    command.write("a.py", WRONG)
    done = command("--diff")
    assert done.out.splitlines()[:2] == ["--- a.py", "+++ a.py"]
    assert done.code == 1
    assert command.read("a.py") == WRONG.encode()


def test_a_diff_for_a_program_is_what_the_file_holds(command: Command) -> None:
    command.write("a.py", f"# coding: latin-1\r\n# \xe9\x0c\r\n{WRONG}".encode("latin-1"))
    printed = command.bytes_of("--diff", "a.py")
    assert b"\n # coding: latin-1\r\n # \xe9\x0c\r\n import bpy\n" in printed


def test_unsure_fixes_are_applied_only_when_wanted(command: Command) -> None:
    command.write("a.py", "import bpy\nbpy.context.object.locatoin.x = 1\n")
    assert "\n--fix --unsafe-fixes mends 1 finding." in command("--fix").out
    assert b"locatoin" in command.read("a.py")
    assert command("--fix", "--unsafe-fixes").code == 0
    assert b"object.location.x" in command.read("a.py")


def test_what_cannot_be_parsed_is_not_mended(command: Command) -> None:
    before = f"{WRONG}print 'x'\n"
    command.write("a.py", before)
    done = command("--fix")
    assert "--fix" not in done.out
    assert command.read("a.py") == before.encode()


def test_other_files_of_a_package_are_not_mended(command: Command) -> None:
    for name in ("__init__", "a", "b"):
        command.write(f"p/{name}.py", WRONG)
    command("--fix", "p/a.py")
    assert command.read("p/a.py") == RIGHT.encode()
    assert command.read("p/b.py") == WRONG.encode()


# Runs


def test_a_second_run_finds_the_same_from_the_cache(command: Command) -> None:
    for number in range(5):
        command.write(f"{number}.py", WRONG)
    first = command("--json")
    assert (command.home / "cache" / "check.sqlite").is_file()
    assert command("--json").out == first.out
    command.write("3.py", RIGHT)
    assert [path for path, _, _ in command("--json").places] == ["0.py", "1.py", "2.py", "4.py"]


def test_several_processes_find_what_one_does(command: Command) -> None:
    for number in range(12):
        command.write(f"{number}.py", WRONG + f"# {number} {'x' * 100}\n" * 500)
    one = command("--json", "--no-cache", "--jobs", "1")
    assert command.as_process("--json", "--no-cache", "--jobs", "3").out == one.out
    assert len(one.places) == 12


def test_nothing_in_a_file_steers_the_terminal(command: Command) -> None:
    code = f"import bpy\nx = '''{HOSTILE}'''; bpy.context.object.draw_type\nbpy.ops.mesh.x(a='{HOSTILE}')\n"
    command.write("\x1b[31mevil.py", code)
    for form in ([], ["--json"], ["--github"], ["--sarif"]):
        assert not steering(command(*form).out)
    printed = on_terminal([*SIMWORLDS, "check", str(command.folder)], command.environment)
    assert "draw_type" in printed
    assert not steering(printed, is_terminal=True)


def test_no_diff_steers_the_terminal(command: Command) -> None:
    command.write("\x1b[31mevil.py", f"{WRONG}x = '''{HOSTILE}'''\n")
    printed = on_terminal([*SIMWORLDS, "check", "--diff", str(command.folder)], command.environment)
    assert "display_type" in printed
    assert not steering(printed, is_terminal=True)


def test_a_terminal_has_colours(command: Command) -> None:
    path = command.write("a.py", WRONG)
    printed = on_terminal([*SIMWORLDS, "check", str(path)], command.environment)
    assert "\x1b[1;31merror[unknown-attribute]\x1b[0m" in printed
