# SPDX-License-Identifier: GPL-3.0-or-later
"""Where members stand in Blender's own structures: every .blend carries a description of those of its Blender.

What Blender keeps to itself, and its Python does not tell, can so be read in the version that runs, whichever it is.
"""

import functools
import os
import struct
import tempfile

from . import libraries

_POINTER = struct.calcsize("P")
_SINCE_5 = b"BLENDER17"


@functools.lru_cache(maxsize=None)
def offset_of(structure, member):
    """The offset of a member in bytes; None if this Blender's structure has no such member, or is not described."""
    try:
        return _search(structure, member)
    except (OSError, RuntimeError, ValueError, IndexError, struct.error):
        return None


def _search(structure, member):
    """Raises ValueError if there is none, OSError, RuntimeError and the like if the file is not as expected."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "structures.blend")
        libraries.write(path, (), compress=False)
        with open(path, "rb") as file:
            data = file.read()
    if data[:9] == _SINCE_5:
        order, at, head, length = "<", 17, 32, (16, "q")
    elif data[:8] == b"BLENDER-":
        order, at, head, length = "<" if data[8:9] == b"v" else ">", 12, 24, (4, "i")
    else:
        raise ValueError("it is not a .blend of 64 bits")
    while data[at : at + 4] != b"DNA1":
        at += head + struct.unpack_from(order + length[1], data, at + length[0])[0]
    names, types, lengths, structures = _described(data, at + head, order)
    for kind, members in structures:
        if types[kind] != structure:
            continue
        offset = 0
        for of_type, of_name in members:
            name = names[of_name]
            if name.lstrip("*(").partition("[")[0] == member:
                return offset
            size = _POINTER if name.startswith(("*", "(")) else lengths[of_type]
            for part in name.split("[")[1:]:
                size *= int(part.rstrip("]"))
            offset += size
    raise ValueError(f"{structure} has no {member}")


def _described(data, start, order):
    """(names, types, their lengths, [(type, [(type, name), …]), …]) of the block at ``start``."""
    at = start + 4  # SDNA

    def strings(tag):
        nonlocal at
        at += -(at - start) % 4
        if data[at : at + 4] != tag:
            raise ValueError(f"{tag} is missing")
        (count,) = struct.unpack_from(order + "i", data, at + 4)
        at += 8
        found = []
        for _ in range(count):
            end = data.index(b"\0", at)
            found.append(data[at:end].decode("ascii"))
            at = end + 1
        return found

    names, types = strings(b"NAME"), strings(b"TYPE")
    at += -(at - start) % 4 + 4
    lengths = struct.unpack_from(f"{order}{len(types)}h", data, at)
    at += 2 * len(types)
    at += -(at - start) % 4 + 4
    (count,) = struct.unpack_from(order + "i", data, at)
    at += 4
    structures = []
    for _ in range(count):
        kind, size = struct.unpack_from(order + "2h", data, at)
        pairs = struct.unpack_from(f"{order}{2 * size}h", data, at + 4)
        structures.append((kind, list(zip(pairs[::2], pairs[1::2], strict=True))))
        at += 4 + 4 * size
    return names, types, lengths, structures
