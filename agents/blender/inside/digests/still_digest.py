# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of all that a still of the scene depends on, by which a picture made before can be shown again."""

import hashlib

from ..blend.simulation_zones import objects_with_zones
from ..physics import caches
from .fingerprint import fingerprint

_SOLID = frozenset({caches.RIGID_BODY, caches.CLOTH, caches.SOFT_BODY})  # at rest at their first frame


def still_digest(scene, frame, digests):
    """The digest for ``frame``: before a simulation begins, it does not depend on what that is like.

    ``digests`` are those of the scene, see ``fingerprint``. Fluids, particles and paint are there from their first
    frame on.
    """
    if _is_at_rest(scene, frame):
        digests = fingerprint(scene, at_rest=True)
    return digest_of(sorted(digests.items()))


def lasting_digest(scene):
    """The digest of the scene at its own frame; None while that shows an unbaked simulation, which no setting tells."""
    frame = scene.frame_current
    if not _is_at_rest(scene, frame) and (objects_with_zones(scene) or caches.unbaked(scene)):
        return None
    return digest_of((frame, still_digest(scene, frame, fingerprint(scene))))


def digest_of(content):
    """A digest of anything that has a faithful ``repr``."""
    return hashlib.blake2b(repr(content).encode(errors="surrogateescape"), digest_size=16).hexdigest()


def _is_at_rest(scene, frame):
    found = caches.find_caches(scene)
    return all(
        cache.kind in _SOLID and frame <= cache.range[0] for cache in found
    ) and not objects_with_zones(scene)
