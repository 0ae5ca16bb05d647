"""A checker of this environment's Blender, and the command in a home folder of its own and a folder for code."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from checking import Command

from kb_check.checker import Checker

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def checker(base: Path) -> Iterator[Checker]:
    with Checker(base) as opened:
        yield opened


@pytest.fixture
def command(base: Path, tmp_path: Path) -> Command:
    """The command, run in an empty folder, with a cache of its own."""
    home, folder = tmp_path / "home", tmp_path / "code"
    (home / "kb").mkdir(parents=True)
    folder.mkdir()
    (home / "kb" / base.name).symlink_to(base)
    return Command(home, folder)
