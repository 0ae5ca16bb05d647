"""Reads pictures that a sandboxed process made. They are decoded in another confined process; this one gets pixels."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from PIL import Image

from simworlds.processes import end_group, spawn
from simworlds.sandbox.confinement.confined_command import own_python
from simworlds.sandbox.confinement.resource_limits import GIB, ResourceLimits
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.pictures import decode_pictures
from simworlds.sandbox.pictures.decode_pictures import FAULT, FORMATS, LONGEST_FAULT, PICTURE, REQUEST
from simworlds.sandbox.runtime import clean_environment

if TYPE_CHECKING:
    from typing import BinaryIO

    from simworlds.sandbox.confinement.confined_command import Sandbox

MOST_PIXELS = 8192 * 8192
LARGEST_FILE = 512 << 20  # bytes
_SECONDS = 60.0
_LIMITS = ResourceLimits(memory=2 * GIB, file_size=1)
Colour = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class DecodedPicture:
    """An RGB ``image``, shrunk if that was asked for, and what the whole picture was: its ``size`` (pixels),
    the lowest and highest value of each channel (0 to 255), and a ``digest`` of its pixels."""

    image: Image.Image
    size: tuple[int, int]
    ranges: tuple[tuple[int, int], tuple[int, int], tuple[int, int]]
    digest: str


class PictureDecoder:
    """A decoder, started with the first picture, for one thread at a time; ``sandbox``: how it is confined."""

    def __init__(self, sandbox: Sandbox) -> None:
        self._sandbox = replace(sandbox, limits=_LIMITS)
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None

    def decode(  # noqa: PLR0913 - what a caller may want of a picture
        self,
        file: BinaryIO,
        name: str,
        *,
        longest: int = 0,
        most_pixels: int = MOST_PIXELS,
        under: Colour = (255, 255, 255),
        formats: tuple[str, ...] = FORMATS[:1],
    ) -> DecodedPicture:
        """Decodes a picture of at most ``most_pixels`` in one of ``formats``, ``under`` behind what is transparent.

        ``longest``: its side is at most that long afterwards (0: as it is). Raises Refusal, which calls it ``name``.
        """
        data = file.read(LARGEST_FILE + 1)
        if len(data) > LARGEST_FILE:
            raise Refusal(f"The picture {name} has more than {LARGEST_FILE:,} bytes.")
        kinds = sum(1 << FORMATS.index(kind) for kind in formats)
        deadline = time.monotonic() + _SECONDS
        try:
            wire = self._running()
            self._send(wire, REQUEST.pack(longest, most_pixels, *under, kinds, len(data)) + data, deadline)
            return self._answer(wire, longest or most_pixels, most_pixels, name, deadline)
        except Refusal:
            raise
        except (OSError, ValueError) as error:
            self.close()
            why = "it ended" if isinstance(error, ConnectionError) else error
            raise Refusal(f"The picture {name} cannot be read: its decoder was stopped ({why}).") from error
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Ends the process; a later picture starts another."""
        process, self._process = self._process, None
        wire, self._socket = self._socket, None
        if wire is not None:
            wire.close()
        if process is not None:
            end_group(process)

    def _running(self) -> socket.socket:
        if self._socket is not None and self._process is not None and self._process.poll() is None:
            return self._socket
        self.close()
        script = Path(decode_pictures.__file__)
        words = [sys.executable, "-I", str(script)]
        command = self._sandbox.command(words, read=[script, *map(Path, own_python())], write=[])
        ours, theirs = socket.socketpair()
        try:
            self._process = spawn(
                command,
                stdin=theirs,
                stdout=theirs,
                stderr=subprocess.DEVNULL,
                env=clean_environment(Path(os.devnull)),
                cwd="/",
            )
        except BaseException:
            ours.close()
            raise
        finally:
            theirs.close()
        self._socket = ours
        return ours

    @staticmethod
    def _send(wire: socket.socket, data: bytes, deadline: float) -> None:
        wire.settimeout(max(0.01, deadline - time.monotonic()))
        wire.sendall(data)

    @staticmethod
    def _receive(wire: socket.socket, count: int, deadline: float) -> bytes:
        data = bytearray(count)
        view = memoryview(data)
        while view:
            wire.settimeout(max(0.01, deadline - time.monotonic()))
            got = wire.recv_into(view)
            if not got:
                raise OSError("it ended")
            view = view[got:]
        return bytes(data)

    def _answer(
        self, wire: socket.socket, longest: int, most: int, name: str, deadline: float
    ) -> DecodedPicture:
        """What the decoder says is a claim too: sizes are checked before memory is taken for them."""
        head = self._receive(wire, FAULT.size, deadline)
        failed, size = FAULT.unpack(head)
        if failed:
            text = self._receive(wire, min(size, LONGEST_FAULT), deadline).decode("utf-8", "replace")
            raise Refusal(f"The picture {name} cannot be read: {text}.")
        rest = self._receive(wire, PICTURE.size - FAULT.size, deadline)
        fields = PICTURE.unpack(head + rest)
        whole, shown = cast("tuple[int, int]", fields[1:3]), cast("tuple[int, int]", fields[3:5])
        if max(shown) > longest or shown[0] * shown[1] > most or min(shown) < 1:
            raise ValueError(f"it claims {shown[0]} × {shown[1]} pixels")
        pixels = self._receive(wire, shown[0] * shown[1] * 3, deadline)
        ranges = (fields[5:7], fields[7:9], fields[9:11])
        return DecodedPicture(
            Image.frombytes("RGB", shown, pixels),
            whole,
            cast("tuple[tuple[int, int], tuple[int, int], tuple[int, int]]", ranges),
            fields[11].hex(),
        )
