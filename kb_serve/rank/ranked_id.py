"""An id in the ranked list for a query."""

from __future__ import annotations

from typing import NamedTuple


class RankedId(NamedTuple):
    """An id and why it is in the list; ``score`` falls from 1 down the list. The rest is as of the search's hits."""

    id: str
    score: float
    why: str
    anchor: str = ""
    members: tuple[str, ...] = ()
    chapter: int = -1
