"""Which files are checked, and which of them belong together."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from kb_check.command import gitignore
from kb_check.command.files import find_files

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    top = tmp_path / "project"
    for name in (
        "pyproject.toml", "loose.py", "note.ipynb", "text.txt", ".hidden.py", ".git/a.py", "env/pyvenv.cfg", "env/a.py",
        "node_modules/a.py", "__pycache__/a.py", "addon/__init__.py", "addon/a.py", "addon/sub/b.py", "addon/c.ipynb",
        "extension/blender_manifest.toml", "extension/d.py", "scripts/e.py", "scripts/f.py",
    ):  # fmt: skip
        path = top / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return top


def groups(top: Path, *paths: str, exclude: tuple[str, ...] = ()) -> list[list[str]]:
    """The groups as sorted names; those that are only read stand in brackets."""
    found = find_files([top / path for path in paths or (".",)], exclude, top)
    return sorted(
        sorted(
            name if file.wanted else f"({name})"
            for file in group.files
            for name in [os.path.relpath(file.path, top)]
        )
        for group in found.groups
    )


def test_packages_are_groups_and_loose_files_stand_alone(tree: Path) -> None:
    assert groups(tree) == [
        ["addon/__init__.py", "addon/a.py", "addon/sub/b.py"],
        ["addon/c.ipynb"],
        ["extension/d.py"],
        ["loose.py"],
        ["note.ipynb"],
        ["scripts/e.py"],
        ["scripts/f.py"],
    ]


def test_of_one_file_of_a_package_the_others_are_read_too(tree: Path) -> None:
    assert groups(tree, "addon/sub/b.py") == [["(addon/__init__.py)", "(addon/a.py)", "addon/sub/b.py"]]


@pytest.mark.parametrize(
    ("name", "code"),
    [
        ("loose.py", "import addon.sub as sub"),
        ("scripts/e.py", "    from addon import a"),
        ("scripts/f.py", 'bpy.ops.preferences.addon_enable(module="addon")'),
        ("extension/d.py", "import addon"),
        ("note.ipynb", '{"cells": [{"cell_type": "code", "source": "import addon"}]}'),
    ],
)
def test_what_uses_a_package_of_its_project_is_read_with_it(tree: Path, name: str, code: str) -> None:
    (tree / name).write_text(code)
    package = ["addon/__init__.py", "addon/a.py", "addon/sub/b.py"]
    assert sorted([*package, name]) in groups(tree)
    assert sorted([*(f"({path})" for path in package), name]) in groups(tree, name)


def test_packages_are_also_looked_for_in_src(tree: Path) -> None:
    (tree / "src").mkdir()
    (tree / "addon").rename(tree / "src/addon")
    (tree / "loose.py").write_text("import addon")
    package = ["(src/addon/__init__.py)", "(src/addon/a.py)", "(src/addon/sub/b.py)"]
    assert groups(tree, "loose.py") == [[*package, "loose.py"]]


def test_packages_of_no_project_and_of_environments_are_not_read_along(tree: Path) -> None:
    (tree / "loose.py").write_text("import addon")
    (tree / "env/a.py").write_text("import b")
    (tree / "env/b").mkdir()
    (tree / "env/b/__init__.py").touch()
    assert groups(tree, "env/a.py") == [["env/a.py"]]
    _without_project(tree)
    assert groups(tree, "loose.py") == [["loose.py"]]


def _without_project(tree: Path) -> None:
    (tree / "pyproject.toml").unlink()
    (tree / ".git/a.py").unlink()
    (tree / ".git").rmdir()


@pytest.mark.parametrize("code", ["from addon import a", 'addon_utils.enable("addon")'])
def test_what_is_named_together_is_one_project(tree: Path, code: str) -> None:
    _without_project(tree)
    (tree / "scripts/e.py").write_text(code)
    package = ["addon/__init__.py", "addon/a.py", "addon/sub/b.py"]
    assert [*package, "scripts/e.py"] in groups(tree)
    assert groups(tree, "addon", "scripts/e.py") == [[*package, "scripts/e.py"], ["addon/c.ipynb"]]
    assert groups(tree, "scripts/e.py") == [["scripts/e.py"]]


def test_a_word_that_is_also_a_packages_name_joins_no_projects(tree: Path) -> None:
    _without_project(tree)
    (tree / "scripts/e.py").write_text("addon = 1\n")
    assert ["scripts/e.py"] in groups(tree)
    (tree / "scripts/e.py").write_text("import addon\n")
    (tree / "other/addon").mkdir(parents=True)
    (tree / "other/addon/__init__.py").touch()
    assert ["scripts/e.py"] in groups(tree)


@pytest.mark.parametrize("between", ["pytest-of-root", "open"])
def test_a_mark_in_somebody_elses_folder_makes_no_package(tmp_path: Path, between: str) -> None:
    """A stray file in a temporary folder, or above one that no module can have the name of."""
    inner = tmp_path / "above" / between / "scripts"
    inner.mkdir(parents=True)
    (tmp_path / "above" / between).chmod(0o1777 if between == "open" else 0o755)
    for path in (tmp_path / "above", tmp_path / "above" / between):
        (path / "__init__.py").touch()
    (inner / "a.py").touch()
    (inner / "b.py").touch()
    expected = [["a.py"]] if between == "open" else [["(../__init__.py)", "(b.py)", "a.py"]]
    assert groups(inner, "a.py") == expected


def test_what_is_named_twice_is_checked_once(tree: Path) -> None:
    (tree / "link.py").symlink_to("loose.py")
    assert groups(tree, "loose.py", "./loose.py", "link.py") == [["loose.py"]]


def test_links_to_folders_are_not_followed(tree: Path) -> None:
    (tree / "scripts" / "up").symlink_to("..")
    (tree / "self").symlink_to("self")
    assert len(groups(tree)) == 7
    assert find_files([tree / "self"]).faults == [f"There is no file or folder {tree / 'self'}."]


def test_links_to_files_are_not_followed(tree: Path) -> None:
    (tree / "scripts" / "link.py").symlink_to(tree / "addon" / "a.py")
    (tree / "addon" / "link.py").symlink_to(tree / "scripts" / "e.py")
    assert groups(tree, "scripts") == [["scripts/e.py"], ["scripts/f.py"]]
    assert groups(tree, "addon/a.py") == [["(addon/__init__.py)", "(addon/sub/b.py)", "addon/a.py"]]


def test_links_that_are_named_are_followed(tree: Path) -> None:
    (tree / "there").symlink_to("scripts")
    assert groups(tree, "there") == [["there/e.py"], ["there/f.py"]]


@pytest.mark.parametrize("pattern", ["scripts", "scripts/", "scripts/*", "*/?.py", "[ef].py"])
def test_patterns_leave_files_out(tree: Path, pattern: str) -> None:
    assert not [group for group in groups(tree, exclude=(pattern,)) if "scripts/e.py" in group]
    assert groups(tree, "scripts/e.py", exclude=(pattern,)) == []


def test_a_package_does_not_reach_beyond_its_project(tree: Path) -> None:
    (tree.parent / "__init__.py").touch()
    assert ["loose.py"] in groups(tree)


def test_what_has_nothing_to_check_is_said(tree: Path) -> None:
    (tree / "empty").mkdir()
    found = find_files([tree / "empty", tree / "nothing", tree / "loose.py"])
    assert found.faults == [
        f"There are no Python files in {tree / 'empty'}.",
        f"There is no file or folder {tree / 'nothing'}.",
    ]
    assert len(found.groups) == 1


def test_what_the_patterns_leave_out_is_told(tree: Path) -> None:
    found = find_files([tree / "scripts", tree / "loose.py", tree / "addon"], ("scripts/*", "loose.py"), tree)
    assert (found.excluded, found.faults) == ([tree / "scripts", tree / "loose.py"], [])


def test_what_git_leaves_out_whole_is_told(tree: Path) -> None:
    ignoring(tree, "*.py\n", "scripts")
    (fault,) = find_files([tree / "scripts"]).faults
    assert fault.startswith(f"Git leaves out all Python files in {tree / 'scripts'}.")


def test_pipes_are_read_where_they_are_named(tree: Path) -> None:
    os.mkfifo(tree / "scripts" / "pipe.py")
    assert groups(tree, "scripts") == [["scripts/e.py"], ["scripts/f.py"]]
    assert groups(tree, "scripts/pipe.py") == [["scripts/pipe.py"]]


def test_a_file_whose_content_is_given_need_not_be_there(tree: Path) -> None:
    found = find_files([tree / "addon" / "new.py"], unsaved=[tree / "addon" / "new.py"])
    assert tree / "addon" / "a.py" in {file.path for file in found.groups[0].files}


def ignoring(tree: Path, text: str, folder: str = ".") -> None:
    (tree / folder / ".gitignore").write_text(text)


def test_what_git_leaves_out_of_a_folder_is_left_out(tree: Path) -> None:
    ignoring(tree, "# made\nscripts/\n*.ipynb\n!/addon/c.ipynb\nloose*\n!loose.py\n")
    ignoring(tree, "/sub\n", "addon")
    assert groups(tree) == [
        ["(addon/sub/b.py)", "addon/__init__.py", "addon/a.py"],
        ["addon/c.ipynb"],
        ["extension/d.py"],
        ["loose.py"],
    ]
    found = find_files([tree], gitignore=False)
    assert {"e.py", "b.py", "note.ipynb"} <= {
        file.path.name for group in found.groups for file in group.files if file.wanted
    }


def test_what_is_named_is_checked_though_git_leaves_it_out(tree: Path) -> None:
    ignoring(tree, "*\n")
    assert groups(tree, "scripts") == [["scripts/e.py"], ["scripts/f.py"]]
    assert groups(tree, "loose.py") == [["loose.py"]]


def test_files_above_count_within_a_repository_only(tree: Path) -> None:
    ignoring(tree, "e.py\n")
    assert groups(tree, "scripts") == [["scripts/f.py"]]
    (tree / ".git" / "a.py").unlink()
    (tree / ".git").rmdir()
    assert groups(tree, "scripts") == [["scripts/e.py"], ["scripts/f.py"]]


@pytest.mark.parametrize(
    "text",
    ["!\n[z-a]\n\\\n[\n/\n//\n", "*a" * 40 + "b\n", "a/**/" * 40 + "b\n", "\x00\udcff\n", "a" * (1 << 12)],
)
def test_a_gitignore_of_any_kind_leaves_out_nothing_else(
    tree: Path, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(gitignore, "_MOST_CHARACTERS", 1 << 11)  # a million take long to compile
    (tree / ".gitignore").write_bytes(text.encode(errors="surrogateescape"))
    deep = tree / "/".join("a" * 60)
    deep.mkdir(parents=True)
    (deep / ("a" * 200 + ".py")).touch()
    assert len(groups(tree, "scripts", "a")) == 3
