"""The stubs of this environment's Blender, as pyright reads them, and as files and wheels."""

from __future__ import annotations

import ast
import base64
import hashlib
import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from kb_check.stubs.cli import stubs as command
from kb_check.stubs.modules import MARK
from kb_check.stubs.package import OutputInTheWay, write_folder, write_wheel

SAMPLES = Path(__file__).parent
# Modules written from docstrings, operators, and what all stubs share.
SOME = (
    "mathutils-stubs",
    "bmesh-stubs",
    "bpy-stubs/ops/mesh.pyi",
    "bpy-stubs/_typing.pyi",
    "bpy-stubs/__init__.pyi",
)


@pytest.fixture(scope="module")
def folder(base: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    target = tmp_path_factory.mktemp("project") / "typings"
    write_folder(base, target, with_docs=True)
    return target


def reported(project: Path, *include: str) -> list[dict[str, Any]]:
    """What pyright reports of these files of a project."""
    settings = {
        "include": list(include),
        "typeCheckingMode": "standard",
        "reportMissingModuleSource": False,
        # The samples only mention things.
        "reportUnusedExpression": False,
        # Scripts return a set of literals without saying so.
        "reportIncompatibleMethodOverride": False,
    }
    (project / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-m", "pyright", "--project", str(project), "--outputjson"],
        capture_output=True,
        text=True,
        check=False,
    )
    told = json.loads(done.stdout)
    assert told["summary"]["filesAnalyzed"] >= len(include)
    return told["generalDiagnostics"]


@pytest.fixture(scope="module")
def found(folder: Path) -> list[dict[str, Any]]:
    """What pyright reports of the samples, and of stubs that take little time."""
    samples = [Path(shutil.copy(sample, folder.parent)).name for sample in SAMPLES.glob("sample_*.py")]
    return reported(folder.parent, *samples, *(f"typings/{name}" for name in SOME))


def lines_in(found: list[dict[str, Any]], name: str) -> dict[int, str]:
    return {
        entry["range"]["start"]["line"] + 1: entry["message"]
        for entry in found
        if Path(entry["file"]).name == name and entry["severity"] == "error"
    }


def of_stubs(found: list[dict[str, Any]]) -> list[tuple[str, dict[str, int], str]]:
    return [
        (entry["file"], entry["range"]["start"], entry["message"])
        for entry in found
        if entry["file"].endswith(".pyi")
    ]


def test_some_stubs_have_no_errors(found: list[dict[str, Any]], folder: Path) -> None:
    assert all((folder / name).exists() for name in SOME)
    assert of_stubs(found) == []


@pytest.mark.whole
def test_the_stubs_themselves_have_no_errors(folder: Path) -> None:
    assert of_stubs(reported(folder.parent, "typings")) == []


def test_right_code_is_right(found: list[dict[str, Any]]) -> None:
    assert lines_in(found, "sample_right.py") == {}


def test_each_wrong_line_is_found(found: list[dict[str, Any]]) -> None:
    text = (SAMPLES / "sample_wrong.py").read_text(encoding="utf-8")
    wrong = {number for number, line in enumerate(text.splitlines(), 1) if line.endswith("# wrong")}
    assert set(lines_in(found, "sample_wrong.py")) == wrong


def test_a_missing_socket_says_so(found: list[dict[str, Any]]) -> None:
    assert any("NoSuchSocket" in message for message in lines_in(found, "sample_wrong.py").values())


def test_every_file_is_python(folder: Path) -> None:
    files = list(folder.rglob("*.pyi"))
    assert len(files) > 100
    for file in files:
        ast.parse(file.read_text(encoding="utf-8"))


def test_every_class_is_written(folder: Path, base: Path) -> None:
    from kb_check.stubs.package import read_symbols

    text = (folder / "bpy-stubs" / "types.pyi").read_text(encoding="utf-8")
    written = {node.name for node in ast.parse(text).body if isinstance(node, ast.ClassDef)}
    _, symbols = read_symbols(base)
    assert written == {
        symbol.name for symbol in symbols if symbol.kind == "class" and symbol.owner == "bpy.types"
    }


def test_every_package_is_marked_as_written_here(folder: Path) -> None:
    packages = list(folder.glob("*-stubs"))
    assert "_bpy_internal-stubs" in {
        package.name for package in packages
    }  # it has modules, and nothing itself
    for package in packages:
        assert (package / "__init__.pyi").read_text(encoding="utf-8").startswith(MARK), package.name


def test_writes_again_over_its_own(small_base: Path, tmp_path: Path) -> None:
    write_folder(small_base, tmp_path)
    stale = tmp_path / "bpy-stubs" / "former" / "stale.pyi"
    stale.parent.mkdir()
    stale.write_text(f"{MARK}\n", encoding="utf-8")
    mine = tmp_path / "bpy-stubs" / "mine.pyi"
    mine.write_text("y: int\n", encoding="utf-8")
    other = tmp_path / "other-stubs"
    other.mkdir()
    write_folder(small_base, tmp_path)
    assert not stale.parent.exists()
    assert mine.read_text(encoding="utf-8") == "y: int\n"
    assert other.is_dir()
    assert (tmp_path / "bpy-stubs" / "__init__.pyi").read_text(encoding="utf-8").startswith(MARK)


def test_never_replaces_a_file_that_was_written_by_hand(small_base: Path, tmp_path: Path) -> None:
    write_folder(small_base, tmp_path)
    mine = tmp_path / "bpy-stubs" / "types.pyi"
    mine.write_text("class Mine: ...\n", encoding="utf-8")
    with pytest.raises(OutputInTheWay, match=r"types\.pyi is there"):
        write_folder(small_base, tmp_path)
    assert mine.read_text(encoding="utf-8") == "class Mine: ...\n"


@pytest.mark.parametrize("text", [None, "", "# somebody else's\n"])
def test_never_replaces_what_others_wrote(small_base: Path, tmp_path: Path, text: str | None) -> None:
    package = tmp_path / "bpy-stubs"
    package.mkdir()
    if text is not None:
        (package / "__init__.pyi").write_text(text, encoding="utf-8")
    with pytest.raises(OutputInTheWay, match="bpy-stubs"):
        write_folder(small_base, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["bpy-stubs"]


def test_a_wheel_installs(small_base: Path, tmp_path: Path) -> None:
    wheel, written = write_wheel(small_base, tmp_path / "dist")
    assert wheel.name == f"simworlds_bpy_stubs-{written.blender}-py3-none-any.whl"
    with zipfile.ZipFile(wheel) as archive:
        record = archive.read(f"simworlds_bpy_stubs-{written.blender}.dist-info/RECORD").decode()
        for line in record.splitlines()[:-1]:
            name, digest, size = line.rsplit(",", 2)
            data = archive.read(name)
            expected = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            assert (digest, int(size)) == (f"sha256={expected}", len(data)), name
    again, _ = write_wheel(small_base, tmp_path / "again")
    assert again.read_bytes() == wheel.read_bytes()
    target = tmp_path / "installed"
    install = ["uv", "pip", "install", "--offline", "--no-deps", "--target", str(target), str(wheel)]
    subprocess.run([sys.executable, "-m", *install], check=True, capture_output=True)
    assert (target / "bpy-stubs" / "types.pyi").is_file()


def test_the_command_writes_and_says_what(small_base: Path, tmp_path: Path) -> None:
    result = CliRunner().invoke(command, ["--base", str(small_base), "--out", str(tmp_path / "typings")])
    assert result.exit_code == 0, result.output
    assert "files" in result.output
    assert (tmp_path / "typings" / "bpy-stubs" / "ops" / "mesh.pyi").is_file()


def test_the_command_says_what_is_missing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path))
    result = CliRunner().invoke(command, ["5.1", "--out", str(tmp_path / "typings")])
    assert result.exit_code == 2
    assert "simworlds kb build 5.1" in result.output
    broken = tmp_path / "broken.sqlite"
    broken.write_bytes(b"no base")
    for base, said in (
        (broken, "not readable as a knowledge base"),
        (tmp_path / "none", "no knowledge base here"),
    ):
        result = CliRunner().invoke(command, ["--base", str(base), "--out", str(tmp_path / "typings")])
        assert result.exit_code == 2
        assert result.output.startswith(f"Error: {base}: ")
        assert said in result.output


def test_the_command_takes_one_base_and_names_a_place_that_is_no_folder(
    small_base: Path, tmp_path: Path
) -> None:
    both = CliRunner().invoke(command, ["5.1", "--base", str(small_base), "--out", str(tmp_path)])
    assert both.exit_code == 2
    assert "exclude each other" in both.output
    (tmp_path / "file").touch()
    result = CliRunner().invoke(command, ["--base", str(small_base), "--out", str(tmp_path / "file" / "x")])
    assert result.exit_code == 2
    assert "cannot be written: Not a directory" in result.output
