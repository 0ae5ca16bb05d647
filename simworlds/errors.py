"""Errors that a user is told instead of a traceback."""

from __future__ import annotations


class UserError(Exception):
    """Base of all of them. The message says what was wrong, where, and what to do."""
