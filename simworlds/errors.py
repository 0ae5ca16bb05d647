"""Errors that a user is told instead of a traceback."""

from __future__ import annotations

import errno

# What the system says where there is no room for a file.
NO_ROOM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})

# What it says where the path itself is at fault.
OF_PATHS = frozenset({errno.EACCES, errno.EPERM, errno.EROFS, errno.ENAMETOOLONG, errno.ELOOP, errno.ENOTDIR})


def remedy(error: OSError) -> str:
    """What to do where nothing could be written, as the beginning of a sentence."""
    return "Make room there" if error.errno in NO_ROOM else "Make the folder writable"


class UserError(Exception):
    """Base of all of them. The message says what was wrong, where, and what to do."""
