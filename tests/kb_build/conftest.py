"""A base of one's own, copied from the one that is built once."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

import pytest

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
