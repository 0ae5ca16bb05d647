"""Requests and pictures for the tests of models."""

from __future__ import annotations

import struct
import zlib
from typing import TYPE_CHECKING, Any

from simworlds.llm.messages import Ask, Message, Tool, Turn, user

if TYPE_CHECKING:
    from collections.abc import Callable

MESSAGES = "POST /v1/messages"
OPUS = "claude-opus-5-5"
LOOK = Tool(
    "blender_object_preview",
    "A picture of an object.",
    {"type": "object", "properties": {"name": {"type": "string"}}, "required": ["name"]},
)
RUN = Tool("blender_execute", "Runs Python.", {"type": "object", "properties": {"code": {"type": "string"}}})


def ask(*messages: Message | str, **changes: Any) -> Ask:
    """A request of the coder's; texts are the user's messages."""
    given: dict[str, Any] = {
        "role": "coder",
        "stage": "modeling",
        "model": OPUS,
        "system": ("You write Blender Python.", "The plan: a table."),
        "messages": tuple(user(one) if isinstance(one, str) else one for one in messages or ("Begin.",)),
        "tools": (LOOK, RUN),
        "max_tokens": 1000,
        **changes,
    }
    return Ask(**given)


def png(width: int = 4, height: int = 4) -> bytes:
    """A grey picture."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = (b"\0" + b"\x80" * width) * height
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(rows))
        + chunk(b"IEND", b"")
    )


class Scripted:
    """A Model that answers with what it was given, one after another; errors are raised."""

    def __init__(self, *answers: Turn | Exception) -> None:
        self.answers = list(answers)
        self.asked: list[Ask] = []

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The next answer."""
        self.asked.append(ask)
        given = self.answers.pop(0)
        if isinstance(given, Exception):
            raise given
        return given
