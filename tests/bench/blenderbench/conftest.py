"""A miniature set in the official layout, built by Blender, and what the unedited scenes of it score."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from bench.blenderbench.run import run
from bench.blenderbench.systems import UneditedStart
from bench.blenderbench.task_scenes import EditRenderSettings
from bench.blenderbench.task_set import TaskSet, read_set
from simworlds.installed import installed_bpy
from simworlds.sandbox.runtime import clean_environment

HERE = Path(__file__).parent
# The team that answers for all roles of an edit, with a Blender of its own, and a second provider's server.
AGENTS = HERE.parent.parent / "agents"
sys.path += [str(AGENTS / "loop"), str(AGENTS), str(HERE.parent / "judge")]


@pytest.fixture(scope="session")
def mini(tmp_path_factory: pytest.TempPathFactory) -> TaskSet:
    """Four tasks of three levels. Never write to it."""
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    place = tmp_path_factory.mktemp("mini")
    result = place / "result.json"
    done = subprocess.run(
        [sys.executable, "-P", str(HERE / "inside" / "mini_set.py"), str(place / "set"), str(result)],
        env=clean_environment(place / "settings") | {"PYTHONDONTWRITEBYTECODE": "1", "TMPDIR": str(place)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.is_file(), (done.stdout + done.stderr)[-3000:]
    return read_set(place / "set")


@pytest.fixture(scope="session")
def rendering() -> EditRenderSettings:
    """As few samples as the miniature's own renders have."""
    return EditRenderSettings(samples=4, seconds=120)


@pytest.fixture(scope="session")
def unedited(mini: TaskSet, rendering: EditRenderSettings, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The results of a system that edits nothing. Never write to them."""
    out = tmp_path_factory.mktemp("results") / "unedited"
    run(mini, mini.tasks, UneditedStart(rendering), out)
    return out


@pytest.fixture(autouse=True)
def _environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """No key, no address of a model, and a home of its own."""
    for name in list(os.environ):
        if name.startswith(("ANTHROPIC_", "OPENAI_")):
            monkeypatch.delenv(name)
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path / "home"))
