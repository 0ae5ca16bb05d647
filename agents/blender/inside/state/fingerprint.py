# SPDX-License-Identifier: GPL-3.0-or-later
"""Data-blocks, each as digests of its settings, so that states of a file at different times can be compared.

Two digests are equal when every setting is. They do not depend on the current frame, on what is selected, or on where
the file lies: what keyframes and drivers set is told by those, and files that are used by their contents. Written out
and opened again, a data-block has the digests that it had.
"""

import hashlib

import bpy

from .block_reader import Reader, is_id, key_of

_SHORT = 8  # letters of a part's digest: parts are told to differ, not to be the same
# The user interface's, and what tools paint with.
_NO_CONTENT = frozenset({"WindowManager", "Screen", "WorkSpace", "Brush", "Palette", "PaintCurve", "Library"})
_NO_PICTURES = frozenset({"RENDER_RESULT", "COMPOSITING"})


def fingerprint(scene):
    """{"Object Cube": digest, …} of all that ``scene`` reaches: what its pictures depend on, but for the frames.

    How and where to pictures are written does not count.
    """
    plans, reader = {}, {}
    for block in _reached([scene], plans, reader, pictures=True):
        reader[block] = _whole(reader[block])
    return {key_of(block): digest for block, digest in reader.items()}


def data_blocks(report):
    """Everything in the file that is kept when it is saved, but the user interface.

    Returns ``digests`` ({"Object Cube": digest}), ``parts`` ({"Object Cube": {"transform": digest, …}}) and ``uses``
    ({"Object Cube": {"data": ["Mesh Cube"], …}}: which data-blocks each part points to).
    """
    plans, read = {}, {}
    kept = _kept()
    for count, _ in enumerate(_reached(kept, plans, read, pictures=False)):
        if count % 500 == 499:
            report(count, None, "reading data-blocks")
    found = {key_of(block): parts for block, parts in read.items()}
    return {
        "digests": {key: _whole(parts) for key, parts in found.items()},
        "parts": {
            key: {name: digest[:_SHORT] for name, (digest, _) in parts.items()}
            for key, parts in found.items()
        },
        "uses": {
            key: told
            for key, parts in found.items()
            if (told := {name: used for name, (_, uses) in parts.items() if (used := _told(uses))})
        },
    }


def _reached(roots, plans, read, *, pictures):
    """Reads ``roots`` and all they point to into ``read``; yields each when it is read."""
    waiting, seen = list(roots), {block.as_pointer() for block in roots}
    while waiting:
        block = waiting.pop()
        read[block] = parts = Reader(block, plans, pictures=pictures).read()
        for _, uses in parts.values():
            for other in uses:
                if other.as_pointer() not in seen and not _is_no_content(other):
                    seen.add(other.as_pointer())
                    waiting.append(other)
        yield block


def _whole(parts):
    listed = sorted((name, digest) for name, (digest, _) in parts.items())
    return hashlib.blake2b(repr(listed).encode(), digest_size=12).hexdigest()


def _told(uses):
    return sorted({key_of(block) for block in uses if not _is_no_content(block)})


def _kept():
    """All data-blocks but those that are gone once the file is saved: that nothing uses, or only such."""
    users = {block: set(map(_owner, above)) for block, above in bpy.data.user_map().items() if is_id(block)}
    blocks = [block for block in users if not _is_no_content(block)]
    lost, before = set(), None
    while before != len(lost):
        before = len(lost)
        for block in blocks:
            above = users[block] - {block}
            if block.users == 0 or (above and above <= lost and not block.use_fake_user):
                lost.add(block)
    return [block for block in blocks if block not in lost]


def _owner(block):
    return getattr(block, "original", None) or block


def _is_no_content(block):
    kind = key_of(block).partition(" ")[0]
    return kind in _NO_CONTENT or (kind == "Image" and block.type in _NO_PICTURES)
