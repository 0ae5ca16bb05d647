"""What can go wrong while a knowledge base answers.

KBServeError
├── BaseMissing      there is no knowledge base for this version
├── BaseUnreadable   the file is corrupt, truncated, of something else, or newer than this program
└── BadQuery         the query cannot be answered (empty, too much work, part out of range)
"""

from __future__ import annotations

from simworlds.errors import UserError


class KBServeError(UserError):
    """Base of the errors of a knowledge base."""


class BaseMissing(KBServeError):  # noqa: N818 - reads as the state it names
    """There is no knowledge base for this version: ``what`` says so, ``advice`` how to get one."""

    def __init__(self, what: str, advice: str = "") -> None:
        self.what, self.advice = what, advice
        super().__init__(f"{what} {advice}".rstrip())


class BaseUnreadable(KBServeError):  # noqa: N818 - reads as the state it names
    """The file is corrupt, truncated, of something else, or newer than this program."""


class BadQuery(KBServeError):  # noqa: N818 - reads as the state it names
    """The query cannot be answered; the message says what to change."""
