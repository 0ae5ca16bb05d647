"""A checker of this environment's Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kb_check.checker import Checker

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def checker(base: Path) -> Iterator[Checker]:
    with Checker(base) as opened:
        yield opened
