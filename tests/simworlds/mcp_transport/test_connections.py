"""A server that is held up by clients: others are served all the while, and it keeps its descriptors."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from small_server import LARGE, SmallServer, begins, is_ok, read, request

from simworlds.mcp_transport.connections import ConnectionBook, ConnectionLimits

if TYPE_CHECKING:
    from socket import socket

MANY = 300  # more than twice the server's descriptors
QUICK = 1.0
LONGEST_IN_A_POOL = 6.0  # seconds; httpx keeps an idle connection for 5
HALF_A_REQUEST = {
    "nothing": b"",
    "half a line": b"GET / HT",
    "half a header": b"GET / HTTP/1.1\r\nHost: x\r\nX-Lo",
    "half a body": b"POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\nhalf",
    "half a chunk": b"POST / HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\n1000\r\nhalf",
}
# What shuts others out, and what ends: `make test` takes each in one of the two ways at least.
FIRST, SECOND = (
    [
        pytest.param(content, id=name, marks=pytest.mark.whole if place in left_out else ())
        for place, (name, content) in enumerate(HALF_A_REQUEST.items())
    ]
    for left_out in ((2, 3), (1, 4))
)


def open_descriptors(pid: int) -> int:
    """How many descriptors a process has."""
    return sum(1 for _ in Path(f"/proc/{pid}/fd").iterdir())


@pytest.mark.parametrize("content", FIRST)
def test_half_open_connections_do_not_shut_others_out(tmp_path: Path, content: bytes) -> None:
    with SmallServer(tmp_path / "log") as server, ExitStack() as opened:
        for number in range(MANY):
            opened.enter_context(server.connect(content))
            if number % 20 == 0:
                assert server.get().endswith("ok")
        assert open_descriptors(server.process.pid) < 100
        assert server.get().endswith("ok")
        assert server.log == f"Serving a test at http://127.0.0.1:{server.port}/mcp\n"


def test_those_that_never_sent_a_request_go_before_a_client_that_keeps_its_connection(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log") as server, ExitStack() as opened, server.connect() as kept:
        for _ in range(5):
            kept.sendall(request())
            assert is_ok(kept)
            for _ in range(40):
                opened.enter_context(server.connect())


@pytest.mark.parametrize("content", SECOND)
def test_a_request_that_does_not_arrive_ends_the_connection(tmp_path: Path, content: bytes) -> None:
    with SmallServer(tmp_path / "log", patience=QUICK) as server, server.connect(content) as slow:
        assert read(slow) == ""
        assert "Traceback" not in server.log


def test_a_request_that_arrives_byte_by_byte_ends_the_connection(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log", patience=QUICK) as server, server.connect() as slow:
        slow.settimeout(0.05)
        is_open = True
        while is_open:
            try:
                slow.sendall(b"G")
                is_open = bool(slow.recv(1000))
            except TimeoutError:
                continue
            except ConnectionError:
                is_open = False


def test_an_idle_connection_is_kept_for_longer_than_clients_keep_it(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log", patience=30) as server, server.connect() as kept:
        kept.sendall(request())
        assert is_ok(kept)
        kept.settimeout(LONGEST_IN_A_POOL)
        with pytest.raises(TimeoutError):  # it would be told here that the server has closed
            kept.recv(1)
        kept.settimeout(30)
        kept.sendall(request())
        assert is_ok(kept)


def test_an_answer_that_is_not_read_ends_the_connection(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log", patience=QUICK) as server, server.connect(request("/large")) as deaf:
        assert begins(deaf)
        with server.connect() as later:
            assert read(later) == ""  # the patience has run out
        assert len(read(deaf)) < LARGE


def test_an_answer_that_takes_longer_than_the_patience_is_waited_for(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log", patience=QUICK) as server, server.connect(request("/wait")) as served:
        assert begins(served)
        with server.connect() as idle:
            assert read(idle) == ""  # the patience has run out
        assert server.get("/go").endswith("ok")
        assert served.recv(2) == b"ok"


def occupied(server: SmallServer, opened: ExitStack, count: int, source: str = "127.0.0.1") -> list[socket]:
    """Connections that are being served until ``/go``."""
    connections = [
        opened.enter_context(server.connect(request("/wait"), source=source)) for _ in range(count)
    ]
    assert all(begins(connection) for connection in connections)
    return connections


def test_where_all_of_an_address_are_being_served_another_one_is_refused(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log") as server, ExitStack() as opened:
        served = occupied(server, opened, 32)
        assert server.get().startswith("HTTP/1.1 503 ")
        assert server.get("/go", source="127.0.0.2").endswith("ok")
        assert all(connection.recv(2) == b"ok" for connection in served)
        assert server.get().endswith("ok")


def test_all_addresses_together_have_a_limit_too(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log") as server, ExitStack() as opened:
        for number in range(4):
            occupied(server, opened, 16, f"127.0.1.{number + 1}")
        assert server.get(source="127.0.0.9").startswith("HTTP/1.1 503 ")


def test_without_a_descriptor_it_waits_instead_of_spinning(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log") as server, server.connect(request()) as kept, ExitStack() as opened:
        assert is_ok(kept)
        kept.sendall(request("/open"))
        assert is_ok(kept)
        waiting = [opened.enter_context(server.connect(request("/", "Connection: close"))) for _ in range(20)]
        waiting[0].settimeout(1.5)
        with pytest.raises(TimeoutError):
            waiting[0].recv(1)
        assert server.log.count("out of system resource") <= 5
        kept.sendall(request("/close"))
        assert is_ok(kept)
        waiting[0].settimeout(30)
        assert all(read(connection).endswith("ok") for connection in waiting)


def test_a_server_whose_application_has_ended_ends_and_says_so(tmp_path: Path) -> None:
    with SmallServer(tmp_path / "log") as server:
        assert server.get("/break").endswith("ok")
        assert server.process.wait(60) == 1
        assert "broken on request" in server.log
        assert "ended after an error of its own. Start it again." in server.log


# The book


class Entry:
    """A connection in the book."""

    def __init__(self, *, has_served: bool = False) -> None:
        self.has_served = has_served
        self.is_open = True

    def abort(self) -> None:
        self.is_open = False


def test_one_network_counts_as_one_address() -> None:
    book = ConnectionBook(ConnectionLimits(total=10, per_address=1, at_once=1))
    first, second, third = Entry(), Entry(), Entry()
    assert all(
        book.admit(entry, host)
        for entry, host in [(first, "2001:db8::1"), (second, "2001:db8::2:2"), (third, "2001:db8:1::1%eth0")]
    )
    assert [entry.is_open for entry in (first, second, third)] == [False, True, True]


def test_of_several_the_slowest_makes_room() -> None:
    book = ConnectionBook(ConnectionLimits(total=3, per_address=3, at_once=1))
    entries = [Entry() for _ in range(4)]
    for entry in entries[:3]:
        book.admit(entry, "10.0.0.1")
    book.serve(entries[0])
    book.wait_for(entries[0])  # now the quickest
    assert book.admit(entries[3], "10.0.0.2")
    assert [entry.is_open for entry in entries] == [True, False, True, True]


def test_what_was_dropped_counts_no_more() -> None:
    book = ConnectionBook(ConnectionLimits(total=1, per_address=1, at_once=1))
    entries = [Entry() for _ in range(50)]
    assert all(book.admit(entry, "10.0.0.1") for entry in entries)
    for entry in entries:  # also those that were closed before
        book.wait_for(entry)
        book.forget(entry)
    served, refused = Entry(), Entry()
    assert book.admit(served, "10.0.0.1")
    book.serve(served)
    assert not book.admit(refused, "10.0.0.2")
