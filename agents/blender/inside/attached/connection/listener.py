# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes calls on a port of this machine, without threads: whatever there is to do is done in ``turn``.

Blender's operators let other threads of Python run, and where a context is overridden, look names up in it as if there
were none: a thread that runs at that moment damages Python's memory, and crashes Blender in the end (seen in 3.4.1).

A call is a ``Request``; ``reply`` answers it. A client that leaves takes its waiting calls along.
"""

import contextlib
import queue
import socket
import time

from simworlds.sandbox.inside import channel

from .link import MEET_SECONDS, PROTOCOL, OpenEnd

_LAST_WORDS_SECONDS = 0.3  # in which clients are told why it ends
_LONGEST_NAME = 100
_MOST_WAITING = 64
_MOST_CLIENTS = 8
_MOST_STRANGERS = 8  # connections that have not said who they are


class Request:
    """A call of a client: ``tool`` with ``arguments``, to begin before ``deadline`` (monotonic)."""

    def __init__(self, client, message):
        self.client = client
        self.ticket = str(message["ticket"])
        self.tool = str(message["tool"])
        self.arguments = dict(message.get("arguments") or {})
        self.seconds = float(message.get("seconds") or 60.0)
        self.deadline = time.monotonic() + self.seconds
        self.arrived = time.monotonic()
        self.withdrawn = False
        self.step = ""  # what the call does to the scene, in words

    def reply(self, **answer):
        """Sends the answer; it never waits."""
        self.client.send({"ticket": self.ticket, **answer})


class Client:
    """A client: its ``name``, and ``events`` that its next answer is to tell."""

    def __init__(self, end, name):
        self.name = name
        self.events = []
        self.open = True
        self._end = end
        self._leaves = False

    @property
    def waits(self):
        """Whether something was not sent yet."""
        return not self._end.is_sent

    def send(self, message):
        """Sends a message, as soon as the client takes it."""
        if not self.open:
            return
        try:
            try:
                self._end.send(message)
            except (channel.TooLarge, TypeError, ValueError, RecursionError) as error:
                refusal = f"The reply cannot be sent: {error}."
                self._end.send({"ticket": message.get("ticket", ""), "refused": refusal})
        except OSError:
            self.close()

    def end(self, why=""):
        """Ends the connection once all is sent; ``why`` is told to the client."""
        if why:
            self.send({"goodbye": why})
        self._leaves = True
        self.flush()

    def flush(self):
        """Sends what waits; closes the connection if it is to end."""
        if not self.open:
            return
        try:
            self._end.flush()
        except OSError:
            self.close()
        if self._leaves and self._end.is_sent:
            self.close()

    def receive(self):
        """The messages that have come; closes the connection at its end."""
        try:
            return self._end.receive()
        except (OSError, EOFError, channel.ForgedFrame):
            self.close()
            return []

    def close(self):
        """Closes the connection at once."""
        self.open = False
        self._end.close()


class Listener:
    """Listens until ``stop``. ``about`` is what clients are told at first, ``several`` whether more than one may be
    connected; both may be replaced at any time. ``requests`` are the calls, ``changed`` is set when clients come or
    go."""

    def __init__(self, token, about):
        self.about = about
        self.several = False
        self.requests = queue.SimpleQueue()
        self.changed = False
        self._token = token
        self._strangers = []  # (their end, until when they have to say who they are)
        self._clients = []
        self._waiting = {}
        self._socket = socket.create_server(("127.0.0.1", 0), backlog=_MOST_STRANGERS)
        self._socket.setblocking(False)
        self.port = self._socket.getsockname()[1]

    @property
    def clients(self):
        """The clients that are connected now."""
        return [client for client in self._clients if client.open]

    @property
    def is_talking(self):
        """Whether somebody waits to be let in, or for what was not sent yet."""
        return bool(self._strangers) or any(client.waits for client in self.clients)

    def turn(self):
        """Lets clients in, takes what they have sent, and sends what they take; it never waits."""
        for client in list(self._clients):  # before strangers, who may come in place of one that has left
            client.flush()
            if client.open:
                self._take(client, client.receive())
            if not client.open:
                self._forget(client)
        self._accept()
        for stranger in list(self._strangers):
            self._meet(*stranger)

    def stop(self, why):
        """Tells all clients ``why``, and stops listening."""
        self._socket.close()
        for end, _ in self._strangers:
            end.close()
        self._strangers.clear()
        clients, deadline = self.clients, time.monotonic() + _LAST_WORDS_SECONDS
        for client in clients:
            client.end(why)
        while any(client.open for client in clients) and time.monotonic() < deadline:
            time.sleep(0.005)
            for client in clients:
                client.flush()
        for client in clients:
            client.close()
            self._forget(client)

    def _accept(self):
        with contextlib.suppress(OSError):  # nobody waits
            while len(self._strangers) < _MOST_STRANGERS:
                sock, _ = self._socket.accept()
                sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._strangers.append((OpenEnd(sock, self._token), time.monotonic() + MEET_SECONDS))

    def _meet(self, end, until):
        """Makes a client of a stranger that has said who it is."""
        messages = []
        try:
            end.flush()
            messages = end.receive()
            if not messages and time.monotonic() < until:
                return
            client = self._admitted(end, messages[0]["hello"])
        except (OSError, EOFError, channel.ForgedFrame, LookupError, TypeError, AttributeError):
            client = None
        self._strangers.remove((end, until))
        if client is None:
            end.close()
            return
        self._take(client, messages[1:])

    def _admitted(self, end, hello):
        """The client; None if it must not enter, which it is told."""
        name = str(hello.get("name") or "a client")[:_LONGEST_NAME]
        inside = [client.name for client in self.clients]
        refusal = ""
        if hello.get("protocol") != PROTOCOL:
            refusal = "The SimWorlds extension in Blender and this SimWorlds are of different versions."
        elif len(inside) >= (_MOST_CLIENTS if self.several else 1):
            refusal = f"{inside[0]} is connected to this Blender already."
        if refusal:
            end.send({"refused": refusal})
            return None
        client = Client(end, name)
        self._clients.append(client)
        client.send({"welcome": self.about})
        self.changed = True
        return client

    def _take(self, client, messages):
        try:
            for message in messages:
                if "withdraw" in message:
                    if (request := self._waiting.get(message["withdraw"])) is not None:
                        request.withdrawn = True
                else:
                    self._queue(Request(client, message))
        except (LookupError, TypeError, ValueError):  # not of this protocol
            client.close()

    def _queue(self, request):
        if self.requests.qsize() >= _MOST_WAITING:
            request.reply(refused=f"{_MOST_WAITING} calls are waiting already.", seconds=0.0, left=[])
            return
        self._waiting[request.ticket] = request
        self.requests.put(request)

    def finished(self, request):
        """A request is answered."""
        self._waiting.pop(request.ticket, None)

    def _forget(self, client):
        if client in self._clients:
            self._clients.remove(client)
        for request in self._waiting.values():
            if request.client is client:
                request.withdrawn = True
        self.changed = True
