"""The wire: what one side writes arrives whole, and what anybody else writes is known for it."""

from __future__ import annotations

import hmac
import random
import struct
from typing import Any

import pytest

from simworlds.sandbox.inside import channel
from simworlds.sandbox.inside.channel import LARGEST_BODY, SUPERVISOR, WORKER, Decoder, Encoder, ForgedFrame

KEY = bytes(range(32))


def pair() -> tuple[Encoder, Decoder]:
    return Encoder(KEY, WORKER), Decoder(KEY, WORKER)


def by_hand(body: bytes) -> bytes:
    """The first frame of a worker."""

    def signature(part: bytes, data: bytes) -> bytes:
        return hmac.digest(KEY, b"worker/" + part + b"/" + bytes(8) + b"/" + data, "sha256")

    length = struct.pack(">I", len(body))
    return length + signature(b"head", length)[:16] + signature(b"body", body) + body


@pytest.mark.parametrize(
    "message",
    [{}, {"a": [1, 2.5, None, True, "ß 😀"]}, {"text": "x" * 300_000}, {"nested": {"b": [[[]]]}}],
    ids=["empty", "values", "long", "nested"],
)
def test_a_message_arrives_as_it_was_sent(message: dict[str, Any]) -> None:
    encode, decoder = pair()
    assert decoder.feed(encode(message)) == [message]


def test_messages_arrive_whole_and_in_order_however_they_are_cut() -> None:
    encode, decoder = pair()
    sent = [{"number": number, "text": "x" * number} for number in range(50)]
    stream = b"".join(encode(message) for message in sent)
    chance = random.Random(5)
    arrived: list[dict[str, Any]] = []
    while stream:
        cut = chance.randint(1, 90)
        arrived += decoder.feed(stream[:cut])
        stream = stream[cut:]
    assert arrived == sent


@pytest.mark.parametrize("place", [0, 3, 4, 19, 20, 51, 52, -1])
def test_detects_any_flipped_bit(place: int) -> None:
    encode, decoder = pair()
    frame = bytearray(encode({"value": "what Blender said"}))
    frame[place] ^= 1
    with pytest.raises(ForgedFrame):
        decoder.feed(bytes(frame))


def test_rejects_foreign_bytes_at_the_head() -> None:
    _, decoder = pair()
    with pytest.raises(ForgedFrame):
        decoder.feed(struct.pack(">I", 1_000_000) + b"\0" * 16)


def test_rejects_a_frame_after_stray_bytes() -> None:
    encode, decoder = pair()
    assert decoder.feed(b"x") == []
    with pytest.raises(ForgedFrame):
        decoder.feed(encode({"value": 1}))


def test_rejects_repeated_and_reordered_frames() -> None:
    encode, decoder = pair()
    first, second = encode({"number": 1}), encode({"number": 2})
    assert decoder.feed(first) == [{"number": 1}]
    with pytest.raises(ForgedFrame):
        decoder.feed(first)
    _, fresh = pair()
    with pytest.raises(ForgedFrame):
        fresh.feed(second)


def test_rejects_reflected_frames() -> None:
    with pytest.raises(ForgedFrame):
        Decoder(KEY, SUPERVISOR).feed(Encoder(KEY, WORKER)({"value": 1}))


def test_rejects_frames_with_another_key() -> None:
    _, decoder = pair()
    with pytest.raises(ForgedFrame):
        decoder.feed(Encoder(bytes(32), WORKER)({"value": 1}))


@pytest.mark.parametrize(
    "body",
    [b"[1]", b'"text"', b"{", b"\xff\xfe", b"[" * 200_000],
    ids=["list", "text", "cut", "bytes", "deep"],
)
def test_rejects_a_signed_body_that_is_not_a_message(body: bytes) -> None:
    _, decoder = pair()
    with pytest.raises(ForgedFrame, match="does not hold"):
        decoder.feed(by_hand(body))


def test_frame_format_is_as_documented() -> None:
    encode, _ = pair()
    assert encode({"value": 1}) == by_hand(b'{"value":1}')


def test_too_large_message_raises_and_changes_nothing() -> None:
    encode, decoder = pair()
    with pytest.raises(channel.TooLarge, match="the limit is"):
        encode({"text": "x" * (LARGEST_BODY + 1)})
    assert decoder.feed(encode({"value": 1})) == [{"value": 1}]


def test_encodes_other_objects_as_text() -> None:
    encode, decoder = pair()
    assert decoder.feed(encode({"value": {1, 2}, "text": "\ud800"})) == [{"value": "{1, 2}", "text": "?"}]
