"""Errors of language models.

ModelError
├── Rejected           the server rejects the request: a wrong key, no credit, an invalid request
│   └── TooLong        the conversation is too long for the model
├── Unreachable        no attempt gave a whole answer
├── Stopped            the model answered, but not with a turn that the conversation can go on from
│   ├── Declined        it declined
│   └── CutShort       it ran into its limit
├── Misfit             no answer was the JSON that was requested
├── OverBudget         the call could cost more than the limit leaves
├── Drifted            the conversation is not the recorded one
└── UnreadableRecord   a record cannot be read
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from simworlds.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from simworlds.llm.messages import Turn, Usage


class ModelError(UserError):
    """Base of the errors here. ``lost`` is the usage of attempts without a turn, as far as it is known."""

    lost: Usage | None = None


class Rejected(ModelError):  # noqa: N818 - these read as the states they name
    """The server rejects the request; retrying would not help. ``status`` is HTTP's, 0 without one."""

    def __init__(self, message: str, status: int = 0) -> None:
        self.status = status
        super().__init__(message)


class TooLong(Rejected):
    """The conversation is longer than the model or its budget allows."""


class Unreachable(ModelError):  # noqa: N818
    """No attempt gave a whole answer: no connection, an overloaded server, broken streams."""


class Stopped(ModelError):  # noqa: N818
    """The model answered, and that was paid for, but the conversation cannot go on from ``turn``."""

    def __init__(self, message: str, turn: Turn) -> None:
        self.turn = turn
        super().__init__(message)


class Declined(Stopped):
    """The model declined to answer."""


class CutShort(Stopped):
    """The answer ended at ``max_tokens`` or at the end of the model's context; an unfinished tool call is left out."""


class Misfit(ModelError):  # noqa: N818
    """The text is not the requested JSON. ``problems`` are sentences; ``text`` is what the model wrote."""

    def __init__(self, problems: Sequence[str], text: str) -> None:
        self.problems = tuple(problems)
        self.text = text
        super().__init__("\n".join(self.problems))


class OverBudget(ModelError):  # noqa: N818
    """The call was not made: at worst it would cost more than the limit leaves."""


class Drifted(ModelError):  # noqa: N818
    """The conversation is not the recorded one, from ``message`` on (counted from 1; 0: the system prompt or tools).

    ``expected`` and ``found`` are the two texts, ``diff`` their difference.
    """

    def __init__(  # noqa: PLR0913
        self, where: str, *, role: str, stage: str, message: int, expected: str, found: str, diff: str
    ) -> None:
        self.role, self.stage, self.message = role, stage, message
        self.expected, self.found, self.diff = expected, found, diff
        super().__init__(f"{where}\n{diff}" if diff else where)


class UnreadableRecord(ModelError):  # noqa: N818
    """A record that cannot be read; the message says where and why."""


def raise_for_stop(turn: Turn) -> Turn:
    """``turn``, if the conversation can go on from it. Raises Declined, CutShort."""
    if turn.stop_reason == "refusal":
        why = f": {turn.stop_details}" if turn.stop_details else ""
        raise Declined(f"The model ({turn.model}) declined to answer{why}", turn)
    if turn.stop_reason in ("max_tokens", "model_context_window_exceeded"):
        limit = "its limit" if turn.stop_reason == "max_tokens" else "the end of the model's context"
        raise CutShort(f"The answer was cut off at {limit}, after {turn.usage.output} tokens.", turn)
    return turn
