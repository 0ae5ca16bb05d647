"""What can go wrong while a knowledge base answers.

KBServeError
├── BaseMissing      no knowledge base for the version asked for
├── BaseUnreadable   the file is corrupt, truncated, of something else, or newer than this program
└── BadQuery         the query cannot be answered as it is (empty, part out of range)

Every message says what was wrong, where, and what to do.
"""

from __future__ import annotations


class KBServeError(Exception):
    """Base of everything that a caller is told instead of a traceback."""


class BaseMissing(KBServeError):  # noqa: N818 - reads as the state it names
    """No knowledge base for the version asked for."""


class BaseUnreadable(KBServeError):  # noqa: N818 - reads as the state it names
    """The file is corrupt, truncated, of something else, or newer than this program."""


class BadQuery(KBServeError):  # noqa: N818 - reads as the state it names
    """The query cannot be answered as it is."""
