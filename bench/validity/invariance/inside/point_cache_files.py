# SPDX-License-Identifier: GPL-3.0-or-later
"""Scales the lengths in Blender's point cache files (.bphys).

A file is a magic word, a type with flags, the number of points and a mask of the kinds of data; then, for each kind,
whether it is compressed, and the data of all points. Compressed data are Zstandard over the bytes of each place in a
point's record, one place after the other, as differences from point to point.
"""

import struct

import numpy
import zstandard

_MAGIC = b"BPHYSICS"
_HEAD = struct.Struct("<8sIII")
_SIZE = struct.Struct("<I")
_CLOTH = 2
_LOCATION, _VELOCITY, _REST, _SIZES = 1, 2, 4, 5  # bits of the mask
_KINDS = 8
_RAW, _FILTERED = 0, 3


def multiply(path, factor):
    """Multiplies all lengths in a file by ``factor``. Raises ValueError for a file of another format."""
    with open(path, "rb") as file:
        data = file.read()
    magic, kind, count, mask = _HEAD.unpack_from(data)
    if magic != _MAGIC:
        raise ValueError(f"{path} is not a point cache")
    lengths = {_LOCATION, _VELOCITY, _SIZES} | ({_REST} if kind & 0xFFFF == _CLOTH else set())
    written, place = [data[: _HEAD.size]], _HEAD.size
    for bit in range(_KINDS):
        if count and mask >> bit & 1:
            values, place = _read(data, place, count)
            if bit in lengths:
                values = (numpy.frombuffer(values, "<f4") * numpy.float32(factor)).tobytes()
            written += [bytes([_RAW]), values]
    with open(path, "wb") as file:
        file.write(b"".join([*written, data[place:]]))


def _read(data, place, count):
    """(one kind of data of all points, where the next one begins)."""
    if data[place] != _FILTERED:
        raise ValueError(f"unknown compression of a point cache ({data[place]})")
    (size,) = _SIZE.unpack_from(data, place + 1)
    start = place + 1 + _SIZE.size
    packed = zstandard.ZstdDecompressor().decompressobj().decompress(data[start : start + size])
    places = numpy.frombuffer(packed, numpy.uint8).reshape(-1, count)
    return numpy.add.accumulate(places, axis=1, dtype=numpy.uint8).T.tobytes(), start + size
