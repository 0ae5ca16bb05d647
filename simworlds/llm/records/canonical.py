"""A request in the form in which it is compared with a recorded one.

What differs between two runs of the same conversation is left out or replaced, in this order:

1. folders that the caller names (the run's, say) become the names that he gives them, as ``<run>``;
2. absolute paths become ``<path>``, with the file's name where it has an ending: ``<path>/chair.png``;
3. dates and times of day become ``<time>``; UUIDs and numbers of eight or more hexadecimal digits ``<id>``;
4. durations (``0.31 s``, ``12 ms``, ``2 minutes``) become ``<duration>``, amounts of data (``1.2 MB``) ``<size>``;
5. spaces at the ends of lines go, line ends become newlines;
6. how fine a picture was rendered in the time that there was, and what was measured on its pixels, become
   ``<samples>``, ``<film>`` and ``<looks>``; that time was short is left out;
7. pictures become ``<picture image/png>``, whatever they show;
8. tool calls are named by their place in the conversation; the ids that the API gave them go;
9. the model's own thinking goes; so do the model's name and ``max_tokens``.

The rest is compared as it is, except that numbers with a decimal point are taken for equal when they differ by no more
than one percent or 0.001: physics is not the same to the last digit on every processor.
"""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from simworlds.llm.messages import Block, Kept, Picture, Text, ToolResult, ToolUse

if TYPE_CHECKING:
    from collections.abc import Mapping

    from simworlds.llm.messages import Ask, Message, Tool

_SAME_SHARE = 0.01
_SAME_APART = 0.001
_DECIMAL = re.compile(r"-?\d+\.\d+(?:[eE][+-]?\d+)?")
_STEP = r"[\w.@+~=,%-]+"
_PATHS = re.compile(
    rf"(?<![\w.:/<>~-])/(?:{_STEP}/)+(?P<file>{_STEP})?"
    r"|(?<!\w)[A-Za-z]:(?:\\{1,2}|/)(?:[^\s\\/\"'<>|:*?]+(?:\\{1,2}|/))*(?P<name>[^\s\\/\"'<>|:*?]+)?"
)
_AMOUNT = r"(?<![\w.])\d+(?:\.\d+)?\s?"
_RULES = (
    (re.compile(r"\b\d{4}-\d\d-\d\d(?:[T ]\d\d:\d\d(?::\d\d(?:\.\d+)?)?(?:Z|[+-]\d\d:?\d\d)?)?\b"), "<time>"),
    (re.compile(r"\b\d{1,2}:\d\d:\d\d(?:\.\d+)?\b"), "<time>"),
    (re.compile(r"\b[0-9a-fA-F]{8}(?:-[0-9a-fA-F]{4}){3}-[0-9a-fA-F]{12}\b"), "<id>"),
    (re.compile(r"\b(?=[0-9a-f]*[0-9])(?=[0-9a-f]*[a-f])[0-9a-f]{8,}\b"), "<id>"),
    (re.compile(_AMOUNT + r"(?:[mµn]?s|secs?|seconds?|mins?|minutes?|h|hours?)\b"), "<duration>"),
    (re.compile(_AMOUNT + r"(?:bytes?|[kKMGT]i?B)\b"), "<size>"),
    (re.compile(r"\r\n?"), "\n"),
    (re.compile(r"[ \t]+$", re.MULTILINE), ""),
    (re.compile(r"^- To keep the time budget: \d+ samples? instead of \d+\.\n?", re.MULTILINE), ""),
    (re.compile(r"^The film(?:: \d+ frames, |'s samples: ).*$", re.MULTILINE), "<film>"),
    (
        re.compile(r"^(- Frame -?\d+)(?:: \d+ % black|, share of the picture).*$", re.MULTILINE),
        r"\1: <looks>",
    ),
    (
        re.compile(r"^(\d+ frames? rendered in .*\(camera .*, )\d+×\d+(, .*\)\.)$", re.MULTILINE),
        r"\1<film>\2",
    ),
    (re.compile(r"(?<=, )\d+ samples?\b"), "<samples>"),
)


@dataclass(frozen=True, slots=True)
class FormPart:
    """The system prompt, the tools or a message, as text."""

    name: str
    text: str

    @property
    def digest(self) -> str:
        """The same for the same part."""
        return hashlib.sha256(f"{self.name}\n{self.text}".encode(errors="replace")).hexdigest()[:16]


@dataclass(frozen=True, slots=True)
class Form:
    """A whole request: the system prompt, the tools, then the messages."""

    role: str
    parts: tuple[FormPart, ...]

    @property
    def digest(self) -> str:
        """The same for the same request of the same role."""
        return hashlib.sha256(
            "\n".join([self.role, *(part.digest for part in self.parts)]).encode()
        ).hexdigest()


def form_of(ask: Ask, folders: Mapping[str, str] | None = None) -> Form:
    """The form of a request. ``folders`` gives names to folders: ``{"/data/runs/7": "run"}``."""
    calls: dict[str, int] = {}
    written = [
        ("system prompt", "\n\n".join(ask.system)),
        ("tools", "\n\n".join(map(_tool, ask.tools))),
        *(
            (f"message {number} ({message.role})", _message(message, calls))
            for number, message in enumerate(ask.messages, 1)
        ),
    ]
    return Form(ask.role, tuple(FormPart(name, normal(text, folders)) for name, text in written))


def normal(text: str, folders: Mapping[str, str] | None = None) -> str:
    """``text`` by the rules 1 to 6."""
    for folder in sorted(folders or {}, key=len, reverse=True):
        text = text.replace(folder.rstrip("/\\"), f"<{(folders or {})[folder]}>")
    text = _PATHS.sub(_path, text)
    for pattern, instead in _RULES:
        text = pattern.sub(instead, text)
    return text


def alike(one: str, other: str) -> bool:
    """Whether two normal texts are the same but for the last digits of their decimal numbers."""
    if one == other:
        return True
    if _DECIMAL.split(one) != _DECIMAL.split(other):
        return False
    pairs = zip(_DECIMAL.findall(one), _DECIMAL.findall(other), strict=True)
    return all(_near(float(a), float(b)) for a, b in pairs)


def _near(a: float, b: float) -> bool:
    return abs(a - b) <= max(_SAME_APART, _SAME_SHARE * max(abs(a), abs(b)))


def _path(found: re.Match[str]) -> str:
    last = found["file"] or found["name"] or ""
    return f"<path>/{last}" if "." in last.strip(".") else "<path>"


def _tool(tool: Tool) -> str:
    return f"{tool.name}: {tool.description}\n{json.dumps(tool.schema, sort_keys=True, ensure_ascii=False)}"


def _message(message: Message, calls: dict[str, int]) -> str:
    return "\n".join(filter(None, (_block(block, calls) for block in message.content)))


def _block(block: Block, calls: dict[str, int]) -> str:
    match block:
        case Text():
            return block.text
        case Picture():
            return f"<picture {block.media_type}>"
        case ToolUse():
            calls.setdefault(block.id, len(calls) + 1)
            given = [_argument(name, block.input[name]) for name in sorted(block.input)]
            return "\n".join([f"<call {calls[block.id]}: {block.name}>", *given])
        case ToolResult():
            failed = ", failed" if block.failed else ""
            inner = [_block(one, calls) for one in block.content]
            return "\n".join([f"<result of call {calls.get(block.id, '?')}{failed}>", *inner])
        case Kept():
            return ""


def _argument(name: str, value: Any) -> str:
    if isinstance(value, str):
        return f"{name}:\n{value}" if "\n" in value else f"{name}: {value}"
    return f"{name}: {json.dumps(value, sort_keys=True, ensure_ascii=False)}"
