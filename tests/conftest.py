"""Fixtures that every test may ask for."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="session")
def corpora() -> Path:
    """The folder with the real documentation sources; the test is skipped where it is absent."""
    folder = Path(os.environ.get("SIMWORLDS_CORPORA") or REPO.parent / "shared" / "corpora")
    if not folder.is_dir():
        pytest.skip("the real documentation sources are not on this machine")
    return folder
