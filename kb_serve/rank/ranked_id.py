"""An id in the ranked list for a query."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

if TYPE_CHECKING:
    from kb_serve.recognise.recognition import Why

# How an id got into the list that was not recognised in the query: by its words, as a node whose label is in the
# question, as a member that is asked for, as a part of what was asked for, or with a topic.
_NotRecognised = Literal["found", "beside", "asked", "part", "topic"]


class RankedId(NamedTuple):
    """An id and why it is in the list; ``score`` falls from 1 down the list. The rest is as of the search's hits."""

    id: str
    score: float
    why: Why | _NotRecognised
    anchor: str = ""
    members: tuple[str, ...] = ()
    chapter: int = -1
