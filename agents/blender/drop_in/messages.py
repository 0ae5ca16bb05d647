"""Messages on a socket: JSON objects one after the other, with nothing between them."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

LONGEST = 8 << 20
"""Bytes of a message: the longest code that is run, with every character escaped, fits in."""
_DEEPEST = 200
_OUTSIDE = re.compile(rb'["{}]')
_SPACE = re.compile(rb"\s*")
_IN_STRING = re.compile(rb'["\\]')
_SHOWN = 40


class NotMessages(Exception):  # noqa: N818 - reads as the state it names
    """What came is not such messages, so where the next one would begin cannot be told."""


class MessageSplitter:
    """Cuts what a socket brings into messages, wherever its pieces end.

    A message ends with the bracket that closes its first one. Whether it is valid JSON is for ``parse`` to say.
    """

    def __init__(self) -> None:
        self._begun = bytearray()
        self._seen = 0  # bytes of what has begun that were looked at
        self._depth = 0
        self._in_string = False

    @property
    def has_begun(self) -> bool:
        """Whether a part of a message is here."""
        return bool(self._begun)

    def feed(self, data: bytes) -> Iterator[bytes]:
        """Takes the next bytes; yields the messages that end in them. Raises NotMessages."""
        self._begun += data
        while True:
            if not self._depth:
                if space := _SPACE.match(self._begun):
                    del self._begun[: space.end()]
                if not self._begun:
                    return
                if not self._begun.startswith(b"{"):
                    start = bytes(self._begun[:_SHOWN]).decode(errors="replace")
                    raise NotMessages(
                        f"This is not a message: it begins with {start!r}. A message is one JSON object, such as "
                        '{"type": "get_scene_info", "params": {}}. The connection is closed.'
                    )
            end = self._end()
            if len(self._begun) > LONGEST and not 0 < end <= LONGEST:
                raise NotMessages(
                    f"The message is longer than {LONGEST:,} bytes. Send less at once: large data belongs in files "
                    "that the server may read (--read). The connection is closed."
                )
            if not end:
                return
            message = bytes(self._begun[:end])
            del self._begun[:end]
            self._seen = 0
            yield message

    def _end(self) -> int:
        """Where the message that has begun ends; 0 if it goes on."""
        while True:
            hit = (_IN_STRING if self._in_string else _OUTSIDE).search(self._begun, self._seen)
            if hit is None:
                self._seen = max(self._seen, len(self._begun))
                return 0
            self._seen = hit.end()
            character = hit[0]
            if character == b"\\":
                self._seen += 1  # whatever is escaped; it may not have come yet
            elif character == b'"':
                self._in_string = not self._in_string
            elif character == b"{":
                self._depth += 1
                if self._depth > _DEEPEST:
                    raise NotMessages(
                        f"The message nests more than {_DEEPEST} objects. The connection is closed."
                    )
            else:
                self._depth -= 1
                if not self._depth:
                    return self._seen


def parse(message: bytes) -> dict[str, Any]:
    """A message as data. Raises ValueError, which says what is wrong with it."""
    try:
        return json.loads(message.decode())
    except UnicodeDecodeError as error:
        raise ValueError(f"it is not UTF-8 ({error.reason} at byte {error.start})") from error
    except json.JSONDecodeError as error:
        raise ValueError(f"it is not valid JSON: {error.msg} at character {error.pos}") from error
    except RecursionError as error:
        raise ValueError("its lists are nested too deeply") from error
