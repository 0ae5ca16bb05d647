# SPDX-License-Identifier: GPL-3.0-or-later
"""Rewrites the open scene: the same objects and motion, otherwise organised, named or measured."""

from simworlds.sandbox.inside.refusal import Refused

from . import grouping, meshes, units

REWRITES = {
    "ungrouped": grouping.ungroup,
    "grouped": grouping.group,
    "renamed": grouping.rename,
    "rescaled": units.rescale,
    "instanced": meshes.instance,
    "joined": meshes.join,
}


def rewrite(kind, actors):
    """Applies a rewrite to the open scene. Returns how much of it was changed.

    ``actors``: each with ``name``, ``other`` (another name for it), ``still`` (whether it is of a role that
    nothing simulates), ``units`` (names of objects, the first of which stands for the rest), and ``parts``
    (names of objects that belong to it by contact alone).

    Raises Refused where there is nothing to change.
    """
    changed = REWRITES[kind](actors)
    if not changed:
        raise Refused(f"nothing in it can be {kind}")
    return changed
