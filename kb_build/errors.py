"""Errors of building a knowledge base.

KBBuildError
├── SourceError      a documentation source is missing, unreadable, hostile or of the wrong version
├── ExtractError     Blender started, but the extraction did not finish
├── SummaryError     summaries were asked for and could not be had
├── StoreError       the knowledge-base file cannot be written or read
└── ReadyBaseError   a ready base cannot be fetched, or is not what it says
    └── FetchedElsewhere   another process is downloading a ready base into the same folder

Every message says what was wrong, where, and what to do.
"""

from __future__ import annotations

from simworlds.errors import UserError


class KBBuildError(UserError):
    """Base class of the errors that a build reports to its user without a traceback."""


class SourceError(KBBuildError):
    """A documentation source is missing, unreadable, hostile or of the wrong version."""


class ExtractError(KBBuildError):
    """Blender started, but the extraction did not finish; carries its output."""


class SummaryError(KBBuildError):
    """Summaries could not be made."""


class StoreError(KBBuildError):
    """The knowledge-base file cannot be written or read."""


class ReadyBaseError(KBBuildError):
    """A ready base cannot be fetched, or is not what it says."""


class FetchedElsewhere(ReadyBaseError):  # noqa: N818 - reads as the state it names
    """Another process is downloading a ready base into the same folder."""
