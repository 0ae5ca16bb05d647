"""An Ask as the Messages API takes it.

The prompt cache keeps the tools, the system prompt and the conversation so far: marks stand behind the last tool, the
last part of the system prompt, and the last two messages of the user (at the earlier of them the previous request
ended, so that it is found again), which are the four that the API allows.
"""

from __future__ import annotations

import base64
import re
from typing import TYPE_CHECKING, Any, cast

from simworlds.llm.messages import Ask, Block, Kept, Message, Picture, Text, ToolResult, ToolUse

if TYPE_CHECKING:
    from anthropic.types import (
        MessageParam,
        TextBlockParam,
        ToolParam,
    )
    from anthropic.types.message_create_params import MessageCreateParamsBase

_MARK = {"type": "ephemeral"}
_SILENT = "(no words)"
_EMPTY = "(nothing)"
# Claude 5 and later think unless told otherwise, and what they say between calls counts as thinking: shown only on
# request. Earlier models do not know the setting.
_THINKS = re.compile(r"\bclaude-[a-z]+-([5-9]|\d\d)(?!\d)")


def params_of(ask: Ask) -> MessageCreateParamsBase:
    """The parameters of ``messages.create`` and ``messages.stream``."""
    messages = [_message(message) for message in ask.messages]
    users = [message for message in messages if message["role"] == "user"]
    for message in users[-2:]:
        message["content"][-1]["cache_control"] = _MARK
    params: MessageCreateParamsBase = {
        "model": ask.model,
        "max_tokens": ask.max_tokens,
        "messages": cast("list[MessageParam]", messages),
    }
    system = [_text(part) for part in ask.system if part.strip()]
    if system:
        system[-1]["cache_control"] = _MARK
        params["system"] = cast("list[TextBlockParam]", system)
    if ask.tools:
        tools: list[dict[str, Any]] = [
            {"name": tool.name, "description": clean(tool.description), "input_schema": tool.schema}
            for tool in ask.tools
        ]
        tools[-1]["cache_control"] = _MARK
        params["tools"] = cast("list[ToolParam]", tools)
    if ask.form:
        # More than a second to import, which most who import this module can spare.
        from anthropic import transform_schema  # noqa: PLC0415

        schema = transform_schema(ask.form.schema)
        params["output_config"] = {"format": {"type": "json_schema", "schema": schema}}
    if _THINKS.search(ask.model):
        params["thinking"] = {"type": "adaptive", "display": "summarized"}
    return params


def clean(text: str) -> str:
    """``text`` without what JSON cannot carry: halves of characters, as broken output has them."""
    return text.encode(errors="replace").decode()


def _message(message: Message) -> dict[str, Any]:
    # The API takes no blank texts and no empty messages.
    content = [_block(block) for block in message.content if not _is_blank(block)]
    return {"role": message.role, "content": content or [_text(_SILENT)]}


def _is_blank(block: Block) -> bool:
    return isinstance(block, Text) and not block.text.strip()


def _text(text: str) -> dict[str, Any]:
    return {"type": "text", "text": clean(text)}


def _block(block: Block) -> dict[str, Any]:
    match block:
        case Text():
            return _text(block.text)
        case Picture():
            data = base64.b64encode(block.data).decode()
            return {
                "type": "image",
                "source": {"type": "base64", "media_type": block.media_type, "data": data},
            }
        case ToolUse():
            return {"type": "tool_use", "id": block.id, "name": block.name, "input": block.input}
        case ToolResult():
            return _result(block)
        case Kept():
            return dict(block.block)


def _result(block: ToolResult) -> dict[str, Any]:
    content = [_block(one) for one in block.content if not _is_blank(one)] or [_text(_EMPTY)]
    result: dict[str, Any] = {"type": "tool_result", "tool_use_id": block.id, "content": content}
    # The API takes pictures only with calls that succeeded; the words say what failed.
    if block.failed and all(one["type"] == "text" for one in content):
        result["is_error"] = True
    return result
