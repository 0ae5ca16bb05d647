"""Tables of which ``make test`` takes a part, and ``make test-whole`` all."""

from __future__ import annotations

import os

VARIABLE = "SIMWORLDS_WHOLE"
IS_WHOLE = bool(os.environ.get(VARIABLE))


def examples(number: int) -> int:
    """How many random examples to try: a third of ``number``, unless the whole is asked for."""
    return number if IS_WHOLE else -(-number // 3)
