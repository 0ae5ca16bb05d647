# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes texts in a .blend file on disk, where setting them in the open file would do more than that.

A .blend is a row of blocks, each with the number of the C struct that it holds; the block DNA1, near its end, lists the
structs with their fields (https://developer.blender.org/docs/features/core/blendfile/).
"""

import mmap
import os
import re
import struct

_OLD_HEAD = re.compile(rb"BLENDER([-_])([vV])\d{3}")
_NEW_HEAD = re.compile(rb"BLENDER(\d\d)-\d\d([vV])\d{4}")
_DIMENSION = re.compile(rb"\[(\d+)\]")
_LAST = b"ENDB"


class UnknownForm(Exception):  # noqa: N818 - reads as the state it names
    """The file is not as this module knows it; nothing was changed."""


def replace_texts(path, struct_name, field_name, renamed):
    """In the file at ``path``, gives a text field of all structs of a name the text that ``renamed`` has for its own.

    ``renamed``: {old text: new text}. Returns how many were changed. Raises UnknownForm.
    """
    if not os.path.getsize(path):  # of which there is no map
        raise UnknownForm(f"{path}: it is empty")
    with open(path, "r+b") as file, mmap.mmap(file.fileno(), 0) as data:
        try:
            order, blocks = _blocks(data)
            number, size, offset, room = _field(
                data, order, blocks, struct_name.encode(), field_name.encode()
            )
        except (struct.error, ValueError, IndexError, StopIteration) as error:
            raise UnknownForm(f"{path}: {error}") from None
        found = [block for block in blocks if block[3] == number and block[0] != b"DNA1"]
        if any(count * size > length for _, _, length, _, count in found) or offset + room > size:
            raise UnknownForm(f"{path}: {struct_name} does not fit where it lies")
        places = [start + step * size + offset for _, start, _, _, count in found for step in range(count)]
        new = {place: renamed.get(_text(data, place, room)) for place in places}
        texts = {place: text.encode() for place, text in new.items() if text is not None}
        if any(len(text) >= room for text in texts.values()):
            raise UnknownForm(f"{path}: {field_name} holds less than {room} bytes")
        for place, text in texts.items():
            data[place : place + room] = text.ljust(room, b"\0")
        return len(texts)


def _text(data, place, room):
    return data[place : place + room].partition(b"\0")[0].decode(errors="replace")


def _blocks(data):
    """(byte order, [(code, start of its content, length, number of its struct, how many of them)])."""
    if old := _OLD_HEAD.match(data[:12]):
        order = "<" if old[2] == b"v" else ">"
        pointer = "Q" if old[1] == b"-" else "I"
        head, place = struct.Struct(f"{order}4si{pointer}ii"), 12
        pick = (0, 1, 3, 4)
    elif new := _NEW_HEAD.match(data[:17]):
        order = "<" if new[2] == b"v" else ">"
        head, place = struct.Struct(f"{order}4siQqq"), int(new[1])
        pick = (0, 3, 1, 4)
    else:
        raise ValueError("it does not begin as a .blend that is not compressed")
    blocks = []
    while place + head.size <= len(data):
        entry = head.unpack_from(data, place)
        code, length, kind, count = (entry[at] for at in pick)
        code = code.rstrip(b"\0")
        if code == _LAST:
            return (order, 4 if head.size == 20 else 8), blocks
        if length < 0 or place + head.size + length > len(data):
            break
        blocks.append((code, place + head.size, length, kind, count))
        place += head.size + length
    raise ValueError("it ends too early")


def _field(data, order, blocks, struct_name, field_name):
    """(number of the struct, its size, offset of the field, its length in bytes)."""
    _, start, length, _, _ = next(block for block in blocks if block[0] == b"DNA1")
    (letter, pointer), dna = order, data[start : start + length]
    place = 4
    names, place = _texts(dna, letter, place, b"NAME")
    types, place = _texts(dna, letter, place, b"TYPE")
    place = _expect(dna, place, b"TLEN")
    sizes = struct.unpack_from(f"{letter}{len(types)}H", dna, place)
    place = _expect(dna, _aligned(place + 2 * len(types)), b"STRC")
    (count,) = struct.unpack_from(f"{letter}i", dna, place)
    place += 4
    for number in range(count):
        kind, fields = struct.unpack_from(f"{letter}HH", dna, place)
        place += 4
        if types[kind] != struct_name:
            place += 4 * fields
            continue
        offset = 0
        for at in range(fields):
            of, name = struct.unpack_from(f"{letter}HH", dna, place + 4 * at)
            items = 1
            for dimension in _DIMENSION.findall(names[name]):
                items *= int(dimension)
            room = items * (pointer if names[name][:1] in b"*(" else sizes[of])
            if names[name].partition(b"[")[0] == field_name:
                return number, sizes[kind], offset, room
            offset += room
    raise ValueError(f"it has no {struct_name.decode()}.{field_name.decode()}")


def _texts(dna, letter, place, code):
    place = _expect(dna, place, code)
    (count,) = struct.unpack_from(f"{letter}i", dna, place)
    texts = dna[place + 4 :].split(b"\0", count)[:count]
    return texts, _aligned(place + 4 + sum(len(text) + 1 for text in texts))


def _expect(dna, place, code):
    if dna[place : place + 4] != code:
        raise ValueError(f"its list of structs has no {code.decode()}")
    return place + 4


def _aligned(place):
    return (place + 3) // 4 * 4
