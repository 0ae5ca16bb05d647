"""A local HTTP server that speaks OpenAI's chat completions with structured outputs, for the real client.

It checks requests as the API does (key, messages, pictures, the rules of strict schemas), remembers them in
``requests``, and answers with what ``answer(params)`` returns. Faults are scripted and used up one by one.
"""

from __future__ import annotations

import base64
import contextlib
import json
import threading
from collections import deque
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any, Self

from fake_messages_api import Drop, Raw, Status, Truncate

if TYPE_CHECKING:
    from collections.abc import Callable

Fault = Status | Drop | Raw | Truncate
ROUTE = "/v1/chat/completions"


@dataclass(frozen=True)
class Said:
    """A completion."""

    text: str | None = "Hello."
    finish_reason: str = "stop"
    refusal: str | None = None
    prompt_tokens: int = 100
    completion_tokens: int = 20
    cached_tokens: int = 0


class FakeChatAPI:
    """See the module."""

    def __init__(self, answer: Callable[[dict[str, Any]], Said] = lambda params: Said()) -> None:
        self.answer = answer
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
        if not authorization.startswith("Bearer "):
            return error(401, "Incorrect API key provided")
        if problem := problem_of(body):
            return error(400, problem)
        said = self.answer(body)
        return 200, {
            "id": f"chatcmpl-{len(self.requests)}",
            "object": "chat.completion",
            "created": 1_790_000_000,
            "model": f"{body['model']}-2026-04-23",
            "choices": [
                {
                    "index": 0,
                    "finish_reason": said.finish_reason,
                    "message": {"role": "assistant", "content": said.text, "refusal": said.refusal},
                }
            ],
            "usage": {
                "prompt_tokens": said.prompt_tokens,
                "completion_tokens": said.completion_tokens,
                "total_tokens": said.prompt_tokens + said.completion_tokens,
                "prompt_tokens_details": {"cached_tokens": said.cached_tokens},
            },
        }


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
        data = json.dumps(reply).encode()
        self.send_response(status)
        for name, value in {
            "Content-Type": "application/json",
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


def error(status: int, message: str) -> tuple[int, Any]:
    return status, {
        "error": {"message": message, "type": "invalid_request_error", "param": None, "code": None}
    }


def problem_of(body: Any) -> str:
    """What the API would object to, or nothing."""
    if not isinstance(body.get("model"), str) or not body.get("messages"):
        return "model and messages are required"
    for message in body["messages"]:
        content = message.get("content")
        parts = [{"type": "text", "text": content}] if isinstance(content, str) else content
        if not parts or message.get("role") not in ("system", "user", "assistant"):
            return "a message needs a role and content"
        for part in parts:
            if part["type"] == "image_url" and not picture_of(part):
                return "Invalid image_url"
            if part["type"] == "image_url" and message["role"] != "user":
                return "pictures are the user's"
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
