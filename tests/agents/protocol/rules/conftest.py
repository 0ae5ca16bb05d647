"""Leaves every second cell of the rules' tables to `make test-whole`."""

from __future__ import annotations

from pathlib import Path

import pytest

HERE = Path(__file__).parent
# Each rule's own scenes: what holds and what breaks it.
TRIED_WHOLE = HERE / "test_rule_cases.py"
# A table of fewer cells is tried whole.
LEAST = 4


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks them ``whole``: of each test with many cells, the second, the fourth, …"""
    tables: dict[tuple[Path, str], list[pytest.Item]] = {}
    for item in items:
        is_here = item.path.is_relative_to(HERE) and item.path != TRIED_WHOLE
        if is_here and isinstance(item, pytest.Function) and "callspec" in vars(item):
            tables.setdefault((item.path, item.originalname), []).append(item)
    for cells in tables.values():
        for item in cells[1::2] if len(cells) >= LEAST else ():
            item.add_marker(pytest.mark.whole)
