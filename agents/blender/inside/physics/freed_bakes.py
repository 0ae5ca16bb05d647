# SPDX-License-Identifier: GPL-3.0-or-later
"""Forgets what a bake was made from as soon as it is freed, by whatever code, at the next change of frame."""

import bpy
from bpy.app.handlers import persistent

from ..blend.bake_tag import BAKE_INPUTS
from . import bake_inputs
from .caches import find_caches


def watch():
    """Looks for freed bakes from now on."""
    if _forget not in bpy.app.handlers.frame_change_post:
        bpy.app.handlers.frame_change_post.append(_forget)


@persistent
def _forget(scene, _graph=None):
    if BAKE_INPUTS in scene and (freed := [cache for cache in find_caches(scene) if not cache.baked]):
        bake_inputs.forget(scene, freed)
