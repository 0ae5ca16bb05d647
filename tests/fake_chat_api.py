"""A local HTTP server that streams OpenAI's chat completions, with tools and structured outputs, for the real client.

It checks requests as the API does (key, messages, calls and their results, pictures, the rules of strict schemas),
remembers them in ``requests``, and answers with what ``answer(params)`` returns, in the pieces that a ``dialect`` of
the servers in use makes of it. Faults are scripted and used up one by one.
"""

from __future__ import annotations

import base64
import contextlib
import json
import re
import threading
from collections import deque
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any, Self

from fake_messages_api import Drop, Raw, Status, Truncate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

Fault = Status | Drop | Raw | Truncate
ROUTE = "/v1/chat/completions"


@dataclass(frozen=True)
class Called:
    """A call of a tool; ``arguments`` as the model wrote them."""

    name: str
    arguments: str = "{}"
    id: str = "call_abc"


@dataclass(frozen=True)
class Said:
    """A completion. ``thinking`` is what local servers stream beside the words."""

    text: str | None = "Hello."
    finish_reason: str = "stop"
    calls: tuple[Called, ...] = ()
    thinking: str = ""
    refusal: str | None = None
    prompt_tokens: int = 100
    completion_tokens: int = 20
    cached_tokens: int = 0


class FakeChatAPI:
    """See the module."""

    def __init__(
        self, answer: Callable[[dict[str, Any]], Said] = lambda params: Said(), *, dialect: str = "openai"
    ) -> None:
        """``dialect``: one of DIALECTS."""
        self.answer = answer
        self.dialect = dialect
        self.takes = "max_completion_tokens"  # the name of the limit that this server knows
        self.needs_key = True
        self.requests: list[dict[str, Any]] = []
        self._faults: deque[Fault] = deque()
        api = self

        class Handler(_Handler):
            server_api = api

        self._server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self._server.daemon_threads = True
        self.base_url = f"http://127.0.0.1:{self._server.server_port}/v1"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def fail(self, *faults: Fault) -> None:
        """The next requests meet these faults."""
        self._faults.extend(faults)

    def next_fault(self) -> Fault | None:
        return self._faults.popleft() if self._faults else None

    def respond(self, path: str, authorization: str, body: Any) -> tuple[int, Any]:
        """Status and body of the reply."""
        if path != ROUTE:
            return error(404, f"no such path: {path}")
        if self.needs_key and not authorization.startswith("Bearer "):
            return error(401, "Incorrect API key provided")
        other = {"max_tokens", "max_completion_tokens"} - {self.takes}
        if other & set(body):
            return error(400, f"Unsupported parameter: '{other.pop()}' is not supported with this model.")
        if problem := problem_of(body):
            return error(400, problem)
        return 200, self._chunks(body, self.answer(body))

    def _chunks(self, body: dict[str, Any], said: Said) -> list[dict[str, Any]]:
        head = {
            "id": f"chatcmpl-{len(self.requests)}",
            "object": "chat.completion.chunk",
            "created": 1_790_000_000,
            "model": f"{body['model']}-2026-04-23",
        }
        text = said.text or ""
        deltas: list[dict[str, Any]] = [{"role": "assistant", "content": ""}]
        deltas += [{"reasoning_content": said.thinking}] if said.thinking else []
        deltas += [{"content": text[at : at + 7]} for at in range(0, len(text), 7)]
        deltas += [{"refusal": said.refusal}] if said.refusal else []
        deltas += [{"tool_calls": [piece]} for piece in DIALECTS[self.dialect](said.calls)]
        stop = "tool_calls" if said.calls and said.finish_reason == "stop" else said.finish_reason
        chunks = [
            {**head, "choices": [{"index": 0, "delta": delta, "finish_reason": None}]} for delta in deltas
        ]
        chunks.append({**head, "choices": [{"index": 0, "delta": {}, "finish_reason": stop}]})
        usage = {
            "prompt_tokens": said.prompt_tokens,
            "completion_tokens": said.completion_tokens,
            "total_tokens": said.prompt_tokens + said.completion_tokens,
            "prompt_tokens_details": {"cached_tokens": said.cached_tokens},
        }
        if body.get("stream_options", {}).get("include_usage"):
            chunks.append({**head, "choices": [], "usage": usage})
        return chunks


def _openai(calls: tuple[Called, ...]) -> Iterator[dict[str, Any]]:
    """Index and id first, then the arguments in pieces."""
    for index, call in enumerate(calls):
        yield _piece(call, "", index=index, id=call.id, named=True)
        for at in range(0, len(call.arguments), 5):
            yield _piece(call, call.arguments[at : at + 5], index=index)


def _whole(calls: tuple[Called, ...]) -> Iterator[dict[str, Any]]:
    """Each call in one piece, all with the index 0 and ids of their own."""
    for number, call in enumerate(calls):
        yield _piece(call, call.arguments, index=0, id=f"{call.id}{number}", named=True)


def _blank(calls: tuple[Called, ...]) -> Iterator[dict[str, Any]]:
    """The index is always 0, and the id of further pieces empty."""
    for number, call in enumerate(calls):
        yield _piece(call, "", index=0, id=f"{call.id}{number}", named=True)
        for at in range(0, len(call.arguments), 5):
            yield _piece(call, call.arguments[at : at + 5], index=0, id="")


def _repeated(calls: tuple[Called, ...]) -> Iterator[dict[str, Any]]:
    """Every piece has its call's id; no index."""
    for number, call in enumerate(calls):
        yield _piece(call, "", id=f"{call.id}{number}", named=True)
        for at in range(0, len(call.arguments), 5):
            yield _piece(call, call.arguments[at : at + 5], id=f"{call.id}{number}")


def _nameless(calls: tuple[Called, ...]) -> Iterator[dict[str, Any]]:
    """Neither indexes nor ids; the arguments are an object."""
    for call in calls:
        yield {"function": {"name": call.name, "arguments": json.loads(call.arguments)}}


DIALECTS: dict[str, Callable[[tuple[Called, ...]], Iterator[dict[str, Any]]]] = {
    "openai": _openai,
    "whole": _whole,
    "blank": _blank,
    "repeated": _repeated,
    "nameless": _nameless,
}


def _piece(call: Called, arguments: str, *, named: bool = False, **place: Any) -> dict[str, Any]:
    function = {"name": call.name, "arguments": arguments} if named else {"arguments": arguments}
    return {"type": "function", "function": function, **place}


class _Handler(BaseHTTPRequestHandler):
    server_api: FakeChatAPI
    protocol_version = "HTTP/1.1"
    wbufsize = -1
    disable_nagle_algorithm = True

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers.get("Content-Length") or 0)))
        fault = self.server_api.next_fault()
        self.server_api.requests.append(body)
        if isinstance(fault, (Drop, Raw)):
            if isinstance(fault, Raw):
                self.wfile.write(fault.data)
                self.wfile.flush()
            self.close_connection = True
            self.connection.close()
            return
        if isinstance(fault, Status):
            status, reply, headers = fault.code, error(fault.code, f"scripted {fault.code}")[1], fault.headers
        else:
            status, reply = self.server_api.respond(self.path, self.headers.get("Authorization", ""), body)
            headers = {}
        is_stream = isinstance(reply, list)
        data = _events(reply) if is_stream else json.dumps(reply).encode()
        self.send_response(status)
        for name, value in {
            "Content-Type": "text/event-stream" if is_stream else "application/json",
            "Content-Length": str(len(data)),
            **headers,
        }.items():
            self.send_header(name, value)
        self.end_headers()
        with contextlib.suppress(OSError):
            self.wfile.write(data[: fault.after] if isinstance(fault, Truncate) else data)
        self.close_connection = isinstance(fault, Truncate)

    def log_message(self, format: str, *args: Any) -> None:
        """Tests need no access log."""


def _events(chunks: list[dict[str, Any]]) -> bytes:
    lines = [*(json.dumps(chunk) for chunk in chunks), "[DONE]"]
    return "".join(f"data: {line}\n\n" for line in lines).encode()


def error(status: int, message: str) -> tuple[int, Any]:
    return status, {
        "error": {"message": message, "type": "invalid_request_error", "param": None, "code": None}
    }


def problem_of(body: Any) -> str:
    """What the API would object to, or nothing."""
    if not isinstance(body.get("model"), str) or not body.get("messages"):
        return "model and messages are required"
    open_calls: set[str] = set()
    for message in body["messages"]:
        role, content = message.get("role"), message.get("content")
        if role == "tool":
            if message.get("tool_call_id") not in open_calls or not isinstance(content, str) or not content:
                return "a tool message needs the id of a call before it, and text"
            open_calls.remove(message["tool_call_id"])
            continue
        if open_calls:
            return "an assistant message with tool_calls must be followed by tool messages"
        if calls := message.get("tool_calls"):
            open_calls = {call["id"] for call in calls}
            if len(open_calls) < len(calls):
                return "ids of calls must differ"
            for call in calls:
                json.loads(call["function"]["arguments"])
            continue
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        if not parts or role not in ("system", "user", "assistant"):
            return "a message needs a role and content"
        for part in parts:
            if part["type"] == "image_url" and not picture_of(part):
                return "Invalid image_url"
            if part["type"] == "image_url" and role != "user":
                return "pictures are the user's"
    if open_calls:
        return "an assistant message with tool_calls must be followed by tool messages"
    for tool in body.get("tools", ()):
        if tool["type"] != "function" or not re.fullmatch(r"[\w-]{1,64}", tool["function"]["name"]):
            return "a tool needs a name"
    form = body.get("response_format") or {}
    if form.get("type") != "json_schema":
        return ""
    schema = form["json_schema"]
    return problem_of_schema(schema["schema"]) if schema.get("strict") else ""


def picture_of(part: dict[str, Any]) -> bytes:
    """The file that a part of a message carries; empty if it is none."""
    head, _, data = part["image_url"]["url"].partition(",")
    return base64.b64decode(data, validate=True) if head == "data:image/png;base64" else b""


def problem_of_schema(schema: dict[str, Any], where: str = "root") -> str:
    """Strict schemas: every object names all of its fields as required, and takes no others; no references here."""
    if "$ref" in schema or schema.get("type") not in ("object", "array", "string", "integer", "boolean"):
        return f"{where}: not supported"
    if schema["type"] == "object":
        fields = schema["properties"]
        if schema.get("additionalProperties") is not False or set(schema.get("required", ())) != set(fields):
            return f"{where}: additionalProperties must be false, and all fields required"
        found = (problem_of_schema(below, f"{where}.{name}") for name, below in fields.items())
        return next(filter(None, found), "")
    return problem_of_schema(schema["items"], f"{where}[]") if schema["type"] == "array" else ""
