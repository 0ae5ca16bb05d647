"""What can go wrong between a role and its model.

ModelError
├── Rejected           the server does not take the request: a wrong key, no credit, a request that is none
│   └── TooLong        the conversation is more than the model takes
├── Unreachable        no whole answer is to be had, however often it is asked for
├── Stopped            the model answered, but not with a turn to go on from
│   ├── Refused        it declined
│   └── CutShort       it ran into its limit
├── Misfit             it does not give the JSON that is asked for, however often it is told
├── OverBudget         the call might cost more than may still be spent
├── Drifted            the conversation is not the recorded one
└── BadRecord          what should be a record is none
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from simworlds.llm.messages import Turn, Usage


class ModelError(Exception):
    """Anything below. ``lost`` is what was used up without a turn to show for it, as far as that is known."""

    lost: Usage | None = None


class Rejected(ModelError):  # noqa: N818 - these read as the states they name
    """The server does not take the request; asking again would not help. ``status`` is HTTP's, 0 without one."""

    def __init__(self, message: str, status: int = 0) -> None:
        self.status = status
        super().__init__(message)


class TooLong(Rejected):
    """The conversation is more than the model, or the budget for it, takes."""


class Unreachable(ModelError):  # noqa: N818
    """No whole answer: no connection, an overloaded server, streams that break."""


class Stopped(ModelError):  # noqa: N818
    """The model answered, and is paid for it, but ``turn`` is nothing to go on from."""

    def __init__(self, message: str, turn: Turn) -> None:
        self.turn = turn
        super().__init__(message)


class Refused(Stopped):
    """The model declined to answer."""


class CutShort(Stopped):
    """The answer ended at ``max_tokens`` or at the end of the model's context; an unfinished tool call is left out."""


class Misfit(ModelError):  # noqa: N818
    """The text is not the JSON that is asked for. ``problems`` are sentences; ``text`` is what the model wrote."""

    def __init__(self, problems: Sequence[str], text: str) -> None:
        self.problems = tuple(problems)
        self.text = text
        super().__init__("\n".join(self.problems))


class OverBudget(ModelError):  # noqa: N818
    """The call is not made: at worst it would cost more than the limit leaves."""


class Drifted(ModelError):  # noqa: N818
    """The conversation is not the recorded one, from ``message`` on (counted from 1; 0: the system prompt or tools).

    ``expected`` and ``found`` are the two texts, ``diff`` where they part.
    """

    def __init__(  # noqa: PLR0913
        self, where: str, *, role: str, stage: str, message: int, expected: str, found: str, diff: str
    ) -> None:
        self.role, self.stage, self.message = role, stage, message
        self.expected, self.found, self.diff = expected, found, diff
        super().__init__(f"{where}\n{diff}" if diff else where)


class BadRecord(ModelError):  # noqa: N818
    """A record that cannot be read; the message says where and why."""


def raise_for_stop(turn: Turn) -> Turn:
    """``turn``, if the conversation can go on from it. Raises Refused, CutShort."""
    if turn.stop_reason == "refusal":
        why = f": {turn.stop_details}" if turn.stop_details else ""
        raise Refused(f"The model ({turn.model}) declined to answer{why}", turn)
    if turn.stop_reason in ("max_tokens", "model_context_window_exceeded"):
        limit = "its limit" if turn.stop_reason == "max_tokens" else "the end of the model's context"
        raise CutShort(f"The answer was cut off at {limit}, after {turn.usage.output} tokens.", turn)
    return turn
