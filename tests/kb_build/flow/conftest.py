"""The API of this environment's Blender, as types."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import pytest

from kb_build.flow.blender.api import Api
from kb_build.flow.blender.symbols import BaseSymbols

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="session")
def api(base: Path) -> Iterator[Api]:
    with closing(BaseSymbols(base)) as symbols:
        yield Api(symbols)
