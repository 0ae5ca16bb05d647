# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes calls on a port of this machine. Its threads know nothing of Blender: the main thread takes calls from a queue.

A call is a ``Request``; the main thread answers it with ``reply``. A client that leaves takes its waiting calls along.
"""

import contextlib
import queue
import socket
import threading
import time

from simworlds.sandbox.inside import channel

from .link import PROTOCOL, Link

_SEND_SECONDS = 20.0
_LAST_WORDS_SECONDS = 0.3  # in which clients are told why it ends
_LONGEST_NAME = 100
_MOST_WAITING = 64
_MOST_CLIENTS = 8


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
        """Sends the answer, from any thread; it never waits."""
        self.client.send({"ticket": self.ticket, **answer})


class Client:
    """A client: its ``name``, and ``events`` that its next answer is to tell."""

    def __init__(self, link, name):
        self.name = name
        self.events = []
        self._link = link
        self._outgoing = queue.SimpleQueue()
        self.open = True

    def send(self, message):
        """Puts a message into the queue of what is sent."""
        self._outgoing.put(message)

    def keep_sending(self):
        """Sends what is in the queue until it is told to end, or the client does not take it."""
        try:
            while (message := self._outgoing.get()) is not None:
                try:
                    self._link.send(message)
                except (channel.TooLarge, TypeError, ValueError, RecursionError) as error:
                    self._link.send(
                        {
                            "ticket": message.get("ticket", ""),
                            "refused": f"The reply cannot be sent: {error}.",
                        }
                    )
        except OSError:
            pass
        finally:
            self.open = False
            self._link.close()

    def end(self, why=""):
        """Ends the connection after what is in the queue; ``why`` is told to the client."""
        if why:
            self.send({"goodbye": why})
        self._outgoing.put(None)


class Listener:
    """Listens until ``stop``. ``about`` is what clients are told at first, ``several`` whether more than one may be
    connected; the main thread may replace both at any time."""

    def __init__(self, token, about):
        self.about = about
        self.several = False
        self.requests = queue.SimpleQueue()
        self.changed = threading.Event()
        self._token = token
        self._clients = []
        self._waiting = {}
        self._lock = threading.Lock()
        self._socket = socket.create_server(("127.0.0.1", 0), backlog=4)
        self.port = self._socket.getsockname()[1]
        self._stopped = False
        threading.Thread(target=self._accept, name="simworlds-listen", daemon=True).start()

    @property
    def clients(self):
        """The clients that are connected now."""
        with self._lock:
            return [client for client in self._clients if client.open]

    def stop(self, why):
        """Tells all clients ``why``, and stops listening."""
        self._stopped = True
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)  # wakes the thread that waits for clients
        self._socket.close()
        clients, deadline = self.clients, time.monotonic() + _LAST_WORDS_SECONDS
        for client in clients:
            client.end(why)
        while any(client.open for client in clients) and time.monotonic() < deadline:
            time.sleep(0.005)

    def _accept(self):
        while not self._stopped:
            try:
                sock, _ = self._socket.accept()
            except OSError:
                if self._stopped:
                    return
                time.sleep(0.2)
                continue
            threading.Thread(target=self._serve, args=(sock,), name="simworlds-client", daemon=True).start()

    def _serve(self, sock):
        sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        link = client = None
        try:
            link = Link(sock, self._token, listens=True)
            hello = link.receive()["hello"]
            client = self._admitted(link, hello)
            if client is None:
                return
            link.timeout(None)
            threading.Thread(target=client.keep_sending, name="simworlds-send", daemon=True).start()
            while True:
                self._take(client, link.receive())
        except (OSError, EOFError, channel.ForgedFrame, KeyError, TypeError, ValueError):
            pass
        finally:
            if client is not None:
                self._forget(client)
            elif link is not None:
                link.close()
            else:
                sock.close()

    def _admitted(self, link, hello):
        """The client; None if it must not enter, which it is told."""
        name = str(hello.get("name") or "a client")[:_LONGEST_NAME]
        with self._lock:
            inside = [client.name for client in self._clients if client.open]
            refusal = ""
            if hello.get("protocol") != PROTOCOL:
                refusal = "The SimWorlds extension in Blender and this SimWorlds are of different versions."
            elif len(inside) >= (_MOST_CLIENTS if self.several else 1):
                refusal = f"{inside[0]} is connected to this Blender already."
            client = None if refusal else Client(link, name)
            if client is not None:
                self._clients.append(client)
        if client is None:
            link.send({"refused": refusal})
            return None
        client.send({"welcome": self.about})
        self.changed.set()
        return client

    def _take(self, client, message):
        if "withdraw" in message:
            request = self._waiting.get(message["withdraw"])
            if request is not None:
                request.withdrawn = True
            return
        request = Request(client, message)
        if self.requests.qsize() >= _MOST_WAITING:
            request.reply(refused=f"{_MOST_WAITING} calls are waiting already.", seconds=0.0, left=[])
            return
        self._waiting[request.ticket] = request
        self.requests.put(request)

    def finished(self, request):
        """The main thread is done with a request."""
        self._waiting.pop(request.ticket, None)

    def _forget(self, client):
        client.open = False
        client.end()
        with self._lock:
            self._clients.remove(client)
        for request in list(self._waiting.values()):
            if request.client is client:
                request.withdrawn = True
        self.changed.set()
