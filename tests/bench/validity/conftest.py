"""Small scenes with physics, made once."""

from __future__ import annotations

from pathlib import Path  # noqa: TC003

import pytest
from in_blender import run
from made_once import made_once


@pytest.fixture(scope="session")
def small_scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of ``drape``, ``slack``, ``pour`` and ``room``. Never write to it."""

    def make(folder: Path) -> Path:
        run("small_scenes.py", folder)
        return folder

    return made_once(tmp_path_factory, "small-scenes", make)
