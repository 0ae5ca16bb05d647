"""The checker and pyright, asked the same: each finds what it can know, at its line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.stubs.package import write_folder
from measurements.planted import Planted
from measurements.pyright import Errors, OwnCheck, Pyright, judge, lay_out, own_scripts

if TYPE_CHECKING:
    from pathlib import Path

RIGHT = "import bpy\nscene = bpy.context.scene\n{}\n"
ORIGINAL = RIGHT.format("scene.frame_start")
MISTAKES = [
    Planted("attribute", "a.py", RIGHT.format("scene.frame_strat"), 3, "scene.frame_strat"),
    Planted("attribute", "a.py", ORIGINAL, 3, "nothing is wrong here"),
]


def lines(errors: Errors) -> dict[str, list[int]]:
    return {name: [error.first for error in held] for name, held in errors.items() if held}


@pytest.fixture
def scripts(tmp_path: Path) -> Path:
    """One that is right, and one whose second line is not."""
    lay_out(
        tmp_path / "scripts", [("sub/a.py", ORIGINAL), ("b.py", "import bpy\nbpy.context.scene.nothing\n")]
    )
    return tmp_path / "scripts"


def test_errors_are_counted_proven_and_found(base: Path, scripts: Path) -> None:
    row = judge(OwnCheck(base), [scripts], {("b.py", 2)}, MISTAKES, {"a.py": ORIGINAL})
    assert row.sets == [(2, 1, 1)]
    assert (row.found, row.planted) == (1, 2)


def test_pyright_tells_the_same_by_the_stubs(base: Path, scripts: Path, tmp_path: Path) -> None:
    write_folder(base, tmp_path / "typings")
    expected = {"b.py": [2]}
    assert lines(OwnCheck(base).errors(scripts)) == expected
    assert lines(Pyright(tmp_path / "typings").errors(scripts)) == expected


def test_own_scripts_are_those_that_run_in_blender() -> None:
    names = [name for name, _ in own_scripts()]
    assert "kb_check/migrate/inside/run_script.py" in names
    assert all("/inside/" in name for name in names)
    assert len(names) == len(set(names))
