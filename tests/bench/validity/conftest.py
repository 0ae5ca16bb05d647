"""Small scenes with physics, made once."""

from __future__ import annotations

from pathlib import Path  # noqa: TC003

import pytest
from in_blender import run


@pytest.fixture(scope="session")
def small_scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of ``drape``, ``slack``, ``pour`` and ``room``. Never write to it."""
    place = tmp_path_factory.mktemp("small")
    run("small_scenes.py", place)
    return place
