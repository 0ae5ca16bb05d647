"""The bounds of a query and its answer, and what holds where a caller names none."""

from __future__ import annotations

LONGEST_QUERY = 20_000  # characters
LIMIT, MAX_LIMIT = 8, 50  # hits
MAX_TOKENS, LEAST_TOKENS = 1_500, 150  # of an answer
