"""Bases and Blenders of other versions than this environment's, where the machine has them.

A base is one of the machine's home (``SIMWORLDS_HOME``): ``simworlds kb build VERSION`` makes it.
"""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest

from kb_check.migrate.trial import run_in, runtime_at_hand
from kb_serve.errors import BaseMissing
from kb_serve.locate import find_base
from simworlds.settings import home_folder

if TYPE_CHECKING:
    from pathlib import Path

_RUN = """
import json
import bpy
names, errors = {{"bpy": bpy}}, []
for line in json.loads({lines!r}):
    try:
        exec(line, names)
        errors.append("")
    except Exception as error:
        errors.append(f"{{type(error).__name__}}: {{error}}")
with open({out!r}, "w") as file:
    json.dump(errors, file)
"""


def base_of(version: str) -> Path:
    """The base of a version; skips the test where there is none."""
    try:
        return find_base(version)
    except BaseMissing:
        pytest.skip(f"there is no base of Blender {version}")


def errors_in(version: str, folder: Path, lines: list[str]) -> list[str]:
    """What each of some statements raises in the Blender of a version, one after the other; empty for those that run.

    Skips the test where there is no such Blender.
    """
    runtime = runtime_at_hand(version, home_folder())
    if runtime is None:
        pytest.skip(f"there is no Blender {version}")
    script, out = folder / "statements.py", folder / "errors.json"
    script.write_text(_RUN.format(lines=json.dumps(lines), out=str(out)))
    ending = run_in(runtime, script)
    assert not ending.error, ending.error
    errors: list[str] = json.loads(out.read_text())
    assert len(errors) == len(lines)
    return errors
