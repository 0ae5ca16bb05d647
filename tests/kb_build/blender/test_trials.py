"""What the trials inside Blender stand on: crashes that are proven, and the class that declares a property."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.blender

# Each attempt notes its name; some end the process, always or after another one.
TRY = """
import json, os, sys
import bpy
from kb_build.blender.inside.tried import crashes

begun = sys.argv[1]
before = []

class Attempt:
    made, owner, item = "thing", bpy.context.scene, bpy.types.Scene.bl_rna.properties["name"]

    def __init__(self, name, ends=False, leaves_gaps=False):
        self.path, self.ends, self.leaves_gaps = "bpy.types.Scene." + name, ends, leaves_gaps

    def run(self):
        with open(begun, "a") as file:
            file.write(self.path.rpartition(".")[2] + " ")
        before.append(self.path)
        if self.ends is True or self.ends in before:
            os.abort()

    def causes(self):
        return {"always": True}

crashes.reached = lambda _observer, thing: [thing]
sent = []
trial = crashes.Trial(None, {}, sent.append)
trial.attempts = lambda _made, attempts: attempts
trial.look([("things", [
    Attempt("spoiler", leaves_gaps=True),
    Attempt("first"),
    Attempt("spoilt", ends="bpy.types.Scene.spoiler"),
    Attempt("follower", ends="bpy.types.Scene.first"),
    Attempt("fatal", ends=True),
    Attempt("last"),
])])
json.dump({"told": [row["path"] for row in sent], "survived": sorted(trial.survived)}, open(sys.argv[2], "w"))
os._exit(0)
"""
# Of each property: the class that declares it as it is looked up, and as a walk from class to class finds it.
DECLARING = """
import json, os, sys
import bpy
from kb_build.blender.inside.classes.rna import declaring_class

def walked(rna, name):
    pointer = rna.properties[name].as_pointer()
    while rna.base is not None:
        inherited = rna.base.properties.get(name)
        if inherited is None or inherited.as_pointer() != pointer:
            break
        rna = rna.base
    return rna.identifier

asked, wrong = 0, []
for name in dir(bpy.types):
    rna = getattr(getattr(bpy.types, name), "bl_rna", None)
    for prop in rna.properties if rna is not None else ():
        asked += 1
        if declaring_class(rna, prop.identifier) != walked(rna, prop.identifier):
            wrong.append([name, prop.identifier])
bpy.types.Scene.registered_since = bpy.props.IntProperty()
since = declaring_class(bpy.types.Scene.bl_rna, "registered_since")
json.dump({"asked": asked, "wrong": wrong, "since": since}, open(sys.argv[1], "w"))
os._exit(0)
"""


def run_in_blender(text: str, folder: Path, *arguments: Path) -> Any:
    """What a script, run by this interpreter, writes to the file that is its last argument."""
    program = folder / "script.py"
    program.write_text(text)
    words = [sys.executable, str(program), *map(str, arguments)]
    subprocess.run(words, env=os.environ | {"TMPDIR": str(folder)}, check=True, capture_output=True)
    return json.loads(arguments[-1].read_text())


def test_only_what_crashes_by_itself_is_told(tmp_path: Path) -> None:
    begun = tmp_path / "begun"
    found = run_in_blender(TRY, tmp_path, begun, tmp_path / "found.json")
    assert found["told"] == ["bpy.types.Scene.fatal"]
    # What ended a process begins the next one, and what spoils the things for others is the last.
    assert begun.read_text().split() == [
        "first", "spoilt", "follower", "follower", "fatal", "fatal", "last", "spoiler"
    ]  # fmt: skip
    names = {path.rpartition(".")[2] for path in found["survived"]}
    assert names == {"first", "spoilt", "follower", "last", "spoiler"}


def test_the_class_that_declares_a_property_is_the_one_that_a_walk_finds(tmp_path: Path) -> None:
    found = run_in_blender(DECLARING, tmp_path, tmp_path / "found.json")
    assert found["asked"] > 20_000
    assert found["wrong"] == []
    assert found["since"] == "Scene"
