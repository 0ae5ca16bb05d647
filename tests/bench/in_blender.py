"""Runs a script that makes many scenes in one Blender, and gives the facts that the audit's own code reads of each."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from pydantic import TypeAdapter

from bench.audit.facts import Scene
from simworlds.installed import installed_bpy
from simworlds.sandbox.runtime import clean_environment

if TYPE_CHECKING:
    from typing import Any

HERE = Path(__file__).parent / "inside"


def facts_of(script: str, place: Path) -> dict[str, Scene]:
    """Name → facts of each scene that ``inside/SCRIPT`` makes, below the folder ``place``."""
    read: TypeAdapter[Scene] = TypeAdapter(Scene)
    return {name: read.validate_python(told) for name, told in run(script, place).items()}


def run(script: str, place: Path, *further: str) -> dict[str, Any]:
    """What the script wrote to the file that it was given; ``further``: arguments of its own."""
    if installed_bpy() is None:
        pytest.skip("there is no Blender in this environment")
    result = place / "result.json"
    done = subprocess.run(
        [sys.executable, "-P", str(HERE / script), str(place), str(result), *further],
        env=clean_environment(place / "settings")
        | {"PYTHONDONTWRITEBYTECODE": "1", "PYTHONPATH": str(HERE), "TMPDIR": str(place)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.is_file(), (done.stdout + done.stderr)[-3000:]
    return json.loads(result.read_text())
