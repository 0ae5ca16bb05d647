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
    own = frozenset(HERE.glob("test_*.py")) - {TRIED_WHOLE}
    for item in items:
        if item.path in own and isinstance(item, pytest.Function) and "callspec" in vars(item):
            tables.setdefault((item.path, item.originalname), []).append(item)
    for cells in tables.values():
        for item in cells[1::2] if len(cells) >= LEAST else ():
            item.add_marker(pytest.mark.whole)
