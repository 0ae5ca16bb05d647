# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs scripts in Blender, each in a new scene and a folder of its own: ``run_recipes.py SCRIPTS.json ERRORS.jsonl``.

The scripts are a list of texts. Each adds a line to the errors as soon as it is done: what it raised, as JSON, empty
where it ran through.
"""

from __future__ import annotations

import json
import os
import sys
import tempfile
import traceback
from importlib import import_module
from pathlib import Path
from typing import Any


def error_of(script: str) -> str:
    """What a script raises, and at which of its lines."""
    bpy: Any = import_module("bpy")
    bpy.ops.wm.read_factory_settings()
    try:
        exec(compile(script, "recipe", "exec", dont_inherit=True), {"__name__": "__main__"})  # noqa: S102 - recipes are of this project
    except Exception as error:
        lines = script.splitlines()
        at = [row.lineno for row in traceback.extract_tb(error.__traceback__) if row.filename == "recipe"]
        return f"{type(error).__name__}: {error} ({lines[(at[-1] or 1) - 1].strip() if at else ''})"
    return ""


def main() -> None:
    """Runs what the first file has, and adds to the second."""
    scripts, errors = map(Path, sys.argv[-2:])
    for script in json.loads(scripts.read_text(encoding="utf-8")):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            error = error_of(script)
            os.chdir("/")
        with errors.open("a", encoding="utf-8") as out:
            out.write(json.dumps(error) + "\n")
    os._exit(0)  # a Blender that has baked a fluid may hang or abort where it ends


if __name__ == "__main__":
    main()
