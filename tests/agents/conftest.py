"""Blenders for tests that send calls to one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from studio import Studio

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def _one_studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    studio = Studio(tmp_path_factory.mktemp("run"))
    yield studio
    studio.blender.close()


@pytest.fixture
def studio(_one_studio: Studio) -> Studio:
    """A Blender with an empty scene; the same process for all tests that ask for one."""
    _one_studio.empty()
    return _one_studio


@pytest.fixture
def own_studio(tmp_path: Path) -> Iterator[Studio]:
    """A Blender of the test's own, to be treated badly."""
    studio = Studio(tmp_path / "run")
    yield studio
    studio.blender.close()


@pytest.fixture
def make_studio(tmp_path: Path) -> Iterator[Callable[[str], Studio]]:
    """Makes Blenders of the test's own, by a folder's name."""
    made: list[Studio] = []

    def make(name: str) -> Studio:
        made.append(Studio(tmp_path / name))
        return made[-1]

    yield make
    for studio in made:
        studio.blender.close()
