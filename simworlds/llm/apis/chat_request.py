"""An Ask as the chat completions API takes it."""

from __future__ import annotations

import base64
import json
from typing import TYPE_CHECKING, Any, cast

from simworlds.llm.apis.claude_request import clean
from simworlds.llm.messages import Picture, Text, ToolResult, ToolUse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from simworlds.llm.messages import Ask, Block, Message, Tool

_SILENT = "(no words)"
_EMPTY = "(nothing)"
_FAILED = "This call failed: "
_SHOWN = "(The pictures follow.)"


def chat_params_of(ask: Ask) -> dict[str, Any]:
    """The parameters of ``chat.completions.create`` for a streamed answer, but for its limit of tokens."""
    system = {"role": "system", "content": clean("\n\n".join(ask.system))}
    messages = [part for message in ask.messages for part in _messages(message)]
    params: dict[str, Any] = {
        "model": ask.model,
        "messages": [system, *messages],
        "stream": True,
        "stream_options": {"include_usage": True},
    }
    if ask.tools:
        params["tools"] = [_tool(tool) for tool in ask.tools]
    if ask.form:
        params["response_format"] = {
            "type": "json_schema",
            "json_schema": {
                "name": ask.form.name,
                "description": clean(ask.form.description),
                "schema": ask.form.schema,
                "strict": _is_strict(ask.form.schema),
            },
        }
    return params


def _is_strict(schema: Any) -> bool:
    """Whether every object of a schema requires all of its fields and takes no others, as strict schemas have to."""
    if isinstance(schema, list):
        return all(map(_is_strict, cast("list[Any]", schema)))
    if not isinstance(schema, dict):
        return True
    own = cast("dict[str, Any]", schema)
    if own.get("type") == "object":
        closed = own.get("additionalProperties") is False
        if not closed or set(own.get("required", ())) != set(own.get("properties", {})):
            return False
    return all(map(_is_strict, own.values()))


def _tool(tool: Tool) -> dict[str, Any]:
    return {
        "type": "function",
        "function": {
            "name": tool.name,
            "description": clean(tool.description),
            "parameters": tool.schema,
        },
    }


def _messages(message: Message) -> Iterator[dict[str, Any]]:
    """A message: results of calls stand in messages of their own, and the pictures in them go to the user's."""
    if message.role == "assistant":
        yield _assistant(message.content)
        return
    parts: list[dict[str, Any]] = []
    for block in message.content:
        if isinstance(block, ToolResult):
            yield _result(block)
            parts += [_picture(one) for one in block.content if isinstance(one, Picture)]
        elif isinstance(block, Picture):
            parts.append(_picture(block))
        elif isinstance(block, Text) and block.text.strip():
            parts.append(_text(block.text))
    if parts or not any(isinstance(block, ToolResult) for block in message.content):
        yield {"role": "user", "content": parts or [_text(_SILENT)]}


def _assistant(content: Iterable[Block]) -> dict[str, Any]:
    words = "\n".join(block.text for block in content if isinstance(block, Text))
    calls = [_call(block) for block in content if isinstance(block, ToolUse)]
    if calls:
        return {"role": "assistant", "content": clean(words) or None, "tool_calls": calls}
    return {"role": "assistant", "content": clean(words) or _SILENT}


def _call(call: ToolUse) -> dict[str, Any]:
    # Servers parse what they are given here: a call that was not JSON goes back as an empty one.
    given = json.dumps(call.input, ensure_ascii=False)
    return {
        "id": call.id,
        "type": "function",
        "function": {"name": call.name, "arguments": clean(given)},
    }


def _result(result: ToolResult) -> dict[str, Any]:
    words = [one.text for one in result.content if isinstance(one, Text) and one.text.strip()]
    if any(isinstance(one, Picture) for one in result.content):
        words.append(_SHOWN)
    said = "\n\n".join(words) or _EMPTY
    return {
        "role": "tool",
        "tool_call_id": result.id,
        "content": clean(f"{_FAILED}{said}" if result.failed else said),
    }


def _text(text: str) -> dict[str, Any]:
    return {"type": "text", "text": clean(text)}


def _picture(picture: Picture) -> dict[str, Any]:
    data = base64.b64encode(picture.data).decode()
    address = {"url": f"data:{picture.media_type};base64,{data}", "detail": "high"}
    return {"type": "image_url", "image_url": address}
