# SPDX-License-Identifier: GPL-3.0-or-later
"""The connection between an open Blender and SimWorlds: signed messages over a socket of this machine.

Both ends know the token and neither sends it: each sends random bytes first, and the key that signs the messages is
made of both and of the token. What was recorded of one connection is worth nothing on another.
"""

import contextlib
import hashlib
import hmac
import secrets
import socket

from simworlds.sandbox.inside import channel

NONCE_BYTES = 32
MEET_SECONDS = 20.0  # Blender answers when it has done what it is doing
PROTOCOL = 2
_CHUNK = 1 << 16
_MOST_AT_ONCE = 64  # chunks that are read before the window gets its turn
_MOST_UNSENT = 64 * 1024 * 1024


class Link:
    """SimWorlds' end of a connection, which waits. ``send`` may be called by one thread and ``receive`` by another."""

    def __init__(self, sock, token):
        """Exchanges the random bytes. Raises OSError, and EOFError if the other end closes."""
        self._sock = sock
        sock.settimeout(MEET_SECONDS)
        mine = secrets.token_bytes(NONCE_BYTES)
        sock.sendall(mine)
        theirs = b""
        while len(theirs) < NONCE_BYTES:
            theirs += self._read(NONCE_BYTES - len(theirs))
        key = _key(token, theirs + mine)
        self._encode = channel.Encoder(key, channel.SUPERVISOR)
        self._decoder = channel.Decoder(key, channel.WORKER)
        self._waiting = []

    def timeout(self, seconds):
        """Sets for how long reading and writing may wait; None: for ever."""
        self._sock.settimeout(seconds)

    def send(self, message):
        """Sends a dictionary. Raises OSError and channel.TooLarge."""
        self._sock.sendall(self._encode(message))

    def receive(self):
        """The next message. Raises EOFError at the end, OSError, and channel.ForgedFrame for a wrong token."""
        while not self._waiting:
            self._waiting = self._decoder.feed(self._read(_CHUNK))
        return self._waiting.pop(0)

    def _read(self, count):
        data = self._sock.recv(count)
        if not data:
            raise EOFError
        return data

    def close(self):
        """Closes the socket, in any state, from any thread."""
        _close(self._sock)


class OpenEnd:
    """The open Blender's end of a connection, which never waits: ``receive`` and ``flush`` do what can be done now."""

    def __init__(self, sock, token):
        sock.setblocking(False)
        self._sock, self._token = sock, token
        self._mine = secrets.token_bytes(NONCE_BYTES)
        self._received, self._unsent = b"", self._mine
        self._encode = self._decoder = None

    @property
    def is_sent(self):
        """Whether all has left."""
        return not self._unsent

    def receive(self):
        """The messages that have come, maybe none. Raises EOFError, OSError, and channel.ForgedFrame for a wrong
        token."""
        messages = []
        try:
            for _ in range(_MOST_AT_ONCE):
                data = self._sock.recv(_CHUNK)
                if not data and not messages:
                    raise EOFError
                if not data:
                    break
                messages += self._taken(data)
        except BlockingIOError:
            pass
        return messages

    def _taken(self, data):
        if self._decoder is not None:
            return self._decoder.feed(data)
        self._received += data
        if len(self._received) < NONCE_BYTES:
            return []
        theirs, more = self._received[:NONCE_BYTES], self._received[NONCE_BYTES:]
        key = _key(self._token, self._mine + theirs)
        self._encode = channel.Encoder(key, channel.WORKER)
        self._decoder = channel.Decoder(key, channel.SUPERVISOR)
        return self._decoder.feed(more)

    def send(self, message):
        """Sends a dictionary, now or with ``flush``. Raises OSError, channel.TooLarge, and what JSON cannot hold."""
        assert self._encode is not None
        self._unsent += self._encode(message)
        if len(self._unsent) > _MOST_UNSENT:
            raise OSError("the other end does not take what it is sent")
        self.flush()

    def flush(self):
        """Sends what the other end takes now. Raises OSError."""
        with contextlib.suppress(BlockingIOError):
            while self._unsent:
                self._unsent = self._unsent[self._sock.send(self._unsent) :]

    def close(self):
        """Closes the socket, in any state."""
        _close(self._sock)


def _key(token, both):
    return hmac.new(token.encode(), b"simworlds/" + both, hashlib.sha256).digest()


def _close(sock):
    with contextlib.suppress(OSError):
        sock.shutdown(socket.SHUT_RDWR)
    sock.close()
