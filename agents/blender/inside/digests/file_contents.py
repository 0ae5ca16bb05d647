# SPDX-License-Identifier: GPL-3.0-or-later
"""Digests of the files that data-blocks use: the same whether a file is packed, moved or copied."""

import functools
import hashlib
import os

import bpy

_WHOLE = 256 * 1024 * 1024  # bytes; of larger files, the digest covers this many, and the size


def contents_of_path(path, block):
    """(the file's name, a digest of its contents); the digest is None if there is no such file. "" for no path."""
    if not path:
        return ""
    try:
        real = bpy.path.abspath(path, library=getattr(block, "library", None))
        status = os.stat(real)
        return os.path.basename(real), _digest(real, status.st_mtime_ns, status.st_size)
    except (OSError, ValueError):
        return bpy.path.basename(path), None


def contents_of_image(image):
    """[(tile number, digest of the contents)] of the files that hold its pixels."""
    if packed := [(file.tile_number, _packed_digest(file.packed_file)) for file in image.packed_files]:
        return sorted(packed)
    if image.source == "TILED":
        paths = [(tile.number, image.filepath.replace("<UDIM>", str(tile.number))) for tile in image.tiles]
        return sorted((number, _digest_of(contents_of_path(path, image))) for number, path in paths)
    return [(1001, _digest_of(contents_of_path(image.filepath, image)))] if image.filepath else []


def _digest_of(content):
    return content[1] if content else None


def _packed_digest(file):
    return _bytes_digest(file.data, file.size) if file is not None else None


def _bytes_digest(data, size):
    return (hashlib.blake2b(data[:_WHOLE], digest_size=12).hexdigest(), size)


@functools.lru_cache(maxsize=10_000)
def _digest(path, _written, size):
    if not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        return _bytes_digest(file.read(_WHOLE), size)
