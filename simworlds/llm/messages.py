"""Requests to models and their answers, as immutable records, for every provider."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True, slots=True)
class Text:
    """Words."""

    text: str
    type: Literal["text"] = "text"


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture that the model sees: the bytes of a PNG, JPEG, GIF or WebP file."""

    data: bytes = field(repr=False)
    media_type: str = "image/png"
    type: Literal["picture"] = "picture"


@dataclass(frozen=True, slots=True)
class ToolUse:
    """The model calls a tool. ``fault``: why the call cannot be made, where its arguments could not be read."""

    id: str
    name: str
    input: dict[str, Any]
    fault: str = ""
    type: Literal["tool_use"] = "tool_use"


@dataclass(frozen=True, slots=True)
class ToolResult:
    """What came of the call with this ``id``. ``failed``: not what the model wanted."""

    id: str
    content: tuple[Text | Picture, ...]
    failed: bool = False
    type: Literal["tool_result"] = "tool_result"


@dataclass(frozen=True, slots=True)
class Kept:
    """A block that only the API reads (the model's own thinking), as it came: it goes back unchanged or not at all."""

    block: dict[str, Any] = field(repr=False)
    type: Literal["kept"] = "kept"


Block = Text | Picture | ToolUse | ToolResult | Kept


@dataclass(frozen=True, slots=True)
class Message:
    """One side's part of a conversation."""

    role: Literal["user", "assistant"]
    content: tuple[Block, ...]


def user(*content: Block | str) -> Message:
    """The user's part, from blocks and texts."""
    return Message("user", tuple(Text(one) if isinstance(one, str) else one for one in content))


@dataclass(frozen=True, slots=True)
class Tool:
    """A tool that the model may call; ``schema`` is the JSON Schema of its arguments."""

    name: str
    description: str
    schema: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Ask:
    """One request. ``stage`` is a label to count by (``""`` outside of any).

    ``system`` holds the parts of the system prompt in order. Within one conversation, it and ``tools`` stay the same:
    models with a memory of their thinking, and the prompt cache, rely on that. ``form``: what the answer has to be, as
    the name, description and schema of a JSON object; APIs with structured outputs hold the model to it.
    """

    role: str
    stage: str
    model: str
    system: tuple[str, ...]
    messages: tuple[Message, ...]
    tools: tuple[Tool, ...] = ()
    max_tokens: int = 16_000
    form: Tool | None = None


@dataclass(frozen=True, slots=True)
class Usage:
    """Tokens. ``input`` are those at full price: what was read from the prompt cache or written to it is beside."""

    input: int = 0
    output: int = 0
    cache_read: int = 0
    cache_write: int = 0

    def __add__(self, other: Usage) -> Usage:
        return Usage(
            self.input + other.input,
            self.output + other.output,
            self.cache_read + other.cache_read,
            self.cache_write + other.cache_write,
        )

    @property
    def prompt(self) -> int:
        """All input tokens."""
        return self.input + self.cache_read + self.cache_write


@dataclass(frozen=True, slots=True)
class Turn:
    """What a model answered.

    ``lost`` was used up by attempts at this answer that broke off, as far as that is known. ``cost`` is the list price
    of both in US dollars, None where no price is known. ``stop_details`` says why it declined. Only what a model
    answered just now is ``live``. ``content`` may be empty: models do say nothing.
    """

    content: tuple[Block, ...]
    stop_reason: str
    usage: Usage = Usage()
    model: str = ""
    cost: float | None = None
    lost: Usage = Usage()
    stop_details: str = ""
    live: bool = False

    @property
    def text(self) -> str:
        """The words, without calls and thinking."""
        return "\n".join(block.text for block in self.content if isinstance(block, Text))

    @property
    def calls(self) -> tuple[ToolUse, ...]:
        """The tools that the model calls, in order."""
        return tuple(block for block in self.content if isinstance(block, ToolUse))

    def message(self) -> Message:
        """The turn as the assistant's part of the conversation."""
        return Message("assistant", self.content)


class Model(Protocol):
    """Whatever answers."""

    def answer(self, ask: Ask, on_text: Callable[[str], object] | None = None) -> Turn:
        """The model's turn. ``on_text`` gets what it writes as it comes, thinking that it shows included.

        What came of an attempt that broke off is not taken back; the whole answer follows. Raises ModelError.
        """
        ...
