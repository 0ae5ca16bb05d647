# SPDX-License-Identifier: GPL-3.0-or-later
"""What is in the files that data-blocks use, wherever they lie: the same whether packed, moved or copied."""

import functools
import hashlib
import os

import bpy

_WHOLE = 256 * 1024 * 1024  # bytes; of larger files, only this many, and the size


def contents_of_path(path, block):
    """(the file's name, digest of what is in it); the digest is None where there is no such file. "" for no path."""
    if not path:
        return ""
    try:
        real = bpy.path.abspath(path, library=getattr(block, "library", None))
        found = os.stat(real)
        return os.path.basename(real), _digest(real, found.st_mtime_ns, found.st_size)
    except (OSError, ValueError):
        return bpy.path.basename(path), None


def contents_of_image(image):
    """Of the files that hold its pixels: each one's number and what is in it."""
    if packed := [(one.tile_number, _of_packed(one.packed_file)) for one in image.packed_files]:
        return sorted(packed)
    if image.source == "TILED":
        paths = [(tile.number, image.filepath.replace("<UDIM>", str(tile.number))) for tile in image.tiles]
        return sorted((number, _bare(contents_of_path(path, image))) for number, path in paths)
    return [(1001, _bare(contents_of_path(image.filepath, image)))] if image.filepath else []


def _bare(told):
    return told[1] if told else None


def _of_packed(file):
    return _of_bytes(file.data, file.size) if file is not None else None


def _of_bytes(data, size):
    return (hashlib.blake2b(data[:_WHOLE], digest_size=12).hexdigest(), size)


@functools.lru_cache(maxsize=10_000)
def _digest(path, _written, size):
    if not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        return _of_bytes(file.read(_WHOLE), size)
