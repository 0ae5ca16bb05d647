"""The steps of the GitHub action, run as the runner runs them, with a uvx that finds SimWorlds here."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
import yaml
from places import REPO

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    RunStep = Callable[..., tuple[int, str]]

pytestmark = pytest.mark.skipif(shutil.which("bash") is None, reason="the steps are for bash")

UVX = """#!/bin/sh
[ "$1" = --from ] && [ "$3" = simworlds ] || exit 99
shift 3
exec {python} -m simworlds "$@"
"""


def step(name: str) -> str:
    action = yaml.safe_load((REPO / "action.yml").read_text(encoding="utf-8"))
    return next(row["run"] for row in action["runs"]["steps"] if row["name"] == name)


@pytest.fixture
def run(tmp_path: Path, base: Path) -> RunStep:
    """Runs a step in an empty folder; returns its exit code and what it set as its outputs."""
    programs, home = tmp_path / "bin", tmp_path / "home"
    programs.mkdir()
    (programs / "uvx").write_text(UVX.format(python=sys.executable))
    (programs / "uvx").chmod(0o755)
    (home / "kb").mkdir(parents=True)
    os.link(base, home / "kb" / base.name)

    def run_step(name: str, **inputs: str) -> tuple[int, str]:
        outputs = tmp_path / "outputs"
        outputs.touch()
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", step(name)],
            cwd=tmp_path,
            env={
                **os.environ,
                "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
                "PYTHONPATH": str(REPO),
                "SIMWORLDS_HOME": str(home),
                "GITHUB_OUTPUT": str(outputs),
                "INPUT_INSTALL": "simworlds",
                **{f"INPUT_{key.upper()}": value for key, value in inputs.items()},
            },
            check=False,
        )
        return done.returncode, outputs.read_text()

    return run_step


def test_findings_become_sarif_and_an_exit_code(run: RunStep, tmp_path: Path, base: Path) -> None:
    minor = base.stem.removeprefix("blender-")
    (tmp_path / "my scripts").mkdir()
    (tmp_path / "my scripts" / "door.py").write_text(
        "import bpy\nbpy.ops.mesh.primitive_cube_add(radius=1)\n"
    )
    code, outputs = run(
        "Look for findings", command="check", paths="my scripts\n\n", blender=minor, sarif_file="out.sarif"
    )
    assert (code, outputs) == (0, "code=1\n"), "a later step fails the job, once the findings are shown"
    log = json.loads((tmp_path / "out.sarif").read_text())
    assert log["version"] == "2.1.0"
    assert [result["ruleId"] for entry in log["runs"] for result in entry["results"]] == ["unknown-keyword"]


def test_several_versions_are_runs_of_one_file(run: RunStep, tmp_path: Path, base: Path) -> None:
    """One base stands for two versions."""
    minor = base.stem.removeprefix("blender-")
    os.link(base, tmp_path / "home" / "kb" / "blender-9.9.sqlite")
    (tmp_path / "door.py").write_text("import bpy\nbpy.ops.mesh.primitive_cube_add(radius=1)\n")
    code, outputs = run(
        "Look for findings", command="check", paths=".", blender=f"{minor}, 9.9", sarif_file="out.sarif"
    )
    assert (code, outputs) == (0, "code=1\n")
    runs = json.loads((tmp_path / "out.sarif").read_text())["runs"]
    assert [[result["ruleId"] for result in entry["results"]] for entry in runs] == [["unknown-keyword"]] * 2
    assert [entry["properties"]["blender"] for entry in runs] == [minor, "9.9"]


def test_an_input_is_never_run(run: RunStep, tmp_path: Path, base: Path) -> None:
    minor = base.stem.removeprefix("blender-")
    run(
        "Look for findings",
        command="check",
        paths="$(touch hacked)\n`touch hacked`; touch hacked",
        blender=minor,
        sarif_file="out.sarif",
    )
    code, _ = run(
        "Look for findings", command="check; touch hacked", paths=".", blender=minor, sarif_file="x"
    )
    assert code == 2
    assert not (tmp_path / "hacked").exists()


def test_a_ready_base_is_fetched_where_one_is_named(run: RunStep, tmp_path: Path) -> None:
    code, _ = run("Get the knowledge bases", blender="5.1", base_url=str(tmp_path / "nowhere.tar.xz"))
    assert code == 2, "there is no such file, and it is said"
