"""Results as sweeps leave them, written by hand."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parent))

from written_results import Written


@pytest.fixture
def results(tmp_path: Path) -> Written:
    """A folder of results, to be filled."""
    return Written(tmp_path / "results")
