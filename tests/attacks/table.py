"""The table of all attacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ways import (
    channel,
    ground,
    kernel,
    limits,
    network,
    others,
    pictures,
    processes,
    reading,
    replies,
    writing,
)

if TYPE_CHECKING:
    from way import Way

WAYS: tuple[Way, ...] = (
    *reading.WAYS,
    *writing.WAYS,
    *processes.WAYS,
    *others.WAYS,
    *network.WAYS,
    *kernel.WAYS,
    *limits.WAYS,
    *channel.WAYS,
    *channel.INTERPRETER,
    *ground.WAYS,
    *pictures.WAYS,
    *replies.WAYS,
)
assert len({way.name for way in WAYS}) == len(WAYS), "two ways have the same name"
