# SPDX-License-Identifier: GPL-3.0-or-later
"""The f-curves that animate a data-block, in the layered actions of Blender 4.4 and later as in older ones."""


def action_curves(player):
    """The f-curves of the action that an AnimData or an NLA strip (or None) plays; of a layered action, its slot's."""
    action = player.action if player is not None else None
    if action is None:
        return []
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    slot = player.action_slot
    if slot is None:
        return []
    strips = [strip for layer in action.layers for strip in layer.strips if strip.type == "KEYFRAME"]
    bags = [bag for strip in strips if (bag := strip.channelbag(slot)) is not None]
    return [curve for bag in bags for curve in bag.fcurves]


def curves_by_slot(action):
    """[(identifier of a slot, "" in older Blenders; its f-curves)] of an action."""
    if not hasattr(action, "layers"):
        return [("", list(action.fcurves))]
    strips = [strip for layer in action.layers for strip in layer.strips if strip.type == "KEYFRAME"]
    return [(bag.slot.identifier, list(bag.fcurves)) for strip in strips for bag in strip.channelbags]


def curves_of(block):
    """The f-curves of a data-block's own action."""
    return action_curves(getattr(block, "animation_data", None))


def played_curves(block):
    """The f-curves of a data-block's own action and of its NLA strips, without muted tracks and strips."""
    animation = getattr(block, "animation_data", None)
    if animation is None:
        return []
    strips = [strip for track in animation.nla_tracks if not track.mute for strip in track.strips]
    players = [animation, *(strip for strip in strips if not strip.mute)]
    return [curve for player in players for curve in action_curves(player)]


def varies(curve):
    """Whether an f-curve has different values over time."""
    if len(curve.modifiers) or len(curve.sampled_points):
        return True
    return len({point.co[1] for point in curve.keyframe_points}) > 1
