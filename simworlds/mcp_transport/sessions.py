"""Ends the sessions of an MCP server over HTTP whose clients do not come back after ``initialize``."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from starlette.datastructures import Headers

if TYPE_CHECKING:
    from starlette.types import ASGIApp, Message, Receive, Scope, Send

SESSION = "mcp-session-id"
UNFINISHED = 64
UNFINISHED_SECONDS = 10.0
_REFUSED = 400


class EndUnfinishedSessions:
    """Knows the sessions that were begun and not used yet, and ends them.

    The oldest ends where there are more than ``most``, so that a client that does come back is not shut out by those
    that do not; any ends after ``seconds``. Sessions that were used once are left alone.
    """

    def __init__(
        self, app: ASGIApp, path: str, *, most: int = UNFINISHED, seconds: float = UNFINISHED_SECONDS
    ) -> None:
        """``app`` must accept requests to end a session that are sent to ``localhost``."""
        self._app = app
        self._path = path
        self._most = most
        self._seconds = seconds
        self._begun: dict[str, float] = {}  # oldest first

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """ASGI."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        asked = Headers(scope=scope).get(SESSION, "")
        self._begun.pop(asked, None)  # it came back, however late
        await self._end_some(scope, len(self._begun) if asked else self._most - 1)

        async def watched(message: Message) -> None:
            if not asked and message["type"] == "http.response.start" and message["status"] < _REFUSED:
                session = Headers(raw=message["headers"]).get(SESSION, "")
                if session:
                    self._begun[session] = time.monotonic()
            await send(message)

        await self._app(scope, receive, watched)

    async def _end_some(self, scope: Scope, most: int) -> None:
        """Ends the overdue ones, and then the oldest until ``most`` are left."""
        overdue = time.monotonic() - self._seconds
        while self._begun:
            session, begun = next(iter(self._begun.items()))
            if begun > overdue and len(self._begun) <= most:
                return
            del self._begun[session]
            await self._end(session, scope)

    async def _end(self, session: str, scope: Scope) -> None:
        """Ends a session as its client would."""
        headers = [(b"host", b"localhost"), (SESSION.encode(), session.encode())]
        request = {**scope, "method": "DELETE", "path": self._path, "raw_path": self._path.encode()}

        async def receive() -> Message:
            return {"type": "http.request", "body": b"", "more_body": False}

        async def send(_message: Message) -> None:
            pass

        await self._app({**request, "query_string": b"", "headers": headers}, receive, send)
