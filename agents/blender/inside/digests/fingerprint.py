# SPDX-License-Identifier: GPL-3.0-or-later
"""Digests of data-blocks, by which states of a file at different times can be compared.

Two digests are equal if all settings are. They do not depend on the current frame, the selection, or the file's folder:
of animated properties the keyframes and drivers count, of used files their contents. Saving and opening the file does
not change them.
"""

import hashlib

import bpy

from .block_parts import CACHES, CUSTOM
from .block_reader import BlockReader, is_id, key_of

_SHORT = 8  # letters of a part's digest: enough to see that a part differs
# User interface, and tools for painting.
_NO_CONTENT = frozenset({"WindowManager", "Screen", "WorkSpace", "Brush", "Palette", "PaintCurve", "Library"})
# What no simulation depends on. Custom properties count only where drivers can read them.
_ONLY_LOOKS = frozenset({"Material", "World", "Light", "Camera"})
_LOOKS = frozenset(
    {"materials", "camera", "world", "render", "color management", "compositing", "markers", "sequencer"}
)
_OF_SIMULATIONS = frozenset({"physics", "gravity", CACHES})
_FLUID_PARTICLES = frozenset({"FLUID", "FLIP", "FOAM", "SPRAY", "BUBBLE", "TRACER"})
_RENDER_IMAGES = frozenset({"RENDER_RESULT", "COMPOSITING"})


def fingerprint(scene, *, at_rest=False):
    """{"Object Cube": digest, …} of all that renders of ``scene`` depend on, apart from the frame.

    Output paths and formats do not count; nor do simulations where it is ``at_rest``, before any has begun.
    """
    read = {}
    for block in _read_reachable([scene], read, _reader(True, _OF_SIMULATIONS if at_rest else ())):
        read[block] = _block_digest(read[block])
    return {key_of(block): digest for block, digest in read.items()}


def digests_by_part(blocks):
    """{block: {part: digest}} of these data-blocks alone, whatever they point to."""
    return {block: parts for block, parts, _ in _digests_alone(blocks)}


def lasting_digests(blocks):
    """(as digests_by_part; those of the blocks whose digests stay what they are while nothing runs in Blender)."""
    read = list(_digests_alone(blocks))
    return {block: parts for block, parts, _ in read}, {
        block for block, _, has_files in read if not has_files
    }


def _digests_alone(blocks):
    """(block, {part: digest}, whether they depend on files) of each."""
    plans = {}
    for block in blocks:
        reader = BlockReader(block, plans, pictures=False)
        parts = {name: digest for name, (digest, _) in reader.read().items()}
        yield block, parts, reader.has_files


def simulation_inputs(scene):
    """A digest of all that the simulations of ``scene`` may depend on, apart from the frame and their own caches."""
    read, total = {}, hashlib.blake2b(digest_size=12)
    for _ in _read_reachable([scene], read, _reader(False), without=_ONLY_LOOKS):
        pass
    driven = any(getattr(getattr(block, "animation_data", None), "drivers", None) for block in read)
    # Blender itself writes the settings of a fluid's particles at each frame.
    of_fluids = {key_of(block) for block in read if getattr(block, "type", "") in _FLUID_PARTICLES}
    left_out = _LOOKS | {CACHES} | (frozenset() if driven else {CUSTOM})
    for key, parts in sorted(((key_of(block), parts) for block, parts in read.items()), key=_first):
        if key in of_fluids:
            continue
        digests = [(name, digest) for name, (digest, _) in sorted(parts.items()) if name not in left_out]
        total.update(repr((key, digests)).encode("utf-8", "replace"))
    return total.hexdigest()


def data_blocks(report):
    """Digests of everything that saving the file keeps, but the user interface.

    Returns ``digests`` ({"Object Cube": digest}), ``parts`` ({"Object Cube": {"transform": digest, …}}) and ``uses``
    ({"Object Cube": {"data": ["Mesh Cube"], …}}: which data-blocks each part points to).
    """
    read = {}
    blocks = _saved_blocks()
    for count, _ in enumerate(_read_reachable(blocks, read, _reader(False))):
        if count % 500 == 499:
            report(count, None, "reading data-blocks")
    by_key = {key_of(block): parts for block, parts in read.items()}
    return {
        "digests": {key: _block_digest(parts) for key, parts in by_key.items()},
        "parts": {
            key: {name: digest[:_SHORT] for name, (digest, _) in parts.items()}
            for key, parts in by_key.items()
        },
        "uses": {
            key: parts_used
            for key, parts in by_key.items()
            if (parts_used := {name: used for name, (_, uses) in parts.items() if (used := _used_keys(uses))})
        },
    }


def _reader(pictures, left_out=()):
    """A function that reads a data-block's parts, without those that are ``left_out``; see ``BlockReader``."""
    plans = {}

    def read(block):
        parts = BlockReader(block, plans, pictures=pictures).read()
        return {name: part for name, part in parts.items() if name not in left_out}

    return read


def _read_reachable(roots, read, parts_of, *, without=frozenset()):
    """Reads ``roots`` and all they point to into ``read``, but blocks of some kinds; yields each after reading it."""
    waiting, seen = list(roots), {block.as_pointer() for block in roots}
    while waiting:
        block = waiting.pop()
        read[block] = parts = parts_of(block)
        for _, uses in parts.values():
            for other in uses:
                if (
                    other.as_pointer() not in seen
                    and not _is_no_content(other)
                    and key_of(other).partition(" ")[0] not in without
                ):
                    seen.add(other.as_pointer())
                    waiting.append(other)
        yield block


def _first(pair):
    return pair[0]


def _block_digest(parts):
    listed = sorted((name, digest) for name, (digest, _) in parts.items())
    return hashlib.blake2b(repr(listed).encode(), digest_size=12).hexdigest()


def _used_keys(uses):
    return sorted({key_of(block) for block in uses if not _is_no_content(block)})


def _saved_blocks():
    """The data-blocks that saving keeps: not those without users, or used only by such."""
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
    return kind in _NO_CONTENT or (kind == "Image" and block.type in _RENDER_IMAGES)
