"""Bytes that begin as something good and were then broken: what fuzzing feeds the targets with."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hypothesis import strategies as st

if TYPE_CHECKING:
    from collections.abc import Sequence

LONGEST = 40_000
_NUMBERS = (
    b"\xff\xff\xff\xff",
    b"\xff\xff\xff\x7f",
    b"\0\0\0\x80",
    b"\0\0\0\0",
    b"\x01\0\0\0",
    b"-1",
    b"1e999",
    b"9" * 400,
)


@st.composite
def broken(draw: st.DrawFn, seeds: Sequence[bytes], tokens: Sequence[bytes] = ()) -> bytes:
    """One of the seeds after up to eight changes: bytes flipped, cut, repeated, replaced by tokens and numbers."""
    data = draw(st.sampled_from(list(seeds)))
    words = st.sampled_from([*tokens, *_NUMBERS]) | st.binary(max_size=8)
    for _ in range(draw(st.integers(0, 8))):
        at = draw(st.integers(0, len(data)))
        end = min(len(data), at + draw(st.sampled_from([0, 1, 4, 40, 400])))
        change = draw(st.sampled_from(["put", "cut", "repeat", "flip", "splice"]))
        if change == "put":
            data = data[:at] + draw(words) + data[end:]
        elif change == "cut":
            data = data[:at] + data[end:]
        elif change == "repeat":
            data = data[:end] + data[at:end] * draw(st.sampled_from([1, 3, 60])) + data[end:]
        elif change == "flip" and at < len(data):
            data = data[:at] + bytes([data[at] ^ (1 << draw(st.integers(0, 7)))]) + data[at + 1 :]
        elif change == "splice":
            data = data[:at] + draw(st.sampled_from(list(seeds)))[end:]
    return data[:LONGEST]
