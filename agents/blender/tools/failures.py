"""What a caller is told of a call that failed."""

from __future__ import annotations

import logging

from simworlds.errors import NO_ROOM, OF_PATHS, remedy
from simworlds.sandbox.errors import BlenderError, Lost, ToolBroke

_LOG = logging.getLogger(__name__)


def describe_failure(name: str, error: Exception) -> str:
    """What became of a call of the tool ``name``, in words; faults of ours are logged."""
    if isinstance(error, Lost):
        output = error.printed.strip()
        return f"{error}\n\nThe end of Blender's output:\n```\n{output}\n```" if output else str(error)
    if isinstance(error, ToolBroke):
        _LOG.error("%s failed in Blender: %s\n%s", name, error, error.details)
        return f"{name} failed because of a bug in the tool, not in your call: {error}. Blender still runs."
    if isinstance(error, BlenderError):
        return str(error)
    _LOG.error("%s failed", name, exc_info=error)
    if isinstance(error, OSError) and error.errno in NO_ROOM | OF_PATHS:
        # No other call, and no other scene, would fare better.
        place = f"{error.filename}: " if error.filename is not None else ""
        return f"{name} failed: {place}{error.strerror}. {remedy(error)}, then call it again."
    return f"{name} failed on this call ({type(error).__name__}). Change the call, or report it with its arguments."
