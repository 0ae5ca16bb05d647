"""Pictures that nobody vouches for, decoded by a real confined process."""

from __future__ import annotations

import io
import os
import signal
import struct
import zlib
from contextlib import closing
from typing import TYPE_CHECKING

import pytest
from PIL import Image
from sandboxes import sandbox_of, skip_unless_it_works

from simworlds.sandbox.confinement.confined_command import best_sandbox
from simworlds.sandbox.errors import Refusal
from simworlds.sandbox.pictures import picture_decoder
from simworlds.sandbox.pictures.decode_pictures import FORMATS, PICTURE
from simworlds.sandbox.pictures.picture_decoder import PictureDecoder

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


@pytest.fixture(scope="module")
def decoder() -> Iterator[PictureDecoder]:
    with closing(PictureDecoder(best_sandbox())) as opened:
        yield opened


def encoded(picture: Image.Image, kind: str = "PNG") -> io.BytesIO:
    file = io.BytesIO()
    picture.save(file, kind)
    return io.BytesIO(file.getvalue())


def gradient(width: int, height: int) -> Image.Image:
    return Image.linear_gradient("L").resize((width, height)).convert("RGB")


@pytest.mark.parametrize("kind", ["bubblewrap", "landlock"])
def test_gives_the_pixels_whatever_confines_it(kind: str) -> None:
    picture = gradient(300, 200)
    with closing(PictureDecoder(sandbox_of(skip_unless_it_works(kind)))) as confined:
        read = confined.decode(encoded(picture), "gradient")
    assert read.image.tobytes() == picture.tobytes()
    assert read.size == (300, 200)
    assert read.ranges == picture.getextrema()


def test_shrinks_and_tells_the_size_before(decoder: PictureDecoder) -> None:
    read = decoder.decode(encoded(gradient(900, 300)), "wide", longest=90)
    assert (read.size, read.image.size) == ((900, 300), (90, 30))


def test_equal_pixels_have_equal_digests(decoder: PictureDecoder) -> None:
    first, second, other = (gradient(40, 40 + more) for more in (0, 0, 1))
    digests = [decoder.decode(encoded(picture), "x", longest=8).digest for picture in (first, second, other)]
    assert digests[0] == digests[1] != digests[2]


def test_a_colour_lies_behind_what_is_transparent(decoder: PictureDecoder) -> None:
    clear = Image.new("RGBA", (4, 4), (255, 0, 0, 0))
    read = decoder.decode(encoded(clear), "clear", under=(1, 2, 3))
    assert read.image.getpixel((0, 0)) == (1, 2, 3)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"no picture",
        b"\x89PNG\r\n\x1a\n" + b"\0" * 100,
        b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n(%pipe%id>/tmp/x)(w)file\n",
        encoded(gradient(9, 9), "JPEG").getvalue(),
        encoded(gradient(9, 9)).getvalue()[:60],
    ],
    ids=["nothing", "text", "a head alone", "PostScript", "another format", "cut off"],
)
def test_what_is_no_whole_png_is_refused(decoder: PictureDecoder, data: bytes) -> None:
    with pytest.raises(Refusal, match=r"The picture made\.png cannot be read: "):
        decoder.decode(io.BytesIO(data), "made.png")
    assert decoder.decode(encoded(gradient(9, 9)), "after").size == (9, 9)


def test_other_formats_are_read_where_they_are_named(decoder: PictureDecoder) -> None:
    read = decoder.decode(encoded(gradient(9, 7), "JPEG"), "photo", formats=FORMATS)
    assert read.size == (9, 7)


def bomb(width: int, height: int) -> io.BytesIO:
    """A PNG of few bytes with this many black pixels."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    packer = zlib.compressobj(9)
    rows = b"".join(packer.compress(bytes(1 + width)) for _ in range(height)) + packer.flush()
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return io.BytesIO(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
    )


def test_too_many_pixels_are_refused_before_they_are_unpacked(decoder: PictureDecoder) -> None:
    with pytest.raises(Refusal, match="20000 × 5000 pixels; the limit is 1,000,000"):
        decoder.decode(bomb(20_000, 5_000), "bomb", most_pixels=1_000_000)


def test_a_decoder_that_was_killed_is_replaced(decoder: PictureDecoder) -> None:
    decoder.decode(encoded(gradient(9, 9)), "before")
    assert decoder._process is not None
    os.kill(decoder._process.pid, signal.SIGKILL)
    decoder._process.wait()
    assert decoder.decode(encoded(gradient(9, 9)), "after").size == (9, 9)


LIAR = """
import os, struct, sys
head = b""
while len(head) < {request}:
    head += os.read(0, {request} - len(head))
os.write(1, {answer!r})
{then}
"""


@pytest.mark.parametrize(
    ("answer", "then", "why"),
    [
        (PICTURE.pack(0, 9, 9, 60_000, 60_000, *[0] * 6, bytes(32)), "", "it claims 60000 × 60000 pixels"),
        (PICTURE.pack(0, 9, 9, 0, 9, *[0] * 6, bytes(32)), "", "it claims 0 × 9 pixels"),
        (PICTURE.pack(0, 9, 9, 9, 9, *[0] * 6, bytes(32)), "", "it ended"),
        (b"", "import time; time.sleep(60)", "timed out"),
    ],
    ids=["huge", "empty", "too short", "silent"],
)
def test_a_decoder_that_lies_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: bytes, then: str, why: str
) -> None:
    script = tmp_path / "liar.py"
    script.write_text(LIAR.format(request=picture_decoder.REQUEST.size, answer=answer, then=then))
    monkeypatch.setattr(picture_decoder.decode_pictures, "__file__", str(script))
    monkeypatch.setattr(picture_decoder, "_SECONDS", 2.0)
    with closing(PictureDecoder(best_sandbox())) as liar:
        with pytest.raises(Refusal, match=f"its decoder was stopped .*{why}"):
            liar.decode(encoded(gradient(9, 9)), "x", longest=100)
        assert liar._process is None
