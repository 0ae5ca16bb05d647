"""What every .blend file begins with."""

from __future__ import annotations

_BEGINNINGS = (b"BLENDER", b"\x28\xb5\x2f\xfd", b"\x1f\x8b")  # plain, Zstandard (since 3.0), gzip (before)
HEAD = 7
"""As many bytes as :func:`begins_blend` needs."""


def begins_blend(head: bytes) -> bool:
    """Whether a file that begins with these bytes may be a .blend."""
    return head.startswith(_BEGINNINGS)
