"""The table of all attacks."""

from __future__ import annotations

from ways import reading
from way import Way

WAYS: tuple[Way, ...] = (
    *reading.WAYS,
)
assert len({way.name for way in WAYS}) == len(WAYS), "two ways have the same name"
