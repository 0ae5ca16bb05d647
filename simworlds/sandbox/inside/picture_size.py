# SPDX-License-Identifier: GPL-3.0-or-later
"""The width and height of images in a file, without decoding them."""

import os
import stat
import struct

import bpy

_HEAD = 1 << 20  # bytes; a JPEG's size comes after its metadata
_PNG, _JPEG = b"\x89PNG\r\n\x1a\n", b"\xff\xd8"
_WITHOUT_SIZE = {0xC4, 0xC8, 0xCC}  # JPEG markers between the frame headers that are none


def of_image(image):
    """(width, height) in pixels of an image; (0, 0) where only decoding could tell.

    Generated images are known by their settings, others by the start of their PNG or JPEG: Image.size would load them.
    """
    if image.source == "GENERATED":
        return image.generated_width, image.generated_height
    packed = image.packed_file
    return of_bytes(packed.data[:_HEAD] if packed is not None else _start_of(image))


def of_bytes(head):
    """(width, height) by the first bytes of a PNG or JPEG; (0, 0) if they do not tell."""
    if head.startswith(_PNG) and len(head) >= 24:
        return struct.unpack(">II", head[16:24])
    at = 2 if head.startswith(_JPEG) else len(head)
    while at + 9 <= len(head) and head[at] == 0xFF:
        marker = head[at + 1]
        if 0xC0 <= marker <= 0xCF and marker not in _WITHOUT_SIZE:
            height, width = struct.unpack(">HH", head[at + 5 : at + 9])
            return width, height
        if marker == 0xFF:
            at += 1
            continue
        at += 2 + struct.unpack(">H", head[at + 2 : at + 4])[0]
    return 0, 0


def _start_of(image):
    """The first bytes of an image's file; b"" if there is no such regular file."""
    path = bpy.path.abspath(image.filepath, library=image.library)
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    except (OSError, ValueError):
        return b""
    try:
        return os.read(descriptor, _HEAD) if stat.S_ISREG(os.fstat(descriptor).st_mode) else b""
    except OSError:
        return b""
    finally:
        os.close(descriptor)
