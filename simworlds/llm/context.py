"""Keeps a conversation within a token budget.

``fit`` takes the conversation as it was last sent, with what is new at its end, and gives the one to send now and to go
on with. Within the budget nothing changes, so that the prompt cache holds. Beyond it, enough goes at once to have room
for a while, the oldest first: pictures and long outputs become references that say how to see them again, then whole
exchanges go, then long outputs of the newest. A tool call and its result stay or go together.

Two things are always there: what stands before the model's first turn (its task), and what is ``pinned`` (the plan,
open findings), which is said again in the last message where it went or has not been said.

Models bind their thinking to all that went before it. What is behind a change goes on without its earlier thinking,
which the API would refuse.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import TYPE_CHECKING

from simworlds.llm import tokens
from simworlds.llm.errors import TooLong
from simworlds.llm.messages import Kept, Picture, Text, ToolResult, ToolUse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from simworlds.llm.messages import Block, Message

_HEAD = 300  # characters of a long output that stay
_ARGUMENTS = 80
GONE = "[Earlier exchanges are left out to save space. The scene is as they left it.]"


@dataclass(frozen=True, slots=True)
class ContextLimits:
    """How much of a conversation is kept.

    Beyond ``budget`` tokens (by estimate) or ``pictures`` (of more than 20, the API takes only small ones) it shrinks
    to the share ``down_to`` of them. The ``newest`` exchanges stay whole as long as possible. Outputs of more than
    ``long`` characters can be shortened.
    """

    budget: int = 150_000
    pictures: int = 20
    down_to: float = 0.6
    newest: int = 3
    long: int = 1500


def fit(
    messages: Sequence[Message],
    limits: ContextLimits | None = None,
    *,
    pinned: Sequence[str] = (),
    frame: int = 0,
) -> tuple[Message, ...]:
    """The conversation within ``limits``. The last message is the user's, and was not sent yet.

    ``frame`` is the size of the system prompt and the tools (``tokens.of_frame``). Raises TooLong if it cannot
    be made to fit.
    """
    limits = limits or ContextLimits()
    fitting = _with_pinned(messages, pinned)
    if not _is_over(fitting, limits, 1.0, frame):
        return fitting
    for smaller, share in _smaller(messages, limits):
        fitting = _with_pinned(smaller, pinned)
        if not _is_over(fitting, limits, share, frame):
            break
    if _is_over(fitting, limits, 1.0, frame):
        size = frame + sum(map(tokens.of_message, fitting))
        raise TooLong(
            f"The conversation does not fit into {limits.budget} tokens: what must stay has about {size}."
        )
    return _without_stale_thinking(messages, fitting)


def _smaller(
    messages: Sequence[Message], limits: ContextLimits
) -> Iterator[tuple[tuple[Message, ...], float]]:
    """The conversation ever smaller, a step at a time, each with the share of the limits that is small enough."""
    calls = {
        block.id: block for message in messages for block in message.content if isinstance(block, ToolUse)
    }
    starts = [place for place, message in enumerate(messages) if message.role == "assistant"]
    task = list(messages[: starts[0]] if starts else messages)
    exchanges = [list(messages[start:end]) for start, end in pairwise([*starts, len(messages)])]
    old = max(0, len(exchanges) - limits.newest)

    def shortened(exchange: list[Message]) -> list[Message]:
        return [_shorter_message(message, calls, limits) for message in exchange]

    for place in range(old):
        exchanges[place] = shortened(exchanges[place])
        yield tuple(chain(task, *exchanges)), limits.down_to
    if old:
        task = _with_note(task)
    for _ in range(old):
        del exchanges[0]
        yield tuple(chain(task, *exchanges)), limits.down_to
    yield tuple(chain(task, *exchanges)), 1.0
    for place in range(len(exchanges)):
        exchanges[place] = shortened(exchanges[place])
        yield tuple(chain(task, *exchanges)), 1.0


def _with_note(task: list[Message]) -> list[Message]:
    *before, last = task
    if Text(GONE) in last.content:
        return task
    return [*before, replace(last, content=(*last.content, Text(GONE)))]


def _with_pinned(messages: Sequence[Message], pinned: Sequence[str]) -> tuple[Message, ...]:
    """The messages, with what is pinned and cannot be read in them at the end of the last."""
    said = [text for message in messages for text in _texts(message.content)]
    missing = [Text(pin) for pin in pinned if not any(pin in text for text in said)]
    if not missing:
        return tuple(messages)
    *before, last = messages
    return (*before, replace(last, content=(*last.content, *missing)))


def _is_over(messages: Sequence[Message], limits: ContextLimits, share: float, frame: int) -> bool:
    pictures = sum(_pictures(message.content) for message in messages)
    size = frame + sum(map(tokens.of_message, messages))
    return size > limits.budget * share or pictures > limits.pictures * share


def _without_stale_thinking(before: Sequence[Message], after: tuple[Message, ...]) -> tuple[Message, ...]:
    """``after``, without the thinking that was bound to what ``before`` said differently."""
    same = next(
        (place for place, (a, b) in enumerate(zip(before, after, strict=False)) if a != b), len(after)
    )
    fresh = [
        replace(message, content=tuple(block for block in message.content if not isinstance(block, Kept)))
        for message in after[same:]
    ]
    return (*after[:same], *fresh)


def _shorter_message(message: Message, calls: dict[str, ToolUse], limits: ContextLimits) -> Message:
    if message.role == "assistant":
        return message
    return replace(message, content=tuple(_shorter(block, calls, limits) for block in message.content))


def _shorter(block: Block, calls: dict[str, ToolUse], limits: ContextLimits) -> Block:
    if not isinstance(block, ToolResult):
        return _reference(block, "", limits) if isinstance(block, (Text, Picture)) else block
    call = calls.get(block.id)
    again = f"; call {_call_of(call)} again for what it is now" if call else ""
    return replace(block, content=tuple(_reference(one, again, limits) for one in block.content))


def _reference(block: Text | Picture, again: str, limits: ContextLimits) -> Text:
    if isinstance(block, Picture):
        return Text(f"[A picture is left out to save space{again}.]")
    more = len(block.text) - _HEAD
    if len(block.text) <= limits.long:
        return block
    return Text(f"{block.text[:_HEAD]}\n[{more} more characters are left out to save space{again}.]")


def _call_of(call: ToolUse) -> str:
    given = json.dumps(call.input, ensure_ascii=False)[1:-1]
    return f"{call.name}({given if len(given) <= _ARGUMENTS else given[:_ARGUMENTS] + '…'})"


def _texts(content: Iterable[Block]) -> Iterator[str]:
    for block in content:
        if isinstance(block, Text):
            yield block.text
        elif isinstance(block, ToolResult):
            yield from _texts(block.content)


def _pictures(content: Iterable[Block]) -> int:
    return sum(
        _pictures(block.content) if isinstance(block, ToolResult) else isinstance(block, Picture)
        for block in content
    )
