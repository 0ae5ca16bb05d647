"""Why there is no judgement. That is never a low score: nothing was judged."""

from __future__ import annotations

from typing import Literal

from bench.judge.usage import Spent

Reason = Literal[
    "prompt",  # there are no words to judge by
    "frames",  # the frames cannot be shown
    "cache",  # what was asked cannot be kept
    "not set up",  # no key, or a package is missing
    "over budget",  # it might cost more than may be spent
    "rejected",  # the provider does not take the request
    "unreachable",  # the provider gives no whole answer
    "refused",  # the model declined
    "cut short",  # the answer ran into its limit
    "malformed",  # the answer is not what was asked for, however often
]

NO_OPENAI_PACKAGE = "The openai package is not installed. Install it with: pip install 'simworlds[openai]'"


class NotJudged(Exception):  # noqa: N818 - reads as the state it names
    """No judgement; the message says why and what to do. ``spent`` is what was used up all the same."""

    def __init__(self, reason: Reason, message: str, spent: Spent | None = None) -> None:
        self.reason: Reason = reason
        self.spent = spent or Spent()
        super().__init__(message)
