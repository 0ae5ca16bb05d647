"""Bases of one's own, copied from those that are built once."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

import pytest
from made_once import made_once

if TYPE_CHECKING:
    from pathlib import Path

    from built_base import Built


@pytest.fixture(scope="session")
def blender_version() -> str:
    """The version of this environment's bpy; the test is skipped where there is none."""
    try:
        return metadata.version("bpy")
    except metadata.PackageNotFoundError:
        pytest.skip("this environment has no bpy")


@pytest.fixture
def built(built_once: Built, tmp_path: Path) -> Built:
    """A base of one's own: from the miniature manual and guides, by this environment's Blender."""
    return built_once.copy(tmp_path)


@pytest.fixture(scope="session")
def _small_once(built_once: Built, tmp_path_factory: pytest.TempPathFactory) -> Built:
    return made_once(tmp_path_factory, "small", lambda folder: built_once.copy(folder).rebuilt_small())


@pytest.fixture
def small(_small_once: Built, tmp_path: Path) -> Built:
    """The same with a few symbols of Blender's: for tests that build again, which asks Blender only if forced to."""
    return _small_once.copy(tmp_path)
