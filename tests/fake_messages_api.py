"""A local HTTP server that speaks Anthropic's Messages and Message Batches API, for the real client.

``with FakeMessagesAPI() as api: Anthropic(base_url=api.base_url, api_key="any")``. It checks requests as the
API does (key, custom_ids, required fields), remembers them in ``requests``, and answers each message with
what ``answer(params)`` returns, streamed where the request asks for it. Faults are scripted per route and used
up one by one: ``api.fail("POST /v1/messages/batches", Status(529), Drop())``.
"""

from __future__ import annotations

import contextlib
import json
import re
import sys
import threading
from collections import defaultdict, deque
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING, Any, Self
from urllib.parse import parse_qs, urlsplit

import fake_messages_rules as rules
import fake_messages_stream as sse

if TYPE_CHECKING:
    from collections.abc import Callable

ERROR_TYPES = {
    400: "invalid_request_error",
    401: "authentication_error",
    402: "billing_error",
    403: "permission_error",
    404: "not_found_error",
    413: "request_too_large",
    429: "rate_limit_error",
    500: "api_error",
    504: "timeout_error",
    529: "overloaded_error",
}
MODELS = ("claude-haiku-5-5", "claude-sonnet-5-5", "claude-opus-5-5")


@dataclass(frozen=True)
class Reply:
    """A message. ``content`` (blocks, as the API has them) replaces ``text``, e.g. with a ``tool_use``.

    ``input_tokens`` None: the server counts them, and what of them it had kept or now keeps.
    """

    text: str = "Hello."
    stop_reason: str = "end_turn"
    content: tuple[dict[str, Any], ...] = ()
    input_tokens: int | None = 100
    output_tokens: int = 20
    cache_read_tokens: int = 0
    cache_write_tokens: int = 0
    stop_details: dict[str, Any] | None = None


@dataclass(frozen=True)
class Ended:
    """How a request of a batch ends without a message: ``errored``, ``expired`` or ``canceled``."""

    type: str
    error_type: str = "api_error"
    message: str = "Internal server error"


@dataclass(frozen=True)
class Line:
    """A line of a batch's results, instead of what belongs there."""

    text: str


@dataclass(frozen=True)
class Status:
    """Fault: an error reply, or any other body with any status."""

    code: int
    headers: dict[str, str] = field(default_factory=dict)
    body: str | None = None


@dataclass(frozen=True)
class Drop:
    """Fault: the connection breaks. With ``handled``, only after the request has had its effect."""

    handled: bool = False


@dataclass(frozen=True)
class Hang:
    """Fault: no answer for so many seconds (less, when the server stops); then the connection breaks."""

    seconds: float = 20.0


@dataclass(frozen=True)
class Truncate:
    """Fault: the answer ends after so many bytes of its body, against its Content-Length.

    A stream that ends ``clean`` ends as if it were whole.
    """

    after: int
    clean: bool = False


@dataclass(frozen=True)
class Raw:
    """Fault: these bytes go out instead of an HTTP response; then the connection breaks."""

    data: bytes


@dataclass(frozen=True)
class StreamError:
    """Fault: a stream says after so many events that it failed, and ends."""

    after: int
    type: str = "overloaded_error"
    message: str = "Overloaded"


@dataclass(frozen=True)
class Stall:
    """Fault: a stream stops after so many bytes, for so many seconds or until ``go`` is set; then it goes on.

    Without ``go`` it does not go on: the connection breaks.
    """

    after: int
    seconds: float = 20.0
    go: threading.Event | None = None


@dataclass(frozen=True)
class Garble:
    """Fault: the bytes of a stream from ``at`` on are replaced by as many of ``data``."""

    at: int
    data: bytes


Fault = Status | Drop | Hang | Truncate | Raw | StreamError | Stall | Garble
Answer = Reply | Ended | Line


@dataclass(frozen=True)
class Recorded:
    """A request that was received."""

    route: str
    path: str
    headers: dict[str, str]
    body: Any


@dataclass
class Batch:
    """A batch on the server; it ends after ``polls`` looks at it."""

    id: str
    requests: list[dict[str, Any]]
    created: datetime
    polls: int
    ended: bool = False
    canceled: bool = False
    results: list[tuple[str, str]] = field(default_factory=list)  # outcome, line


class FakeMessagesAPI:
    """See the module. ``polls`` is how many looks at a batch find it in progress (settable at any time)."""

    def __init__(
        self, answer: Callable[[dict[str, Any]], Answer] = lambda params: Reply(), polls: int = 0
    ) -> None:
        self.answer = answer
        self.polls = polls
        self.requests: list[Recorded] = []
        self.batches: dict[str, Batch] = {}
        self.prompts = rules.PromptCache()
        self._faults: defaultdict[str, deque[Fault]] = defaultdict(deque)
        self._changed = threading.Condition()
        self._stopping = threading.Event()
        self._ids = 0
        api = self

        class Handler(_Handler):
            server_api = api

        self._server = _Server(("127.0.0.1", 0), Handler)
        self.base_url = f"http://127.0.0.1:{self._server.server_port}"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.02,), daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *exc: object) -> None:
        self._stopping.set()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def fail(self, route: str, *faults: Fault) -> None:
        """The next requests to ``route`` (``"GET /v1/messages/batches/{id}"``) meet these faults."""
        self._faults[route].extend(faults)

    def received(self, route: str) -> list[Recorded]:
        """The requests to ``route`` so far."""
        return [request for request in self.requests if request.route == route]

    def wait_for(self, route: str, count: int = 1, timeout: float = 60.0) -> None:
        """Return once ``route`` was requested ``count`` times."""
        with self._changed:
            if not self._changed.wait_for(lambda: len(self.received(route)) >= count, timeout):
                raise TimeoutError(f"{route} was not requested {count} times within {timeout} s")

    def create_batch(self, requests: list[dict[str, Any]], created: datetime | None = None) -> Batch:
        """A batch, as if somebody had sent it."""
        batch = Batch(self._id("msgbatch"), requests, created or datetime.now(UTC), self.polls)
        self.batches[batch.id] = batch
        return batch

    def message(self, reply: Reply, params: dict[str, Any]) -> dict[str, Any]:
        """``reply`` as the API writes a message that answers ``params``."""
        content = list(reply.content) or ([{"type": "text", "text": reply.text}] if reply.text else [])
        if reply.input_tokens is None:
            usage = self.prompts.usage(params)
        else:
            usage = {
                "input_tokens": reply.input_tokens,
                "cache_creation_input_tokens": reply.cache_write_tokens,
                "cache_read_input_tokens": reply.cache_read_tokens,
            }
        return {
            "id": self._id("msg"),
            "type": "message",
            "role": "assistant",
            "model": params["model"],
            "content": rules.sign(params, content),
            "stop_reason": reply.stop_reason,
            "stop_sequence": None,
            "stop_details": reply.stop_details,
            "usage": {**usage, "output_tokens": reply.output_tokens},
        }

    def _id(self, kind: str) -> str:
        with self._changed:
            self._ids += 1
            return f"{kind}_{self._ids:08d}"

    def _record(self, request: Recorded) -> None:
        with self._changed:
            self.requests.append(request)
            self._changed.notify_all()

    def _next_fault(self, route: str) -> Fault | None:
        with self._changed:
            return self._faults[route].popleft() if self._faults[route] else None

    # What the routes do. Each returns a status and a JSON-ready body (or text).

    def post_messages(self, body: Any, query: dict[str, str]) -> tuple[int, Any]:
        problem = _problem(body)
        if problem:
            return _error(400, problem)
        answer = self.answer(body)
        if not isinstance(answer, Reply):
            return _error(500, "this answer is for batches only")
        message = self.message(answer, body)
        return 200, [*sse.events(message)] if body.get("stream") else message

    def post_count_tokens(self, body: Any, query: dict[str, str]) -> tuple[int, Any]:
        problem = _problem({"max_tokens": 1, **body} if isinstance(body, dict) else body)
        return _error(400, problem) if problem else (200, {"input_tokens": -(-len(json.dumps(body)) // 4)})

    def get_models(self, body: Any, query: dict[str, str]) -> tuple[int, Any]:
        return 200, {
            "data": [_model(name) for name in MODELS],
            "has_more": False,
            "first_id": None,
            "last_id": None,
        }

    def get_model(self, body: Any, query: dict[str, str], name: str) -> tuple[int, Any]:
        return (200, _model(name)) if name in MODELS else _error(404, f"model: {name}")

    def post_batches(self, body: Any, query: dict[str, str]) -> tuple[int, Any]:
        requests = body.get("requests") if isinstance(body, dict) else None
        if not isinstance(requests, list) or not requests:
            return _error(400, "requests: at least one is required")
        ids = [request.get("custom_id", "") for request in requests]
        if len(set(ids)) < len(ids) or not all(re.fullmatch(r"[a-zA-Z0-9_-]{1,64}", one) for one in ids):
            return _error(400, "requests: custom_id must be unique and match ^[a-zA-Z0-9_-]{1,64}$")
        return 200, self._batch(self.create_batch(requests))

    def get_batches(self, body: Any, query: dict[str, str]) -> tuple[int, Any]:
        newest = sorted(self.batches.values(), key=lambda batch: (batch.created, batch.id), reverse=True)
        if "after_id" in query:
            ids = [batch.id for batch in newest]
            newest = newest[ids.index(query["after_id"]) + 1 :] if query["after_id"] in ids else []
        page = newest[: int(query.get("limit", 20))]
        return 200, {
            "data": [self._batch(batch) for batch in page],
            "has_more": len(page) < len(newest),
            "first_id": page[0].id if page else None,
            "last_id": page[-1].id if page else None,
        }

    def get_batch(self, body: Any, query: dict[str, str], name: str) -> tuple[int, Any]:
        batch = self.batches.get(name)
        if batch is None:
            return _error(404, f"no batch {name}")
        if not batch.ended:
            batch.polls -= 1
            if batch.polls < 0 or batch.canceled:
                self._end(batch)
        return 200, self._batch(batch)

    def post_cancel(self, body: Any, query: dict[str, str], name: str) -> tuple[int, Any]:
        batch = self.batches.get(name)
        if batch is None:
            return _error(404, f"no batch {name}")
        batch.canceled = True
        return 200, self._batch(batch)

    def get_results(self, body: Any, query: dict[str, str], name: str) -> tuple[int, Any]:
        batch = self.batches.get(name)
        if batch is None or not batch.ended:
            return _error(404, f"no results of batch {name}")
        return 200, "\n".join(line for _, line in reversed(batch.results)) + "\n"

    def _end(self, batch: Batch) -> None:
        batch.ended = True
        for request in batch.requests:
            problem = _problem(request.get("params"))
            if problem:
                answer: Answer = Ended("errored", "invalid_request_error", problem)
            else:
                answer = Ended("canceled") if batch.canceled else self.answer(request["params"])
            batch.results.append(self._result(request, answer))

    def _result(self, request: dict[str, Any], answer: Answer) -> tuple[str, str]:
        if isinstance(answer, Line):
            return "succeeded", answer.text.replace("{custom_id}", request["custom_id"])
        if isinstance(answer, Reply):
            result = {"type": "succeeded", "message": self.message(answer, request["params"])}
        else:
            result = {"type": answer.type}
            if answer.type == "errored":
                result["error"] = {
                    "type": "error",
                    "error": {"type": answer.error_type, "message": answer.message},
                    "request_id": self._id("req"),
                }
        row = {"custom_id": request["custom_id"], "result": result}
        return str(result["type"]), json.dumps(row, ensure_ascii=False)

    def _batch(self, batch: Batch) -> dict[str, Any]:
        outcomes = [outcome for outcome, _ in batch.results]
        counts = {kind: outcomes.count(kind) for kind in ("succeeded", "errored", "canceled", "expired")}
        status = "ended" if batch.ended else "canceling" if batch.canceled else "in_progress"
        return {
            "id": batch.id,
            "type": "message_batch",
            "processing_status": status,
            "request_counts": {"processing": 0 if batch.ended else len(batch.requests), **counts},
            "created_at": batch.created.isoformat(),
            "expires_at": (batch.created + timedelta(days=1)).isoformat(),
            "ended_at": datetime.now(UTC).isoformat() if batch.ended else None,
            "cancel_initiated_at": None,
            "archived_at": None,
            "results_url": f"{self.base_url}/v1/messages/batches/{batch.id}/results" if batch.ended else None,
        }


_ROUTES: tuple[tuple[str, str, Callable[..., tuple[int, Any]]], ...] = (
    ("POST", "/v1/messages", FakeMessagesAPI.post_messages),
    ("POST", "/v1/messages/count_tokens", FakeMessagesAPI.post_count_tokens),
    ("GET", "/v1/models", FakeMessagesAPI.get_models),
    ("GET", "/v1/models/{id}", FakeMessagesAPI.get_model),
    ("POST", "/v1/messages/batches", FakeMessagesAPI.post_batches),
    ("GET", "/v1/messages/batches", FakeMessagesAPI.get_batches),
    ("GET", "/v1/messages/batches/{id}", FakeMessagesAPI.get_batch),
    ("POST", "/v1/messages/batches/{id}/cancel", FakeMessagesAPI.post_cancel),
    ("GET", "/v1/messages/batches/{id}/results", FakeMessagesAPI.get_results),
)


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def handle_error(self, request: Any, client_address: Any) -> None:
        """A client that went away is part of the tests; anything else is a fault of this server."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server_api: FakeMessagesAPI
    protocol_version = "HTTP/1.1"
    wbufsize = -1  # headers and body in one packet: two would wait for the client's delayed ACK
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        self._handle("GET")

    def do_POST(self) -> None:
        self._handle("POST")

    def log_message(self, format: str, *args: Any) -> None:
        """Tests need no access log."""

    def _handle(self, method: str) -> None:
        length = int(self.headers.get("Content-Length") or 0)
        raw = self.rfile.read(length)
        url = urlsplit(self.path)
        query = {key: values[0] for key, values in parse_qs(url.query).items()}
        route, handler, arguments = _route(method, url.path)
        try:
            body = json.loads(raw) if raw else None
        except ValueError:
            body = None
        headers = {key.lower(): value for key, value in self.headers.items()}
        fault = self.server_api._next_fault(route)
        status, reply = 200, None
        if not isinstance(fault, (Status, Hang, Drop, Raw)) or (isinstance(fault, Drop) and fault.handled):
            if not (headers.get("authorization") or headers.get("x-api-key")):
                status, reply = _error(401, "no API key")
            elif "anthropic-version" not in headers:
                status, reply = _error(400, "anthropic-version: header is required")
            elif handler is None:
                status, reply = _error(404, f"no such path: {url.path}")
            else:
                status, reply = handler(self.server_api, body, query, *arguments)
        self.server_api._record(Recorded(route, self.path, headers, body))
        if isinstance(fault, Hang):
            self.server_api._stopping.wait(fault.seconds)
        if isinstance(fault, Raw):
            with contextlib.suppress(OSError):
                self.connection.sendall(fault.data)
        if isinstance(fault, (Hang, Drop, Raw)):
            self.close_connection = True
            self.connection.close()
        elif isinstance(fault, Status):
            default = _error(fault.code, f"scripted {fault.code}")[1]
            self._send(fault.code, default if fault.body is None else fault.body, fault.headers)
        elif isinstance(reply, list):
            self._stream(reply, fault)
        else:
            self._send(status, reply, {}, fault.after if isinstance(fault, Truncate) else None)

    def _send(self, status: int, reply: Any, headers: dict[str, str], only: int | None = None) -> None:
        data = (reply if isinstance(reply, str) else json.dumps(reply)).encode()
        kind = "application/x-jsonl" if isinstance(reply, str) else "application/json"
        self.send_response(status)
        for name, value in {
            "Content-Type": kind,
            "request-id": "req_local",
            "Content-Length": str(len(data)),
            **headers,
        }.items():
            self.send_header(name, value)
        self.end_headers()
        with contextlib.suppress(OSError):
            self.wfile.write(data[:only])
        if only is not None:
            self.close_connection = True

    def _stream(self, events: list[sse.Event], fault: Fault | None) -> None:
        if isinstance(fault, StreamError):
            events = [*events[: fault.after], sse.error(fault.type, fault.message)]
        data = b"".join(map(sse.encoded, events))
        if isinstance(fault, Garble):
            data = (data[: fault.at] + fault.data + data[fault.at + len(fault.data) :])[: len(data)]
        pieces, whole = [data], True
        if isinstance(fault, Truncate):
            pieces, whole = [data[: fault.after]], fault.clean
        elif isinstance(fault, Stall):
            pieces, whole = [data[: fault.after], data[fault.after :]], fault.go is not None
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream; charset=utf-8")
        self.send_header("Transfer-Encoding", "chunked")
        self.send_header("request-id", "req_local")
        self.end_headers()
        with contextlib.suppress(OSError):
            for number, piece in enumerate(pieces):
                if number and isinstance(fault, Stall):
                    (fault.go or self.server_api._stopping).wait(fault.seconds)
                    if not whole:
                        break
                self.wfile.write(b"%x\r\n%b\r\n" % (len(piece), piece) if piece else b"")
                self.wfile.flush()
            if whole:
                self.wfile.write(b"0\r\n\r\n")
        self.close_connection = not whole


def _route(method: str, path: str) -> tuple[str, Callable[..., tuple[int, Any]] | None, tuple[str, ...]]:
    for verb, pattern, handler in _ROUTES:
        match = re.fullmatch(pattern.replace("{id}", "([^/]+)"), path)
        if match and verb == method:
            return f"{verb} {pattern}", handler, match.groups()
    return f"{method} {path}", None, ()


def _problem(params: Any) -> str:
    """What the API would object to, or nothing."""
    if not isinstance(params, dict):
        return "the body must be an object"
    if not isinstance(params.get("model"), str):
        return "model: is required"
    if not isinstance(params.get("max_tokens"), int) or params["max_tokens"] < 1:
        return "max_tokens: must be a positive integer"
    messages = params.get("messages")
    if not isinstance(messages, list) or not messages or messages[-1].get("role") != "user":
        return "messages: at least one is required, and the last must be the user's"
    return rules.problem(params)


def _error(status: int, message: str) -> tuple[int, Any]:
    return status, {
        "type": "error",
        "error": {"type": ERROR_TYPES.get(status, "api_error"), "message": message},
    }


def _model(name: str) -> dict[str, Any]:
    return {
        "id": name,
        "type": "model",
        "display_name": name,
        "created_at": "2026-10-01T00:00:00Z",
        "lifecycle": "active",
    }
