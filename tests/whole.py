"""Tables of which ``make test`` takes a part, and ``make test-whole`` all."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterable

    from _pytest.mark.structures import ParameterSet

VARIABLE = "SIMWORLDS_WHOLE"
IS_WHOLE = bool(os.environ.get(VARIABLE))


def examples(number: int) -> int:
    """How many random examples to try: a third of ``number``, unless the whole is asked for."""
    return number if IS_WHOLE else -(-number // 3)


def by_turns(cells: Iterable[object], every: int = 2) -> list[ParameterSet]:
    """A table's cells for ``parametrize``: all but the first and each ``every``-th after it are marked ``whole``."""
    return [
        pytest.param(
            *(cell if isinstance(cell, tuple) else (cell,)), marks=pytest.mark.whole if place % every else ()
        )
        for place, cell in enumerate(cells)
    ]
