"""Programs of npm packages, where they are installed: nothing is fetched for a test."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest


def npm_tool(name: str) -> str:
    """The path of a program, in the folder of node_modules that SIMWORLDS_NPM names or on PATH; else a skip."""
    folder = os.environ.get("SIMWORLDS_NPM")
    path = shutil.which(name, path=str(Path(folder) / ".bin") if folder else None)
    if path is None:
        pytest.skip(f"{name} is not installed: npm install, then SIMWORLDS_NPM=node_modules")
    return path
