"""The extension's archive: what is in it, and that this environment's Blender can load all of it."""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
import tomllib
import zipfile
from typing import TYPE_CHECKING

import pytest
from click.testing import CliRunner

from agents.blender import extension
from agents.commands.extension import extension as command
from simworlds.releases import releases
from simworlds.sandbox.errors import NotInstalled
from simworlds.sandbox.runtime import environment_of_others, find_runtime
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from pathlib import Path

LOAD = """
import importlib, pkgutil, sys
import bpy
sys.path.insert(0, sys.argv[1])
import simworlds_live
names = [m.name for m in pkgutil.walk_packages(simworlds_live.__path__, "simworlds_live.")]
# Those that draw need a window, those of the sandbox's own programs are not called here.
skipped = {"simworlds_live.worker.attached.user.marks", "simworlds_live.worker.attached.user.show",
           "simworlds_live.worker.attached.calls", "simworlds_live.worker.attached.panel"}
for name in names:
    if name not in skipped:
        importlib.import_module(name)
foreign = [name for name in sys.modules if name.partition(".")[0] in {"simworlds", "agents"}]
from simworlds_live.worker.attached import user_state
from simworlds_live.worker.attached.code import undo_steps
from simworlds_live.worker.attached.files import structures
offset = structures.offset_of("Object", "loc")
import ctypes
made = bpy.data.objects.new("x", None)
made.location = 1, 2, 3
read = (ctypes.c_float * 3).from_address(made.as_pointer() + offset)[:]
before = undo_steps.digest()
made.location.x = 7
print(len(names) > 90, foreign, read, undo_steps.digest() != before)
"""


def test_the_same_code_makes_the_same_archive(tmp_path: Path) -> None:
    first, second = extension.build(tmp_path / "a"), extension.build(tmp_path / "b")
    assert first.read_bytes() == second.read_bytes()


def test_it_is_an_add_on_and_an_extension(tmp_path: Path) -> None:
    with zipfile.ZipFile(extension.build(tmp_path)) as archive:
        names = archive.namelist()
        manifest = tomllib.loads(archive.read(f"{extension.NAME}/blender_manifest.toml").decode())
        entry = ast.parse(archive.read(f"{extension.NAME}/__init__.py"))
    assert all(name.startswith(f"{extension.NAME}/") for name in names)
    assert manifest["blender_version_min"] == "4.2.0"
    assert manifest["id"] == extension.NAME
    assert len(manifest["tagline"]) <= 64
    for reason in manifest["permissions"].values():
        assert len(reason) <= 64
        assert not reason.endswith(".")
    info = next(node for node in entry.body if isinstance(node, ast.Assign))
    assert ast.literal_eval(info.value)["blender"] == (3, 4, 0)


def test_no_module_of_it_imports_by_the_projects_names(tmp_path: Path) -> None:
    with zipfile.ZipFile(extension.build(tmp_path)) as archive:
        for name in archive.namelist():
            if name.endswith(".py"):
                tree = ast.parse(archive.read(name))
                modules = [
                    node.module or ""
                    for node in ast.walk(tree)
                    if isinstance(node, ast.ImportFrom) and not node.level
                ]
                modules += [
                    alias.name
                    for node in ast.walk(tree)
                    if isinstance(node, ast.Import)
                    for alias in node.names
                ]
                assert not [module for module in modules if module.startswith(("simworlds", "agents"))], name


def test_imports_are_made_relative_from_any_depth() -> None:
    source = "from simworlds.sandbox.inside.refusal import Refused\n"
    assert extension.relocated(source, "worker/tag.py") == "from ..sandbox.refusal import Refused\n"
    assert extension.relocated(source, "worker/state/a.py") == "from ...sandbox.refusal import Refused\n"


@pytest.mark.blender
@pytest.mark.parametrize("version", [row.minor for row in releases()])
def test_blender_as_a_package_loads_all_of_it(version: str, tmp_path: Path) -> None:
    try:
        runtime = find_runtime(version, home=home_folder(), install=False)
    except NotInstalled:
        pytest.skip(
            f"Blender {version} is not installed here (simworlds doctor --blender {version} --install)"
        )
    with zipfile.ZipFile(extension.build(tmp_path)) as archive:
        archive.extractall(tmp_path)
    done = subprocess.run(
        [str(runtime.executable), "-c", LOAD, str(tmp_path)],
        env=environment_of_others(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout.strip().splitlines()[-1:] == ["True [] [1.0, 2.0, 3.0] True"], (
        done.stdout + done.stderr
    )


def test_a_program_that_is_no_blender_is_told(tmp_path: Path) -> None:
    result = CliRunner().invoke(command, ["install", "--blender-exe", sys.executable])
    assert result.exit_code == 2
    assert "tells no version of a Blender" in result.output
    gone = CliRunner().invoke(command, ["install", "--blender-exe", str(tmp_path / "none")])
    assert "There is no Blender at" in gone.output


def invoke_with_a_blender(folder: Path, installing: str, checking: str) -> tuple[int, str]:
    """What the command says of a Blender that does these two things."""
    program = folder / "blender"
    program.write_text(
        f"#!/bin/sh\ncase $1 in --version) echo Blender 5.1.0;; --command) {installing};; *) {checking};; esac\n"
    )
    program.chmod(0o755)
    result = CliRunner().invoke(command, ["install", "--blender-exe", str(program)])
    return result.exit_code, result.output


def test_a_blender_counts_as_equipped_when_it_has_the_extension_enabled(tmp_path: Path) -> None:
    enabled, not_enabled = "echo SimWorlds is enabled", "echo SimWorlds is not enabled"
    code, said = invoke_with_a_blender(tmp_path, "echo 'ALSA lib error: no card'", enabled)
    assert (code, said[:24]) == (0, "Installed in Blender 5.1")
    for installing, checking, reason in (
        ("kill -SEGV $$", enabled, "exit code -11"),
        ("echo no such file; exit 1", enabled, "no such file"),
        ("true", not_enabled, "is not enabled"),
        ("true", "exit 1", "exit code 0"),
    ):
        code, said = invoke_with_a_blender(tmp_path, installing, checking)
        assert (code, "did not install the extension" in said, reason in said) == (2, True, True), said


@pytest.mark.blender
def test_an_installed_blender_gets_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blender = shutil.which("blender")
    if blender is None:
        pytest.skip("no blender on PATH")
    for name in ("CONFIG", "SCRIPTS"):
        (tmp_path / name).mkdir()
        monkeypatch.setenv(f"BLENDER_USER_{name}", str(tmp_path / name))
    result = CliRunner().invoke(command, ["install", "--blender-exe", blender])
    assert result.exit_code == 0, result.output
    assert list((tmp_path / "SCRIPTS").rglob(f"{extension.NAME}/__init__.py"))
