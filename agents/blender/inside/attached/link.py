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
MEET_SECONDS = 5.0
PROTOCOL = 1
_CHUNK = 1 << 16


class Link:
    """One end of a connection. ``send`` may be called by one thread and ``receive`` by another."""

    def __init__(self, sock, token, *, listens):
        """Exchanges the random bytes. Raises OSError, and EOFError if the other end closes."""
        self._sock = sock
        sock.settimeout(MEET_SECONDS)
        mine = secrets.token_bytes(NONCE_BYTES)
        sock.sendall(mine)
        theirs = b""
        while len(theirs) < NONCE_BYTES:
            theirs += self._read(NONCE_BYTES - len(theirs))
        both = mine + theirs if listens else theirs + mine
        key = hmac.new(token.encode(), b"simworlds/" + both, hashlib.sha256).digest()
        own, other = (channel.WORKER, channel.SUPERVISOR) if listens else (channel.SUPERVISOR, channel.WORKER)
        self._encode = channel.Encoder(key, own)
        self._decoder = channel.Decoder(key, other)
        self._waiting = []

    def fileno(self):
        """The socket's descriptor."""
        return self._sock.fileno()

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
        with contextlib.suppress(OSError):
            self._sock.shutdown(socket.SHUT_RDWR)
        self._sock.close()
