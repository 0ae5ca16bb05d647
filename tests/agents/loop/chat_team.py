"""A team that is asked over chat completions: its answers are those of the Messages API, put in other words."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

from fake_chat_api import Called, Said

if TYPE_CHECKING:
    from collections.abc import Callable

    from fake_messages_api import Reply
    from team import Params


def chat_team(team: Callable[[Params], Reply]) -> Callable[[dict[str, Any]], Said]:
    """Answers requests of chat completions as ``team`` answers those of the Messages API."""

    def answer(body: dict[str, Any]) -> Said:
        reply = team(_params(body))
        texts = [block["text"] for block in reply.content if block["type"] == "text"]
        calls = tuple(
            Called(block["name"], _written(block["input"]), block["id"])
            for block in reply.content
            if block["type"] == "tool_use"
        )
        return Said("\n".join(texts) if reply.content else reply.text, calls=calls)

    return answer


def _written(given: Any) -> str:
    """A call's arguments; a text is what a model wrote instead of an object."""
    return given if isinstance(given, str) else json.dumps(given)


def _params(body: dict[str, Any]) -> Params:
    system, *rest = body["messages"]
    messages: list[dict[str, Any]] = []
    for message in rest:
        role = "assistant" if message["role"] == "assistant" else "user"
        content = list(_blocks(message))
        if messages and messages[-1]["role"] == role:
            messages[-1]["content"] += content
        else:
            messages.append({"role": role, "content": content})
    return {
        "model": body["model"],
        "system": [{"type": "text", "text": part} for part in re.split(r"\n\n(?=# )", system["content"])],
        "messages": messages,
        "tools": [{"name": tool["function"]["name"]} for tool in body.get("tools", ())],
    }


def _blocks(message: dict[str, Any]) -> list[dict[str, Any]]:
    if message["role"] == "tool":
        told = [{"type": "text", "text": message["content"]}]
        return [{"type": "tool_result", "tool_use_id": message["tool_call_id"], "content": told}]
    content = message.get("content") or []
    if isinstance(content, str):
        content = [{"type": "text", "text": content}]
    blocks = [one if one["type"] == "text" else {"type": "image"} for one in content]
    for call in message.get("tool_calls", ()):
        given = json.loads(call["function"]["arguments"])
        blocks.append(
            {"type": "tool_use", "id": call["id"], "name": call["function"]["name"], "input": given}
        )
    return blocks
