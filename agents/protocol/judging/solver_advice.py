"""What to change about a simulated actor, by the solver that moves it: what helps a rigid body spoils a cloth."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agents.protocol.rule import RuleContext

# Role of the plan → what to do about an actor that gets into a collider.
_INTO_COLLIDER = {
    "rigid": "Give both a fitting collision shape, thicken the collider, simulate more substeps; if a joint swings or "
    "twists it there, put the joint where the two turn about each other (the middle of a pin), limit its angle or way, "
    "or raise the body's angular_damping; then bake again.",
    "soft": "Lower its mass and the stiffness of its springs together, raise the solver's least steps, and give the "
    "collider a thicker outer zone and few faces; then bake again.",
    "cloth": "Raise the cloth's quality and its collisions' quality, give the collider a thicker outer zone, and the "
    "cloth a mass of a gram a vertex or so; then bake again.",
    "keyframed": "Change its keyframes, so that it stops at the surface.",
    "rig": "Change its keyframes, so that it stops at the surface.",
}
# … that does not come to rest.
_UNREST = {
    "rigid": "Add friction and damping, let bodies sleep, limit joints, or simulate longer; then bake again.",
    "soft": "Raise the damping of its springs, lower mass and stiffness together, or simulate longer; then bake again.",
    "cloth": "Keep bending_damping at 0.5 or below (more is itself what jitters), raise air_damping, the damping of "
    "its collisions and its quality, or simulate longer; then bake again.",
    "fluid": "Simulate longer, or give the liquid more viscosity; then bake again.",
    "keyframed": "End its keyframes before the phase.",
    "rig": "End its keyframes before the phase.",
}
# … that moves as soon as the simulation begins.
_FROM_THE_START = {
    "rigid": "Let it stand exactly on what bears it: no overlap, no gap, and no collision margin on either "
    "(`use_margin` on, `collision_margin` 0); then bake again.",
}
# … that starts to move at another frame than planned.
_ONSET = {
    "rigid": "Release it, or have what pushes it arrive, at the planned frame; then bake again.",
    "soft": "Release or push it at the planned frame; then bake again.",
    "cloth": "Release its pins, or have what moves it begin, at the planned frame; then bake again.",
    "fluid": "Let it flow from the planned frame on; then bake again.",
    "emitter": "Emit from the planned frame on; then bake again.",
    "keyframed": "Shift its keyframes.",
    "rig": "Shift its keyframes.",
}
# … that moves farther, less far or elsewhere than planned.
_EXTENT = {
    "rigid": "Change where it begins, what pushes it and how fast, its mass, friction or damping; then bake again.",
    "soft": "Change where it begins, what pushes it, or its stiffness and damping; then bake again.",
    "cloth": "Change its pins, what it falls on, or the forces on it; then bake again.",
    "fluid": "Change the source's place, amount or initial velocity; then bake again.",
    "emitter": "Change the particles' initial velocity, or the forces on them; then bake again.",
    "keyframed": "Change its keyframes until the end of the phase is the planned one.",
    "rig": "Change its keyframes until the end of the phase is the planned one.",
}


def into_collider(context: RuleContext, actor: str) -> str | None:
    """What keeps an actor out of a collider; None where the general advice will do."""
    return _INTO_COLLIDER.get(_role(context, actor))


def unrest(context: RuleContext, actor: str) -> str | None:
    """What brings an actor to rest; None where the general advice will do."""
    return _UNREST.get(_role(context, actor))


def from_the_start(context: RuleContext, actor: str) -> str | None:
    """What keeps an actor at rest as the simulation begins; None where the advice about unrest will do."""
    return _FROM_THE_START.get(_role(context, actor))


def onset(context: RuleContext, actor: str) -> str | None:
    """What has an actor start at another frame; None where the general advice will do."""
    return _ONSET.get(_role(context, actor))


def extent(context: RuleContext, actor: str) -> str | None:
    """What has an actor move otherwise; None where the general advice will do."""
    return _EXTENT.get(_role(context, actor))


def _role(context: RuleContext, actor: str) -> str:
    planned = context.plan.object(actor) if context.plan else None
    return planned.role if planned is not None else ""
