"""Errors that a user is told instead of a traceback."""

from __future__ import annotations

import errno

# What the system says where there is no room for a file.
NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})


class UserError(Exception):
    """Base of all of them. The message says what was wrong, where, and what to do."""
