"""What the Messages API demands of a request, and how it keeps prompts: for the local server that stands for it."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

MARKS = 4
"""The most places of one request that may be marked with ``cache_control``."""

LOOK_BACK = 20
"""So many blocks before a mark a kept prefix is still found."""

BOUND = "bound:"
_NAME = re.compile(r"[a-zA-Z0-9_-]{1,128}")
_USERS = ("text", "image", "document", "tool_result")
_ASSISTANTS = ("text", "tool_use", "thinking", "redacted_thinking")
_IMAGES = ("image/png", "image/jpeg", "image/gif", "image/webp")


def problem(params: dict[str, Any]) -> str:
    """What the API would object to in the tools, the system prompt or the messages; or nothing."""
    for index, tool in enumerate(params.get("tools") or ()):
        if not _NAME.fullmatch(str(tool.get("name"))) or "input_schema" not in tool:
            return f"tools.{index}: a name of [a-zA-Z0-9_-] and an input_schema are required"
    marks = sum("cache_control" in block for block in _blocks(params))
    if marks > MARKS:
        return f"A maximum of {MARKS} blocks with cache_control may be provided. Found {marks}."
    system = params.get("system") or ()
    if not isinstance(system, str) and not all(block.get("text", "").strip() for block in system):
        return "system: text content blocks must be non-empty"
    return _problem_of_messages(params["messages"]) or _problem_of_thinking(params)


def sign(params: dict[str, Any], content: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The blocks of an answer, its thinking bound to the conversation that it answers."""
    signed: list[dict[str, Any]] = []
    for block in content:
        if block["type"] == "thinking" and not block.get("signature"):
            block = {**block, "signature": _bound(params, params["messages"], signed)}
        signed.append(block)
    return signed


@dataclass
class PromptCache:
    """The prefixes that were kept so far."""

    kept: set[str] = field(default_factory=set)

    def usage(self, params: dict[str, Any]) -> dict[str, int]:
        """The input tokens of a request, by how they are charged."""
        blocks = list(_blocks(params))
        prefixes = _prefixes(params, blocks)
        tokens = [len(json.dumps(_bare(block))) // 4 for block in blocks]
        marks = [place for place, block in enumerate(blocks) if "cache_control" in block]
        read = written = 0
        for mark in marks:
            seen = [at for at in range(mark, max(-1, mark - LOOK_BACK), -1) if prefixes[at] in self.kept]
            read = max(read, (seen[0] + 1) if seen else 0)
            written = max(written, mark + 1)
        self.kept.update(prefixes[mark] for mark in marks)
        return {
            "input_tokens": sum(tokens[max(read, written) :]),
            "cache_creation_input_tokens": sum(tokens[read:written]),
            "cache_read_input_tokens": sum(tokens[:read]),
        }


def _blocks(params: dict[str, Any]) -> Iterator[dict[str, Any]]:
    yield from params.get("tools") or ()
    system = params.get("system") or ()
    yield from [{"type": "text", "text": system}] if isinstance(system, str) else system
    for message in params["messages"]:
        yield from _content(message)


def _content(message: dict[str, Any]) -> list[dict[str, Any]]:
    content = message.get("content")
    return [{"type": "text", "text": content}] if isinstance(content, str) else content or []


def _bare(block: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in block.items() if key != "cache_control"}


def _prefixes(params: dict[str, Any], blocks: list[dict[str, Any]]) -> list[str]:
    digest = hashlib.sha256(params["model"].encode())
    prefixes: list[str] = []
    for block in blocks:
        digest.update(json.dumps(_bare(block), sort_keys=True).encode())
        prefixes.append(digest.hexdigest())
    return prefixes


def _problem_of_messages(messages: list[dict[str, Any]]) -> str:
    open_calls: list[str] = []
    for index, message in enumerate(messages):
        content = _content(message)
        if not content:
            return f"messages.{index}: all messages must have non-empty content"
        results = [block["tool_use_id"] for block in content if block.get("type") == "tool_result"]
        if missing := [call for call in open_calls if call not in results]:
            return (
                f"messages.{index - 1}: `tool_use` ids were found without `tool_result` blocks immediately "
                f"after: {', '.join(missing)}"
            )
        if unknown := [call for call in results if call not in open_calls]:
            return f"messages.{index}: unexpected `tool_use_id` found in `tool_result` blocks: {', '.join(unknown)}"
        for place, block in enumerate(content):
            if wrong := _problem_of_block(block, message["role"]):
                return f"messages.{index}.content.{place}: {wrong}"
        open_calls = [block["id"] for block in content if block.get("type") == "tool_use"]
    return f"`tool_use` ids were found without results: {', '.join(open_calls)}" if open_calls else ""


def _problem_of_block(block: dict[str, Any], role: str) -> str:
    kind = block.get("type")
    if kind not in (*_USERS, *_ASSISTANTS):
        return f"Input tag {kind!r} is not expected"
    if kind not in (_USERS if role == "user" else _ASSISTANTS):
        return f"`{kind}` blocks can not be in `{role}` messages"
    if kind == "text":
        return "" if block["text"].strip() else "text content blocks must contain non-whitespace text"
    if kind == "tool_use":
        return "" if isinstance(block["input"], dict) else "input: Input should be an object"
    if kind == "image":
        return _problem_of_image(block["source"])
    if kind == "tool_result":
        inner = _content(block)
        if block.get("is_error") and any(one["type"] != "text" for one in inner):
            return "all content must be type `text` if `is_error` is true"
        return next(filter(None, (_problem_of_block(one, "user") for one in inner)), "")
    return ""


def _problem_of_image(source: dict[str, Any]) -> str:
    if source.get("media_type") not in _IMAGES:
        return f"media_type: Input should be one of {_IMAGES}"
    try:
        return "" if base64.b64decode(source["data"], validate=True) else "image cannot be empty"
    except ValueError:
        return "data: invalid base64 data"


def _bound(params: dict[str, Any], before: list[dict[str, Any]], beside: list[dict[str, Any]]) -> str:
    """A signature: what stood before a thinking block when it was thought, apart from the marks of the cache."""
    system = params.get("system") or ""
    seen = [
        [_bare(tool) for tool in params.get("tools") or ()],
        system if isinstance(system, str) else [_bare(block) for block in system],
        [[message["role"], [_bare(block) for block in _content(message)]] for message in before],
        [_bare(block) for block in beside],
    ]
    return BOUND + hashlib.sha256(json.dumps(seen, sort_keys=True).encode()).hexdigest()[:16]


def _problem_of_thinking(params: dict[str, Any]) -> str:
    messages = params["messages"]
    for index, message in enumerate(messages):
        content = _content(message)
        for place, block in enumerate(content):
            signature = block.get("signature", "") if block.get("type") == "thinking" else ""
            if signature.startswith(BOUND) and signature != _bound(params, messages[:index], content[:place]):
                return (
                    f"messages.{index}.content.{place}: Invalid `signature` in `thinking` block. The block is "
                    "bound to a different conversation."
                )
    return ""
