"""What a caller is told of a call that failed."""

from __future__ import annotations

import errno
import os

import pytest

from agents.blender.tools.failures import describe_failure


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (
            OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "/run/frames/made_of.json"),
            "blender_render failed: /run/frames/made_of.json: No space left on device. Make room there, then call it "
            "again.",
        ),
        (
            OSError(errno.EROFS, os.strerror(errno.EROFS), "/run/frames"),
            "blender_render failed: /run/frames: Read-only file system. Make the folder writable, then call it again.",
        ),
        (
            OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
            "blender_render failed: No space left on device. Make room there, then call it again.",
        ),
        (
            ConnectionResetError(errno.ECONNRESET, os.strerror(errno.ECONNRESET)),
            "blender_render failed on this call (ConnectionResetError). Change the call, or report it with its "
            "arguments.",
        ),
        (
            KeyError("frames"),
            "blender_render failed on this call (KeyError). Change the call, or report it with its arguments.",
        ),
    ],
)
def test_a_full_disk_is_not_told_as_a_fault_of_the_call(error: Exception, says: str) -> None:
    assert describe_failure("blender_render", error) == says
