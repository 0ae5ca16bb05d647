"""Results as sweeps leave them, written by hand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from written_results import Written

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def results(tmp_path: Path) -> Written:
    """A folder of results, to be filled."""
    return Written(tmp_path / "results")
