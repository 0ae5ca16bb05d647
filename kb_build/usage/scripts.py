"""The Python files that a Blender brings, and how well each kind shows how things are done."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PRESETS = "presets/"
TEMPLATES = "templates_py/"
# Folder below Blender's scripts → what is added to the cost of its examples.
_FOLDERS = {
    "templates_py": 0.0,
    "startup": 1.0,
    "modules": 1.0,
    "addons_core": 1.5,
    "addons": 1.5,
    "presets": 100.0,  # lists of settings, shown where nothing else uses a symbol
}
# What says nothing of its own: tables, generated code, the tests and tools of Blender's developers, and what takes long
# to read for what it shows.
_DULL = (
    "/keyconfig/", "/keymap_data/", "/metarigs/", "/rigify/rigs/", "/bl_pkg/", "/ui_translate/", "/_bl_i18n_utils/",
    "/_rna_manual_reference.py", "/_bpy_internal/", "/io_scene_gltf2/", "/tests/", "/__pycache__/",
)  # fmt: skip
_LARGEST = 1_000_000  # bytes


@dataclass(frozen=True, slots=True)
class Script:
    """A script of Blender's: ``name`` is its path below the folder of scripts, ``cost`` is added to its examples'."""

    name: str
    cost: float
    path: Path


def blender_scripts(folder: Path) -> Iterator[Script]:
    """The scripts below Blender's folder of scripts that are worth reading."""
    for top, cost in _FOLDERS.items():
        for path in sorted((folder / top).rglob("*.py")):
            name = path.relative_to(folder).as_posix()
            if not any(part in f"/{name}" for part in _DULL) and path.stat().st_size <= _LARGEST:
                yield Script(name, cost, path)


def read_script(path: Path) -> str:
    """A script's text; empty for what cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""
