"""Asks this environment's Blender, in a process of its own, what only it can tell."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path


def told_by_blender(script: str, folder: Path, given: object = None, seconds: float = 120) -> Any:
    """What a script writes, as JSON, into the file whose path is its last argument; it finds there what is given."""
    file = folder / "told.json"
    file.write_text(json.dumps(given))
    run = [sys.executable, "-P", "-c", script, str(file)]
    subprocess.run(run, check=True, timeout=seconds, capture_output=True, cwd=folder)
    return json.loads(file.read_text())
