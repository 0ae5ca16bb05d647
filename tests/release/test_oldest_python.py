"""The wheel on the oldest Python that it is for: it answers and checks as on this one."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
from typing import TYPE_CHECKING

import pytest
from places import REPO
from running import environment

from release.build import build_twice

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [pytest.mark.blender, pytest.mark.slow]

# Prints what it is asked, one by one, whatever Python it runs on.
_ANSWERS = """
import importlib, pkgutil, sys
from pathlib import Path
import kb_build, kb_serve, kb_check, simworlds, agents, bench
from kb_serve.knowledge_base import KnowledgeBase
for package in (kb_build, kb_serve, kb_check, simworlds, agents, bench):
    for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
        if "inside" not in module.name and not module.name.endswith("__main__"):
            importlib.import_module(module.name)
with KnowledgeBase(Path(sys.argv[1])) as base:
    for query in sys.stdin:
        print(base.query(query.strip()).text)
"""
_QUERIES = """
bpy.types.Object.location
bpy.context.object.modifiers["Subdivision"].levels
obj.select = True
mat.node_tree.nodes["Principled BSDF"].inputs["Specular"]
AttributeError: 'Object' object has no attribute 'select'
change the colour of an object
how do I make a smoke simulation
cloth
subdivison surfce
"""
_SCRIPT = """
import bpy
ob = bpy.context.object
ob.select = True
ob.modifers
bpy.ops.mesh.primitive_cube_add(radius=1)
"""


@pytest.fixture(scope="module")
def oldest(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The interpreter of an environment of the oldest Python, with the wheel and what it needs; skips the test where
    there is no such Python, or nothing to install from.
    """
    project = tomllib.loads((REPO / "pyproject.toml").read_text())["project"]
    version = re.fullmatch(r">=([\d.]+)", project["requires-python"])
    assert version is not None
    folder = tmp_path_factory.mktemp("oldest")
    wheel, _ = build_twice(REPO, folder)
    python = folder / "env" / "bin" / "python"
    for words, lacking in (
        (
            ["venv", "--no-python-downloads", "--python", version[1], str(folder / "env")],
            "there is none here",
        ),
        (["pip", "install", "--python", str(python), str(wheel)], "what it needs could not be installed"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "uv", "--quiet", *words],
            env={**os.environ, "UV_CONSTRAINT": str(REPO / "requirements.lock")},
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode:
            pytest.skip(f"Python {version[1]}: {lacking}: {done.stderr[-300:]}")
    return python


def _output(python: str, words: list[str], home: Path, given: str = "", **more: str) -> str:
    done = subprocess.run(
        [python, *words],
        input=given,
        env=environment(home, PYTHONWARNINGS="", **more),
        cwd=home,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr
    return done.stdout


def test_every_module_is_imported_and_answers_are_the_same(oldest: Path, base: Path) -> None:
    words = ["-c", _ANSWERS, str(base)]
    home = base.parent.parent
    here = _output(sys.executable, words, home, _QUERIES.strip())
    assert here.count("## ") >= 9
    assert _output(str(oldest), words, home, _QUERIES.strip(), PYTHONPATH="") == here


def test_findings_are_the_same(oldest: Path, base: Path, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(_SCRIPT)
    words = ["-m", "simworlds", "check", "--json", "--no-cache", str(script)]
    home = base.parent.parent
    here = _output(sys.executable, words, home)
    assert here.count('"rule"') == 3
    assert _output(str(oldest), words, home, PYTHONPATH="") == here
