"""The operators that open a file, whose things and settings the script does not show."""

from __future__ import annotations

OPENING = frozenset(
    f"bpy.ops.wm.{name}"
    for name in (
        "open_mainfile",
        "read_homefile",
        "revert_mainfile",
        "recover_last_session",
        "recover_auto_save",
    )
)
