"""What to change about a simulated actor, by the solver that moves it: what helps a rigid body spoils a cloth."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agents.protocol.rule import RuleContext

# Role of the plan → what to do about an actor that gets into a collider.
_INTO_COLLIDER = {
    "rigid": "Give both a fitting collision shape, thicken the collider, simulate more substeps; if a joint swings it "
    "there, limit the joint's angle or way; then bake again.",
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


def into_collider(context: RuleContext, actor: str) -> str | None:
    """What keeps an actor out of a collider; None where the general advice will do."""
    return _INTO_COLLIDER.get(_role(context, actor))


def unrest(context: RuleContext, actor: str) -> str | None:
    """What brings an actor to rest; None where the general advice will do."""
    return _UNREST.get(_role(context, actor))


def _role(context: RuleContext, actor: str) -> str:
    planned = context.plan.object(actor) if context.plan else None
    return planned.role if planned is not None else ""
