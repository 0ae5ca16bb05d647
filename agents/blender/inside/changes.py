# SPDX-License-Identifier: GPL-3.0-or-later
"""What code changed in the open file: data-blocks and modifiers that differ, and simulations that it reset."""

import contextlib
import ctypes
import os
import sys
import tempfile

import bpy
from bpy.app.handlers import persistent

from .blend.names import series
from .digests.fingerprint import lasting_digests
from .physics import caches

# Collections of bpy.data whose changes are reported.
KINDS = (
    *(
        "objects",
        "materials",
        "collections",
        "meshes",
        "curves",
        "lights",
        "cameras",
        "actions",
        "node_groups",
    ),
    *("images", "textures", "particles", "armatures", "lattices", "shape_keys", "scenes", "worlds"),
)
LISTED = 40  # names of one kind in a report, or series of them; the rest are counted
STALE, LOST = "older than their settings", "no longer baked"
MOST_BLOCKS = 3000  # whose settings are compared; of more, those that Blender evaluated anew count as changed
_ELSEWHERE = frozenset({"collection", "view layers"})  # parts of scenes that other data-blocks tell of
_WHOLE = frozenset({"settings", "geometry", "keyframes", "picture", "nodes", "shapes", "bones"})

_WARNING = b"WARN (bpy.rna)"  # a setting has a value that this Blender was built without

_C = ctypes.CDLL(None) if os.name == "posix" else None
_updated = set()
_cache_watch = {"counts": None, "reset": {}}
_last = {}  # {uid: {part: digest}} of data-blocks after the last watched code, while nothing else has run since


def uid(block):
    """A number that identifies a data-block or modifier, whatever its name."""
    for name in ("session_uid", "persistent_uid"):
        number = getattr(block, name, None)
        if number is not None:
            return number
    return block.as_pointer()  # Blender before 4.1


@persistent
def _note_updates(_scene, graph):
    for update in graph.updates:
        _updated.add(uid(update.id.original))


@persistent
def _note_counts(scene, _graph=None):
    """Notes which simulations lost frames that they had at the last frame change."""
    before = _cache_watch["counts"]
    if before is None:
        return
    now = _cache_watch["counts"] = _frames_held(scene)
    for label, (count, _) in before.items():
        if label in now and now[label][0] < count:
            _cache_watch["reset"].setdefault(label, f"{label}, at frame {scene.frame_current}")


def _frames_held(scene):
    """{label: (frames, whether outdated)} of the simulations whose frames are kept by Blender."""
    return {
        cache.label: (cache.frames, cache.points.is_outdated)
        for cache in caches.find_caches(scene)
        if cache.points is not None
    }


def _baked_labels():
    return {cache.label for cache in caches.find_caches(bpy.context.scene) if cache.baked}


def listen():
    """Has Blender tell of what it updates, from now on."""
    for handlers, listener in (
        (bpy.app.handlers.depsgraph_update_post, _note_updates),
        (bpy.app.handlers.frame_change_post, _note_counts),
    ):
        if listener not in handlers:
            handlers.append(listener)


def forget():
    """Notes that something else is about to run in Blender than watched code."""
    _last.clear()


class ChangeWatch:
    """Remembers the file before some code runs; ``differences`` says what is another after it.

    The settings of at most ``most`` data-blocks are compared; of more, those that Blender evaluated anew have changed.
    ``follows``: nothing but watched code runs in this Blender, unless ``forget`` was called. What that code left is
    then known, which saves half of the reading.
    """

    def __init__(self, most=MOST_BLOCKS, *, follows=False):
        self._most = most
        self._follows = follows
        listen()
        self._settle()
        _updated.clear()
        self._before = _names_by_kind()
        self._modifiers = _modifiers()
        known = dict(_last) if follows else {}
        forget()
        with _silenced():
            self._digests, _ = _digests(self._most, known)
        self._caches = _frames_held(bpy.context.scene)
        self._baked = _baked_labels()
        _cache_watch.update(counts=self._caches, reset={})

    @staticmethod
    def _settle():
        layer = getattr(bpy.context, "view_layer", None)
        if layer is not None:
            layer.update()

    def differences(self):
        """{kind: {"added" | "removed" | "changed": all names}}; {} if nothing is another. To be asked once.

        Modifiers are by ``Object[Modifier]``; ``caches`` has those that were ``reset``: they simulate again from their
        first frame; those that are ``no longer baked``; and the baked ones that are ``older than their settings``: they
        are played as they were baked. What changed of a data-block is in brackets: ``Cube (transform)``.
        """
        self._settle()
        found = {}
        with _silenced(but_threads=True):
            digests, lasting = _digests(self._most) if self._digests is not None else (None, {})
        for kind, new in _names_by_kind().items():
            old = self._before[kind]
            both = [key for key in new if key in old]
            if digests is None:
                changed = {key: new[key] for key in both if key in _updated or old[key] != new[key]}
            else:
                changed = {key: new[key] + what for key in both if (what := self._changes(key, digests))}
                changed.update({key: f"{old[key]} → {new[key]}" for key in both if old[key] != new[key]})
            if entry := _entry(old, new, changed):
                found[kind] = entry
        old, new = self._modifiers, _modifiers()
        renamed = [key for key in new if key in old and new[key][1] != old[key][1]]
        old, new = ({key: f"{owner}[{name}]" for key, (owner, name) in names.items()} for names in (old, new))
        if entry := _entry(old, new, {key: new[key] for key in renamed}):
            found["modifiers"] = entry
        stale = caches.stale(bpy.context.scene)
        played, lost = {cache.label for cache in stale}, sorted(self._baked - _baked_labels())
        entry = {
            LOST: lost,
            "reset": [label for label in self._reset_caches() if label not in played],
            STALE: [caches.describe_stale(cache) for cache in stale],
        }
        if entry := {word: names for word, names in entry.items() if names}:
            found["caches"] = entry
        if self._follows:
            _last.update(lasting)
        return found

    def _changes(self, key, digests):
        """What changed of a data-block, as a suffix of its name; "" if nothing did."""
        before, after = self._digests.get(key, {}), digests.get(key, {})
        parts = sorted(part for part in {*before, *after} - _ELSEWHERE if before.get(part) != after.get(part))
        return f" ({', '.join(parts)})" if parts and not _WHOLE.issuperset(parts) else " " * bool(parts)

    def _reset_caches(self):
        reset = dict(_cache_watch["reset"])
        _cache_watch["counts"] = None
        now = _frames_held(bpy.context.scene)
        for label, (count, outdated) in self._caches.items():
            if label in now and count and (now[label][0] < count or (now[label][1] and not outdated)):
                reset.setdefault(label, label)
        return sorted(reset.values())


def _digests(most, known=None):
    """({uid: {part: digest}} of the data-blocks; those of them that stay what they are while nothing runs in Blender).

    (None, {}) if there are too many to compare. ``known`` are not read.
    """
    blocks = {uid(block): block for kind in KINDS for block in getattr(bpy.data, kind)}
    if len(blocks) > most:
        return None, {}
    known = known or {}
    read, lasting = lasting_digests([block for key, block in blocks.items() if key not in known])
    digests = {uid(block): parts for block, parts in read.items()}
    return digests | {key: known[key] for key in blocks if key in known}, {
        uid(block): read[block] for block in lasting
    }


@contextlib.contextmanager
def _silenced(*, but_threads=False):
    """Drops what Blender prints when settings are read: it is not the code's output.

    ``but_threads``: threads of the code may still print, so only Blender's warnings are dropped.
    """
    kept = []
    with contextlib.ExitStack() as files:
        try:
            _flush()
            for number in (1, 2):
                kept.append((number, os.dup(number), files.enter_context(tempfile.TemporaryFile())))
            for number, _, printed in kept:
                os.dup2(printed.fileno(), number)
        except OSError:  # they are closed
            pass
        try:
            yield
        finally:
            _flush()
            for number, copy, printed in kept:
                os.dup2(copy, number)
                os.close(copy)
                if but_threads:
                    printed.seek(0)
                    lines = [line for line in printed if not line.startswith(_WARNING)]
                    os.write(number, b"".join(lines))


def _flush():
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(Exception):
            stream.flush()
    if _C is not None:
        _C.fflush(None)


def _names_by_kind():
    return {kind: {uid(block): block.name for block in getattr(bpy.data, kind)} for kind in KINDS}


def _modifiers():
    names = {}
    for obj in bpy.data.objects:
        for modifier in obj.modifiers:
            names[uid(obj), uid(modifier)] = (obj.name, modifier.name)
    return names


def _entry(old, new, changed):
    """The names that differ between ``old`` and ``new`` ({uid: name}), and the ``changed`` ones."""
    entry = {}
    for word, names in (
        ("added", [name for key, name in new.items() if key not in old]),
        ("removed", [name for key, name in old.items() if key not in new]),
        ("changed", [name.strip() for name in changed.values()]),
    ):
        if names:
            entry[word] = sorted(names)
    return entry


def in_brief(differences):
    """The differences with at most ``LISTED`` texts in place of the names: a series is one text, the rest a number."""
    return {
        kind: {word: _shortened(names) for word, names in entry.items()}
        for kind, entry in differences.items()
    }


def counts(differences):
    """The differences with the number of names in their place."""
    return {kind: {word: len(names) for word, names in entry.items()} for kind, entry in differences.items()}


def _shortened(names):
    told = series(names)
    left = sum(count for _, count in told[LISTED:])
    return [text for text, _ in told[:LISTED]] + [f"… and {left} more"] * bool(left)
