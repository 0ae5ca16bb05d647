"""A site that archives are fetched from, on loopback: with resumption, and with faults."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


class Handler(BaseHTTPRequestHandler):
    """Serves the files of its site, with resumption, and the site's faults."""

    server: Site

    def do_GET(self) -> None:
        site = self.server
        site.requests.append((self.path, self.headers.get("Range")))
        fault = site.faults.get(self.path)
        if fault is not None:
            fault(self)
        else:
            self.serve(site.files.get(self.path))

    def serve(self, content: bytes | None, *, stop_after: int | None = None) -> None:
        if content is None:
            self.send_error(404)
            return
        start, wanted = 0, self.headers.get("Range")
        if wanted and self.headers.get("If-Range") == self.server.etag:
            start = int(wanted.removeprefix("bytes=").removesuffix("-"))
        if start >= len(content):
            self.send_error(416)
            return
        self.send_response(206 if start else 200)
        if start:
            self.send_header("Content-Range", f"bytes {start}-{len(content) - 1}/{len(content)}")
        self.send_header("ETag", self.server.etag)
        self.send_header("Content-Length", str(len(content) - start))
        self.end_headers()
        end = len(content) if stop_after is None else start + stop_after
        self.wfile.write(content[start:end])

    def log_message(self, format: str, *args: object) -> None:
        pass


@dataclass
class Site(ThreadingHTTPServer):
    """A stand-in for the official site."""

    files: dict[str, bytes] = field(default_factory=dict[str, bytes])
    faults: dict[str, Callable[[Handler], None]] = field(default_factory=dict)
    requests: list[tuple[str, str | None]] = field(default_factory=list)
    etag: str = '"one"'
    released: threading.Event = field(default_factory=threading.Event)
    daemon_threads = True

    def __post_init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"

    def handle_error(self, request: object, client_address: object) -> None:
        """A client that hangs up is what several of these tests are about."""
