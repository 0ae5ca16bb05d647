"""The error for a missing judgement, which is never a low score."""

from __future__ import annotations

from typing import Literal

from bench.judge.usage import AnswerCost

Reason = Literal[
    "prompt",  # it is empty or too long
    "frames",  # they cannot be read, or are too few or too many
    "cache",  # answers cannot be kept
    "not set up",  # no key, or a package is missing
    "over budget",  # it might cost more than allowed
    "rejected",  # the provider rejects the request
    "unreachable",  # the provider gives no complete answer
    "refused",  # the model declined
    "cut short",  # the answer reached its length limit
    "malformed",  # all answers were invalid
]


class NotJudged(Exception):  # noqa: N818 - reads as the state it names
    """There is no judgement; the message says why and what to do. ``spent``: what it cost nevertheless."""

    def __init__(self, reason: Reason, message: str, spent: AnswerCost | None = None) -> None:
        self.reason: Reason = reason
        self.spent = spent or AnswerCost()
        super().__init__(message)
