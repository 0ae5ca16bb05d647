# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake was made from, and what of it has changed since: a bake is played as it was, whatever its settings say.

Digests of the inputs are kept in a custom property of the scene, so that saving and opening the file keeps them. The
rigid-body world has inputs of its own, in ``rigid_body_inputs``.
"""

import hashlib
import json
from array import array

import bpy

from ..blend.bake_tag import BAKE_INPUTS
from ..digests.block_parts import extra_parts_of
from ..digests.block_reader import BlockReader
from . import transform_inputs

_LOOKS = (
    "display_",
    "draw_",
    "render_",
    "show_",
    "use_render",
    "child_",
    "instance_",
    "material",
    "color_ramp",
    "trail_",  # of which opening a file changes one
    "use_scale_instance",
    "use_rotation_instance",
    "use_global_instance",
    "use_whole_collection",
    "use_collection_",
)
_SETTINGS = {
    "CLOTH": ("settings", "collision_settings"),
    "SOFT_BODY": ("settings",),
    "FLUID": ("domain_settings",),
    "DYNAMIC_PAINT": ("canvas_settings",),
}
_PARTNERS = {
    "FLUID": ("FLUID", ("flow_settings", "effector_settings")),
    "DYNAMIC_PAINT": ("DYNAMIC_PAINT", ("brush_settings",)),
}


def remember(scene, caches):
    """Notes the present inputs as those that these caches were baked from."""
    if caches := [cache for cache in caches if cache.modifier is not None]:
        _keep(scene, {**_known(scene), **{_key(cache): _inputs(scene, cache) for cache in caches}})


def remember_opened(scene, caches):
    """Notes the present inputs for the bakes of a file that was just opened, where it is not known what they are from.

    Blender marks such a bake as outdated for only some of what may change: a force field is not among it.
    """
    known = _known(scene)
    remember(scene, [each for each in caches if each.baked and not each.outdated and _key(each) not in known])


def forget(scene, caches):
    """Forgets what these caches were baked from."""
    known = _known(scene)
    for cache in caches:
        known.pop(_key(cache), None)
    _keep(scene, known)


def changed_since_bake(cache):
    """What a cache's simulation depends on and has changed since it was baked: ``its settings``, ``'Table'``, …

    Empty if nothing has, or if it is not known what the bake was made from.
    """
    if cache.modifier is None:
        return []
    scene = bpy.context.scene
    before = _known(scene).get(_key(cache))
    if not isinstance(before, dict):
        return []
    now = _inputs(scene, cache)
    return [name for name in {**before, **now} if before.get(name) != now.get(name)]


def _known(scene):
    try:
        known = json.loads(scene.get(BAKE_INPUTS, "{}"))
    except (TypeError, ValueError):
        return {}
    return known if isinstance(known, dict) else {}


def _keep(scene, known):
    if known:
        scene[BAKE_INPUTS] = json.dumps(known)
    elif BAKE_INPUTS in scene:
        del scene[BAKE_INPUTS]


def _key(cache):
    return f"{cache.kind} {cache.owner.name} {getattr(cache.holder, 'name', '')}"


# The inputs


def _inputs(scene, cache):
    """{what: digest} of all that a simulation depends on."""
    owner, modifier = cache.owner, cache.modifier
    names = list(owner.modifiers)
    before = names[: names.index(modifier)]
    render, weights = scene.render, extra_parts_of(owner).get("weights")
    inputs = {
        "its settings": _settings(owner, cache),
        "its mesh": _digest(_shape(owner), [_structs(owner, [one]) for one in before]),
        "its vertex groups": _digest([group.name for group in owner.vertex_groups], weights),
        "its place": _digest(transform_inputs.of_chain(owner)),
        "the scene": _digest(tuple(scene.gravity), scene.use_gravity, render.fps, render.fps_base),
    }
    for other in scene.objects:
        if other != owner and (parts := _part_of_partner(other, modifier.type)):
            inputs[repr(other.name)] = _digest(parts, _shape(other), transform_inputs.of_chain(other))
    return inputs


def _settings(owner, cache):
    if cache.modifier.type != "PARTICLE_SYSTEM":
        holders = [getattr(cache.modifier, name) for name in _SETTINGS[cache.modifier.type]]
        return _structs(owner, [holder for holder in holders if holder is not None])
    settings = cache.holder.settings
    seeds = [system.seed for system in owner.particle_systems if system.settings == settings]
    return _digest(_structs(settings, [settings, settings.effector_weights]), seeds)


def _part_of_partner(obj, kind):
    """Digests of what makes an object act on simulations of a kind; none if it does not."""
    parts = []
    of_kind, names = _PARTNERS.get(kind, ("COLLISION", ("settings",)))
    for modifier in obj.modifiers:
        if modifier.type == of_kind and modifier.show_viewport:
            holders = [getattr(modifier, name, None) for name in names]
            if holders := [holder for holder in holders if holder is not None]:
                parts.append(_structs(obj, holders))
    if obj.field is not None and obj.field.type != "NONE":
        parts.append(_structs(obj, [obj.field]))
    return parts


class _InputsReader(BlockReader):
    """Reads structs without what only their looks depend on."""

    def _plan(self, struct):
        return [entry for entry in super()._plan(struct) if not entry[0].startswith(_LOOKS)]


def _structs(block, structs):
    return _InputsReader(block, {}, pictures=False).struct_digest(structs)


def _shape(obj):
    """A digest of a mesh's vertices, edges and faces, and of its shape keys; None for other data."""
    data = obj.data
    if not isinstance(data, bpy.types.Mesh):
        return None
    digest = hashlib.blake2b(digest_size=12)
    for items, name, code, wide in (
        (data.vertices, "co", "f", 3),
        (data.edges, "vertices", "i", 2),
        (data.loops, "vertex_index", "i", 1),
    ):
        digest.update(_numbers(items, name, code, wide))
    for block in data.shape_keys.key_blocks if data.shape_keys is not None else ():
        digest.update(_numbers(block.data, "co", "f", 3))
    return digest.hexdigest()


def _numbers(items, name, code, wide):
    numbers = array(code, bytes(4 * wide * len(items)))
    items.foreach_get(name, numbers)
    return numbers.tobytes()


def _digest(*content):
    return hashlib.blake2b(repr(content).encode(errors="surrogateescape"), digest_size=8).hexdigest()
