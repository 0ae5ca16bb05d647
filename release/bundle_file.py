"""The .mcpb bundle: a zip with the wheel in it, that clients such as Claude Desktop install by a double click."""

from __future__ import annotations

import time
import zipfile
from pathlib import Path

_FOLDER = Path(__file__).resolve().parent / "bundle"
_MODE = 0o100644 << 16
_FIRST_YEAR = 1980  # of a zip


def write_bundle(wheel: Path, version: str, target: Path, epoch: int) -> None:
    """Writes the bundle: manifest, entry point, the wheel, and the project that has uv install it."""
    members = {
        "manifest.json": (_FOLDER / "manifest.json").read_bytes(),
        "server/main.py": (_FOLDER / "main.py").read_bytes(),
        "pyproject.toml": _project(wheel.name, version).encode(),
        wheel.name: wheel.read_bytes(),
    }
    date = time.gmtime(epoch)[:6]
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            member = zipfile.ZipInfo(name, max(date, (_FIRST_YEAR, 1, 1, 0, 0, 0)))
            member.external_attr, member.compress_type, member.create_system = _MODE, zipfile.ZIP_DEFLATED, 3
            archive.writestr(member, content)


def _project(wheel: str, version: str) -> str:
    return f"""[project]
name = "simworlds-bundle"
version = "{version}"
requires-python = ">=3.11"
dependencies = ["simworlds"]

[tool.uv]
package = false

[tool.uv.sources]
simworlds = {{ path = "{wheel}" }}
"""
