# SPDX-License-Identifier: GPL-3.0-or-later
"""The channel between the supervisor and its Blender: signed, numbered JSON messages on their own socket.

A frame is a head and a body (UTF-8 JSON). The head holds the body's length (4 bytes, big-endian), a tag of sender,
frame number and length (16 bytes), and an HMAC-SHA256 of sender, frame number and body. Bytes that anybody else writes
to the socket are recognised as soon as a head has arrived, so a false length keeps nobody waiting.
"""

import hashlib
import hmac
import json
import struct

KEY_BYTES = 32
LARGEST_BODY = 16 * 1024 * 1024
_BYTES_A_PART = (
    8  # of a body, at least, on average: a short one can hold many values, which take far more memory
)
SUPERVISOR, WORKER = b"supervisor", b"worker"
CHANNEL_LOST = 97  # the worker's exit code when its end of the socket was taken from it
_LENGTH = struct.Struct(">I")
_TAG_BYTES, _SIGNATURE_BYTES = 16, 32
_TAGGED = _LENGTH.size + _TAG_BYTES
_HEAD = _TAGGED + _SIGNATURE_BYTES


class ForgedFrame(Exception):  # noqa: N818 - reads as the state it names
    """Bytes were not written by the other side, or a body is not a message."""


class TooLarge(Exception):  # noqa: N818 - reads as the state it names
    """A message is too large for a frame."""


class Encoder:
    """Turns messages of one side into frames."""

    def __init__(self, key, sender, largest=LARGEST_BODY):
        self._key = key
        self._sender = sender
        self._largest = largest
        self._number = 0

    def __call__(self, message):
        """A message (a dictionary for JSON) as bytes. Raises TooLarge."""
        body = json.dumps(message, ensure_ascii=False, separators=(",", ":"), default=repr)
        body = body.encode("utf-8", "replace")
        if len(body) > self._largest:
            raise TooLarge(f"{len(body):,} bytes; the limit is {self._largest:,}")
        if (parts := _parts(body)) > self._largest // _BYTES_A_PART:
            raise TooLarge(f"{parts:,} values; the limit is {self._largest // _BYTES_A_PART:,}")
        length = _LENGTH.pack(len(body))
        tag = _sign(self._key, self._sender, self._number, b"head", length)[:_TAG_BYTES]
        signature = _sign(self._key, self._sender, self._number, b"body", body)
        self._number += 1
        return length + tag + signature + body


class Decoder:
    """Turns the frames of one side into messages."""

    def __init__(self, key, sender, largest=LARGEST_BODY):
        self._key = key
        self._sender = sender
        self._largest = largest
        self._number = 0
        self._buffer = bytearray()

    def feed(self, data):
        """The messages that ``data`` completes, as a list of dictionaries. Raises ForgedFrame."""
        self._buffer += data
        messages = []
        while len(self._buffer) >= _TAGGED:
            length = bytes(self._buffer[: _LENGTH.size])
            self._check(b"head", length, self._buffer[_LENGTH.size : _TAGGED])
            size = _LENGTH.unpack(length)[0]
            if size > self._largest:
                raise ForgedFrame(f"a frame has {size:,} bytes; the limit is {self._largest:,}")
            end = _HEAD + size
            if len(self._buffer) < end:
                break
            body = bytes(self._buffer[_HEAD:end])
            self._check(b"body", body, self._buffer[_TAGGED:_HEAD])
            del self._buffer[:end]
            self._number += 1
            if _parts(body) > self._largest // _BYTES_A_PART:
                raise ForgedFrame("a frame holds too many values")
            messages.append(_message(body))
        return messages

    def _check(self, part, data, tag):
        signature = _sign(self._key, self._sender, self._number, part, data)
        if not hmac.compare_digest(bytes(tag), signature[: len(tag)]):
            raise ForgedFrame(f"the {part.decode()} of a frame does not carry the right signature")


def _parts(body):
    """At least the number of values in a body."""
    return sum(map(body.count, (b",", b"[", b"{")))


def _message(body):
    try:
        message = json.loads(body)
    except (ValueError, RecursionError) as error:
        raise ForgedFrame(f"a frame does not hold JSON ({type(error).__name__})") from None
    if not isinstance(message, dict):
        raise ForgedFrame("a frame does not hold a message")
    return message


def _sign(key, sender, number, part, data):
    signer = hmac.new(key, b"/".join((sender, part, number.to_bytes(8, "big"), b"")), hashlib.sha256)
    signer.update(data)
    return signer.digest()
