"""Connections to an open Blender, without one: what listens, who is let in, and the files that say where."""

from __future__ import annotations

import contextlib
import json
import os
import queue
import random
import socket
import subprocess
import sys
import threading
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest
from processes import becomes

from agents.blender.attached.attached_blender import AttachedBlender
from agents.blender.attached.open_blenders import choose, open_blenders
from agents.blender.inside.attached.connection import announcement, link
from agents.blender.inside.attached.connection.listener import Listener
from simworlds.operating_system import Windows
from simworlds.sandbox.errors import BlenderError, Refusal
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

TOKEN = "a" * 64
TURNS = threading.Lock()  # in Blender all this is done on one thread
ABOUT: dict[str, Any] = {
    "process": os.getpid(),
    "blender": "4.2.1 LTS",
    "executable": "/opt/blender/blender",
    "extension": "0.1.0",
    "file": "/projects/kitchen.blend",
    "scene": "Scene",
    "may": {"change": True, "code": True, "unrehearsed": False},
}


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("SIMWORLDS_HOME", str(tmp_path))
    return tmp_path


@pytest.fixture
def listener() -> Iterator[Listener]:
    """What listens as the extension does; the tests answer in Blender's place, and a thread is its timer."""
    listening = Listener(TOKEN, ABOUT)
    announcement.write({"port": listening.port, "token": TOKEN, **ABOUT})
    ending = threading.Event()

    def tick() -> None:
        while not ending.wait(0.01):
            with TURNS:
                listening.turn()

    timer = threading.Thread(target=tick)
    timer.start()
    yield listening
    ending.set()
    timer.join()
    listening.stop("the end")


def attached() -> AttachedBlender:
    return AttachedBlender("open", "a test", lambda _about: "", lambda _line: None)


def test_finds_what_was_announced(home: Path, listener: Listener) -> None:
    (found,) = open_blenders()
    assert str(found.about) == f"Blender 4.2.1 with kitchen.blend (process {os.getpid()})"
    assert choose("kitchen") == choose(str(os.getpid())) == choose("auto") == found
    with pytest.raises(Refusal, match="No open Blender is 'garden'"):
        choose("garden")


def test_tells_several_apart(listener: Listener) -> None:
    other = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    try:
        about = {**ABOUT, "process": other.pid, "file": "/projects/garden.blend"}
        file = os.open(announcement.path_of(other.pid), os.O_WRONLY | os.O_CREAT, 0o600)
        with open(file, "w") as written:  # noqa: PTH123 - a descriptor
            json.dump({"port": listener.port, "token": TOKEN, **about}, written)
        with pytest.raises(Refusal, match=r"Several Blenders listen: .*kitchen.*garden|garden.*kitchen"):
            choose("open")
        assert choose("garden").about.process == other.pid
    finally:
        other.kill()
        other.communicate()
    assert [blender.about.process for blender in open_blenders()] == [os.getpid()]


def test_files_of_blenders_that_have_ended_are_removed(
    listener: Listener, monkeypatch: pytest.MonkeyPatch
) -> None:
    kernel = SimpleNamespace(OpenProcess=lambda *_: 0, GetLastError=lambda: 0)
    monkeypatch.setattr("agents.blender.attached.open_blenders.SYSTEM", Windows(lambda: kernel))
    assert open_blenders() == []
    monkeypatch.undo()
    assert open_blenders() == []


def test_files_that_others_can_read_do_not_count(listener: Listener, home: Path) -> None:
    (home / "open-blenders" / f"{os.getpid()}.json").chmod(0o644)
    assert open_blenders() == []
    with pytest.raises(Refusal, match="press Start"):
        choose("open")


def test_a_call_is_answered_with_what_the_user_did(listener: Listener) -> None:
    blender = attached()
    progress: list[tuple[float, float | None, str]] = []

    def answer() -> None:
        request = listener.requests.get(timeout=10)
        with TURNS:
            request.client.send({"ticket": request.ticket, "progress": [1, 2, "half"]})
            request.reply(
                value=request.arguments, seconds=0.1, left=[], events=["The user has saved."], stdout="hi"
            )

    thread = threading.Thread(target=answer)
    thread.start()
    reply = blender.call("tool", {"a": 1}, unread, timeout=10, progress=lambda *told: progress.append(told))
    thread.join()
    assert reply.value == {"a": 1}
    assert reply.stdout == "hi"
    assert progress == [(1.0, 2.0, "half")]
    assert "The user has saved." in blender.take_note()
    blender.close()


class InBlender(threading.Thread):
    """Answers each call in Blender's place, by its tool's name; ``asked`` are the names."""

    def __init__(self, listener: Listener, answers: dict[str, list[dict[str, Any]]]) -> None:
        super().__init__(daemon=True)
        self.listener, self.answers = listener, answers
        self.asked: list[str] = []
        self.start()

    def run(self) -> None:
        while True:
            request = self.listener.requests.get()
            self.asked.append(request.tool)
            answers = self.answers[request.tool]
            with TURNS:
                request.reply(**answers.pop(0) if len(answers) > 1 else answers[0], seconds=0.1, left=[])


_COPIED = {"value": {}}


@pytest.mark.parametrize(
    "fault",
    [
        {"refused": "The user is busy.", "kind": "busy"},
        {"refused": "The copy cannot be written: no space is left."},
        {"failed": "KeyError: 1", "traceback": ""},
    ],
)
def test_without_a_copy_of_the_file_nothing_is_changed(listener: Listener, fault: dict[str, Any]) -> None:
    inside = InBlender(
        listener, {"opened": [{"value": 1}], "write_copy": [fault, _COPIED], "apply": [{"value": 2}]}
    )
    blender = attached()
    with pytest.raises(BlenderError):
        blender.call("apply", {}, unread, timeout=10, changes=True)
    assert "apply" not in inside.asked
    blender.call("apply", {}, unread, timeout=10, changes=True)
    assert "Before this first change, a copy was kept" in blender.take_note()
    blender.call("apply", {}, unread, timeout=10, changes=True)
    assert inside.asked.count("write_copy") == inside.asked.count("apply") == 2
    blender.close()


def test_a_file_too_large_to_be_copied_is_changed_and_that_is_told_once(listener: Listener) -> None:
    large = {"refused": "The scene is too large.", "kind": "large"}
    inside = InBlender(listener, {"opened": [{"value": 1}], "write_copy": [large], "apply": [{"value": 2}]})
    blender = attached()
    for _ in range(2):
        blender.call("apply", {}, unread, timeout=10, changes=True)
    assert (
        blender.take_note().count("No copy was kept before this first change: The scene is too large.") == 1
    )
    assert inside.asked.count("write_copy") == 1
    blender.close()


def test_one_client_at_a_time_unless_the_user_allows_more(listener: Listener) -> None:
    first = attached()
    assert first.about.file.endswith("kitchen.blend")
    with pytest.raises(Refusal, match="a test is connected to this Blender already"):
        attached().about  # noqa: B018 - connects
    listener.several = True
    second = attached()
    assert second.about == first.about
    first.close()
    second.close()
    assert becomes(lambda: not listener.clients)


def test_a_stranger_learns_nothing(listener: Listener) -> None:
    with socket.create_connection(("127.0.0.1", listener.port)) as sock:
        end = link.Link(sock, "b" * 64)
        end.send({"hello": {"name": "a stranger", "protocol": link.PROTOCOL}})
        with pytest.raises((EOFError, OSError)):
            end.receive()
    assert listener.requests.empty()


def test_a_page_in_a_browser_gets_no_answer(listener: Listener) -> None:
    body = b'{"tool": "execute", "arguments": {"code": "1"}}'
    head = b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: https://example.org\r\nContent-Length: %d\r\n\r\n"
    for request in (
        head % len(body) + body,
        b"GET / HTTP/1.1\r\nUpgrade: websocket\r\nHost: 127.0.0.1\r\n\r\n",
    ):
        with socket.create_connection(("127.0.0.1", listener.port), timeout=10) as sock:
            sock.sendall(request)
            sock.shutdown(socket.SHUT_WR)
            received = b""
            with contextlib.suppress(ConnectionError):
                while data := sock.recv(4096):
                    received += data
            # random bytes, which each end sends before it knows the other
            assert len(received) <= link.NONCE_BYTES, "it was answered"
    assert listener.requests.empty()
    assert not listener.clients


def test_a_call_that_is_given_up_is_withdrawn(listener: Listener, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("agents.blender.attached.attached_blender._GRACE_SECONDS", 0.1)
    blender = attached()
    with pytest.raises(Refusal, match=r"has not answered slow work in .* s\. It was withdrawn"):
        blender.call("tool", {}, unread, timeout=0.1, what="slow work")
    request = listener.requests.get(timeout=10)
    assert becomes(lambda: request.withdrawn)
    blender.close()


def test_what_a_client_has_asked_is_dropped_when_it_leaves(listener: Listener) -> None:
    blender = attached()
    blender._connected().send({"ticket": "t", "tool": "tool", "arguments": {}, "seconds": 60})
    request = listener.requests.get(timeout=10)
    assert not request.withdrawn
    blender.close()
    assert becomes(lambda: request.withdrawn)


def test_a_goodbye_is_told_once_and_the_next_call_connects_again(listener: Listener) -> None:
    blender = attached()
    assert blender.about
    with TURNS:
        for client in listener.clients:
            client.end("The user has stopped SimWorlds in Blender's panel.")
    assert becomes(lambda: not listener.clients)
    with pytest.raises(Refusal, match="The user has stopped SimWorlds in Blender's panel"):
        blender.about  # noqa: B018 - connects
    assert blender.about.process == os.getpid()
    blender.close()


def test_a_client_that_left_while_blender_was_busy_keeps_nobody_out(listener: Listener) -> None:
    first, second = attached(), attached()
    assert first.about
    with TURNS:  # Blender is busy
        first.close()
        enters = threading.Thread(target=lambda: second.about)
        enters.start()
        enters.join(2.5)  # longer than a client that leaves is waited for
    enters.join(10)
    assert [client.open for client in listener.clients] == [True]
    assert second.about
    second.close()


def _mischief(port: int, chance: random.Random) -> None:
    """What a broken or a hostile client sends."""
    with (
        contextlib.suppress(OSError, EOFError),
        socket.create_connection(("127.0.0.1", port), timeout=2) as sock,
    ):
        kind = chance.randrange(6)
        if kind == 0:
            return  # gone at once
        if kind == 1:
            sock.sendall(chance.randbytes(chance.randrange(1, 5000)))
            return
        end = link.Link(sock, TOKEN if kind > 2 else "c" * 64)
        if kind == 3:
            end.send(chance.choice([{}, {"hello": None}, {"hello": {"protocol": 99}}, {"ticket": "t"}]))
        else:
            end.send({"hello": {"name": "x" * 5000, "protocol": link.PROTOCOL}})
            end.receive()
            for message in ({"tool": 1}, {"ticket": [], "tool": "", "arguments": 5}, {"withdraw": {}}):
                end.send(message)
        if kind == 5:
            sock.sendall(chance.randbytes(100))
        end.timeout(0.2)
        end.receive()


def test_an_honest_client_is_served_among_broken_ones(listener: Listener) -> None:
    listener.several = True
    blender = attached()
    ending = threading.Event()

    def answer() -> None:
        while not ending.is_set():
            with contextlib.suppress(queue.Empty):
                request = listener.requests.get(timeout=0.05)
                with TURNS:
                    request.reply(value=request.arguments, seconds=0.0, left=[], events=[])
                    listener.finished(request)

    def trouble(seed: int) -> None:
        chance = random.Random(seed)
        while not ending.is_set():
            _mischief(listener.port, chance)

    assert blender.about
    threads = [
        threading.Thread(target=answer),
        *(threading.Thread(target=trouble, args=(n,)) for n in range(4)),
    ]
    for thread in threads:
        thread.start()
    try:
        for number in range(100):
            assert blender.call("tool", {"n": number}, dict, timeout=20).value == {"n": number}
    finally:
        ending.set()
        for thread in threads:
            thread.join()
    assert becomes(lambda: len(listener.clients) == 1 and not listener._strangers)
    blender.close()
    assert becomes(lambda: not listener.clients and not listener._waiting)
