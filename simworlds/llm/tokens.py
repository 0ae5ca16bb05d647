"""Estimates numbers of tokens: offline, deterministic, and rather too high."""

from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING

from simworlds.llm.messages import Ask, Block, Kept, Message, Picture, Text, ToolResult, ToolUse

if TYPE_CHECKING:
    from collections.abc import Iterable

    from simworlds.llm.messages import Tool

_CHARS = 3.0  # of a token, in English with names, code and numbers
_AROUND = 8  # tokens around each block
_PATCH = 28  # pixels: a picture is seen in squares of this size, a token each
_LARGEST = 4784  # the most tokens of one picture: what is larger is scaled down
_PNG = b"\x89PNG\r\n\x1a\n"


def of_text(text: str) -> int:
    """The tokens of a text."""
    foreign = 0 if text.isascii() else sum(char > "\x7f" for char in text)
    return int((len(text) - foreign) / _CHARS) + foreign + 1


def of_picture(picture: Picture) -> int:
    """The tokens of a picture; of other formats than PNG, the most that any can have."""
    data = picture.data
    if not data.startswith(_PNG) or len(data) < 24:
        return _LARGEST
    width, height = struct.unpack(">II", data[16:24])
    return max(1, min(_LARGEST, -(-width // _PATCH) * -(-height // _PATCH)))


def of_block(block: Block) -> int:
    """The tokens of a block of a message."""
    match block:
        case Text():
            return _AROUND + of_text(block.text)
        case Picture():
            return _AROUND + of_picture(block)
        case ToolUse():
            return 4 * _AROUND + of_text(json.dumps(block.input, ensure_ascii=False))
        case ToolResult():
            return 4 * _AROUND + sum(map(of_block, block.content))
        case Kept():
            return of_text(json.dumps(block.block, ensure_ascii=False))


def of_message(message: Message) -> int:
    """The tokens of a message."""
    return _AROUND + sum(map(of_block, message.content))


def of_frame(system: Iterable[str], tools: Iterable[Tool]) -> int:
    """The tokens of what stands before the messages: the system prompt and the tools."""
    described = [json.dumps([tool.name, tool.description, tool.schema], ensure_ascii=False) for tool in tools]
    return sum(_AROUND + of_text(text) for text in [*system, *described])


def of_ask(ask: Ask) -> int:
    """The tokens of a whole request."""
    return of_frame(ask.system, ask.tools) + sum(map(of_message, ask.messages))
